"""Tests as laboratories do them: stress relaxation, creep, ramps at several speeds."""

import math

import numpy as np

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue.output_error import fit_record
from nrs_design.models.contact import KelvinBoltzmann, Motion
from tests.identification.support import holds, source

LAW = KelvinBoltzmann(400.0, 900.0, 2000.0)
TIME = np.arange(2000) / 20


def measured(motion, force, noise, seed):
    error = noise * np.random.default_rng(seed).standard_normal(len(force))
    return TissueRecord(source(f"{seed}"), motion, force + error, False)


def test_stress_relaxation():
    motion = Motion(TIME, 0.005 * np.clip((TIME - 2) / 0.5, 0, 1))
    fit = fit_record(KelvinBoltzmann, measured(motion, LAW.simulate(motion), 0.01, 1))
    assert all(holds(fit.estimates, LAW.values))
    assert fit.doubts == ()


def test_creep():
    force = 2.0 * np.clip((TIME - 2) / 0.5, 0, 1)
    rate, d, damper = LAW.k1 / LAW.b, 0.0, [0.0]
    for i in range(1, len(TIME)):
        h = TIME[i] - TIME[i - 1]
        slope, a = (force[i] - force[i - 1]) / h, math.exp(-rate * h)
        d = a * d + (force[i - 1] * (1 - a) / rate + slope * (h / rate - (1 - a) / rate**2)) / LAW.b
        damper.append(d)
    motion = Motion(TIME, force / LAW.k2 + np.array(damper))
    fit = fit_record(KelvinBoltzmann, measured(motion, force, 0.01, 2))
    assert all(holds(fit.estimates, LAW.values))
