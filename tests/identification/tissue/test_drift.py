"""A tare that moves."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue.output_error import fit_record
from nrs_design.identification.tissue.trial import Preparation, prepare
from nrs_design.models.contact import Elastic, KelvinBoltzmann, Motion
from tests.identification import synthetic
from tests.identification.support import quick, record, slow, source
from tests.identification.unilateral import robot_record


def data(drift, seed=1):
    return robot_record(Elastic(400.0), quick(seed), 0.03, seed, tare=-1.3, drift=drift)


def test_the_air_shows_it():
    fit = fit_record(Elastic, data(0.02))
    assert drift_of(fit).covers(0.02)
    assert not drift_of(fit).covers(0.0)
    assert fit.estimates[0].covers(400.0)
    assert "moving in proportion to time" in "; ".join(fit.trial.remarks)


def drift_of(fit):
    (found,) = (offset.estimate for offset in fit.offsets if offset.name == "drift")
    return found


@pytest.mark.parametrize("true", [0.0, 0.001])
def test_one_too_small_to_be_seen_is_fitted(true):
    """Left out, it would move the tare at the start by more than its interval."""
    fits = [fit_record(Elastic, data(true, seed)) for seed in range(20)]
    assert sum(drift_of(fit).covers(true) for fit in fits) >= 18
    tares = [next(o.estimate for o in fit.offsets if o.name == "tare") for fit in fits]
    assert sum(tare.covers(-1.3) for tare in tares) >= 18


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


def creeping(bend, seed=1):
    """A relaxing tissue without air, and a tare that moves by a tenth of the range of the force."""
    still = record(synthetic.NOSE, slow(seed), 0.0165, seed)
    time = still.motion.time
    part = (time - time[0]) / (time[-1] - time[0])
    return replace(still, force=still.force + 0.1 * np.ptp(still.force) * bend(part))


@pytest.mark.parametrize("bend", [np.sqrt, np.square, np.positive])
def test_without_air_a_drift_that_fits_better_is_a_doubt(bend):
    fit = fit_record(KelvinBoltzmann, creeping(bend))
    assert fit.law.k1 > 2 * synthetic.NOSE.k1
    assert any("a tare that moves with time fits better" in doubt for doubt in fit.doubts)


def test_without_drift_there_is_no_doubt():
    for seed in range(1, 6):
        assert fit_record(KelvinBoltzmann, creeping(np.zeros_like, seed)).doubts == ()


def test_a_drift_that_fades_as_the_tissue_does_passes_for_relaxation_and_that_is_said():
    """A known limit, told in the docs: the stiffness at rest comes out three times as large."""
    fit = fit_record(KelvinBoltzmann, creeping(lambda part: 1 - np.exp(-3 * part)))
    assert fit.law.k1 > 2.5 * synthetic.NOSE.k1
    assert fit.doubts == ()
    assert any("would pass for relaxation" in remark for remark in fit.trial.remarks)
