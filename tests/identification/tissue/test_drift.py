"""A tare that moves."""

import numpy as np
import pytest

from nrs_design.identification.datasets import TissueRecord
from nrs_design.identification.tissue import Preparation, fit_record, prepare
from nrs_design.models.contact import Elastic, Motion
from tests.identification.support import quick, source
from tests.identification.unilateral import robot_record


def data(drift, seed=1):
    return robot_record(Elastic(400.0), quick(seed), 0.03, seed, tare=-1.3, drift=drift)


def test_the_air_shows_it():
    fit = fit_record(Elastic, data(0.02))
    (found,) = (offset for offset in fit.offsets if offset.name == "drift")
    assert found.estimate.covers(0.02)
    assert fit.estimates[0].covers(400.0)
    assert "moving in proportion to time" in "; ".join(fit.trial.remarks)


def test_none_is_guessed():
    assert not any(prepare(data(0.0, seed)).drift for seed in range(20))


@pytest.mark.parametrize(("wanted", "said"), [("fit", True), ("none", False)])
def test_it_can_be_told(wanted, said):
    assert prepare(data(0.0), Preparation(drift=wanted)).drift is said
    assert np.isfinite(fit_record(Elastic, prepare(data(0.02), Preparation(drift=wanted))).rmse)


def test_a_soft_start_of_one_touch_is_none():
    """Seen in texture analysis of meat: the force creeps up before the tissue resists."""
    time = np.arange(300) / 10
    x = 0.0005 * time
    force = 0.02 * time + 4000 * np.maximum(x - 0.008, 0.0)
    force += 0.02 * np.random.default_rng(1).standard_normal(300)
    assert not prepare(TissueRecord(source("soft"), Motion(time, x), force, False)).drift
