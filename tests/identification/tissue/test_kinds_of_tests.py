"""Tests as laboratories do them: stress relaxation, creep, ramps at several speeds."""

import math

import numpy as np
import pytest

from nrs_design.identification.datasets import TissueRecord
from nrs_design.identification.tissue import fit_record, identify_tissue
from nrs_design.models.contact import KelvinBoltzmann, KelvinVoigt, Motion
from tests.identification.support import source

LAW = KelvinBoltzmann(400.0, 900.0, 2000.0)
TIME = np.arange(2000) / 20


def measured(motion, force, noise, seed):
    error = noise * np.random.default_rng(seed).standard_normal(len(force))
    return TissueRecord(source(f"{seed}"), motion, force + error, False)


def covered(fit, law):
    return [e.covers(v) for e, v in zip(fit.estimates, law.values, strict=True)]


def test_stress_relaxation():
    """Ramp and hold."""
    motion = Motion(TIME, 0.005 * np.clip((TIME - 2) / 0.5, 0, 1))
    fit = fit_record(KelvinBoltzmann, measured(motion, LAW.simulate(motion), 0.01, 1))
    assert covered(fit, LAW) == [True] * 3
    assert fit.doubts == ()


def test_creep():
    """The force is held, and the tissue gives way."""
    force = 2.0 * np.clip((TIME - 2) / 0.5, 0, 1)
    rate, d, damper = LAW.k1 / LAW.b, 0.0, [0.0]
    for i in range(1, len(TIME)):
        h = TIME[i] - TIME[i - 1]
        slope, a = (force[i] - force[i - 1]) / h, math.exp(-rate * h)
        d = a * d + (force[i - 1] * (1 - a) / rate + slope * (h / rate - (1 - a) / rate**2)) / LAW.b
        damper.append(d)
    motion = Motion(TIME, force / LAW.k2 + np.array(damper))
    fit = fit_record(KelvinBoltzmann, measured(motion, force, 0.01, 2))
    assert covered(fit, LAW) == [True] * 3


@pytest.mark.slow
def test_ramps_at_several_speeds():
    law = KelvinVoigt(400.0, 20.0)
    data = []
    for seed, speed in enumerate((0.0005, 0.002, 0.008)):
        time = np.linspace(0, 0.016 / speed, 800)
        motion = Motion(time, 0.008 - np.abs(0.008 - speed * time))
        data.append(measured(motion, law.simulate(motion), 0.02, seed))
    found = identify_tissue(data)
    assert found.chosen.law.name == "kelvin-voigt"
    assert all(e.covers(v) for e, v in zip(found.chosen.ranges, law.values, strict=True))
