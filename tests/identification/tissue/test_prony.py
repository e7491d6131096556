"""Prony series: as many relaxations as there are."""

import numpy as np
import pytest

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue.prony import fit_series
from nrs_design.identification.tissue.trial import prepare
from nrs_design.models.contact import KelvinBoltzmann, Motion
from nrs_design.models.contact.relaxation import Relaxation
from tests.identification import synthetic
from tests.identification.support import record, slow, source

TIME = np.arange(4000) / 20
# Ramp and hold: stress relaxation over 200 s.
HOLD = Motion(TIME, 0.005 * np.clip((TIME - 2) / 0.5, 0, 1))


def relaxing(motion, rest, arms, noise, seed):
    force = rest * motion.deflection
    for stiffness, tau in arms:
        force = force + stiffness * Relaxation(motion, tau).y
    force = force + noise * np.random.default_rng(seed).standard_normal(len(motion))
    return prepare(TissueRecord(source("hold"), motion, force, False))


def test_two_relaxations_of_a_ramp_and_hold():
    series = fit_series(relaxing(HOLD, 300.0, [(200.0, 2.0), (400.0, 40.0)], 0.003, 1))
    assert series.rest == pytest.approx(300.0, rel=0.02)
    assert series.times == pytest.approx((2.0, 40.0), rel=0.05)
    assert series.arms == pytest.approx((200.0, 400.0), rel=0.03)
    law = series.reduced
    eta1, _, tau = law.eta
    assert eta1 == pytest.approx(300.0, rel=0.02)
    assert law.k2 == pytest.approx(900.0, rel=0.02)
    assert tau == pytest.approx((200 * 2 + 400 * 40) / 600, rel=0.05)


@pytest.mark.parametrize("seed", range(3))
def test_one_relaxation_needs_one_term(seed):
    series = fit_series(prepare(record(synthetic.CONCHA, slow(seed), 0.008, seed)))
    assert len(series.times) == 1
    assert isinstance(series.reduced, KelvinBoltzmann)
    assert series.reduced.values == pytest.approx(synthetic.CONCHA.values, rel=0.2)
    assert series.bic[0] < series.bic[2]
