"""Residuals that speak against a fit."""

import numpy as np

from nrs_design.identification.datasets import TissueRecord
from nrs_design.identification.tissue import fit_record
from nrs_design.identification.tissue.residuals import structure
from nrs_design.models.contact import Elastic, KelvinVoigt, Motion
from tests.identification.support import quick, record, source


def test_structure_is_found_and_noise_is_none():
    generator = np.random.default_rng(1)
    x, noise = generator.uniform(-1, 1, 3000), 0.1 * generator.standard_normal(3000)
    size, p = structure(x, x**2 + noise)
    assert abs(size - np.std(x**2)) < 0.02
    assert p < 1e-100
    size, p = structure(x, noise)
    assert size < 0.01
    assert p > 0.001


def doubts(kind, force, motion=None):
    motion = motion or quick(1)
    force = force(motion) + 0.02 * np.random.default_rng(1).standard_normal(len(motion))
    return "; ".join(fit_record(kind, TissueRecord(source("a"), motion, force, False)).doubts)


def test_a_tissue_that_stiffens():
    said = doubts(Elastic, lambda m: 3.0 * np.expm1(m.deflection / 0.002))
    assert "follow the deflection: the tissue is not linear" in said


def test_a_damper_that_the_law_does_not_have():
    said = doubts(Elastic, KelvinVoigt(400.0, 60.0).simulate)
    assert "follow the velocity: the law has another damping" in said


def test_a_tare_that_wanders():
    said = doubts(Elastic, lambda m: 400.0 * m.deflection + 0.3 * np.sin(m.time))
    assert "not white but wander with time" in said


def test_noise_that_hides_the_force():
    data = record(Elastic(40.0), quick(1), 0.1, 1)
    said = "; ".join(fit_record(Elastic, data).doubts)
    assert "% of the range of the force" in said


def test_an_interval_that_reaches_zero():
    motion = quick(1)
    generator = np.random.default_rng(5)
    data = TissueRecord(source("n"), Motion(motion.time, motion.deflection),
                        generator.standard_normal(len(motion)), False)  # fmt: skip
    said = "; ".join(fit_record(Elastic, data).doubts)
    assert "the interval of k reaches 0" in said
