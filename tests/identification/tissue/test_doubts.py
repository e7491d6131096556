"""When a record does not determine a law, that is said."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue.doubts import structure
from nrs_design.identification.tissue.output_error import fit_record
from nrs_design.models.contact import (
    LAWS,
    Elastic,
    HuntCrossley,
    KelvinBoltzmann,
    KelvinVoigt,
    Maxwell,
)
from nrs_design.models.contact.motion import Motion
from tests.identification import synthetic
from tests.identification.support import quick, record, slow, source
from tests.tables import rows


def doubts(kind, law, motion, noise=0.01, resolution=0.0):
    return "; ".join(fit_record(kind, record(law, motion, noise, 5, resolution)).doubts)


LATE = Motion(slow().time[120:] - slow().time[120], slow().deflection[120:])


@pytest.mark.parametrize(
    ("kind", "law", "motion", "noise", "said"),
    [
        # Thesis table 2.4: the Maxwell nose relaxes in 106 s.
        (Maxwell, Maxwell(1.129, 120.233), slow(), 0.001,
         "the record (80 s) is shorter than the relaxation time (1"),
        (KelvinVoigt, Elastic(750.0), quick(), 0.1, "b has a relative standard error of"),
        (KelvinBoltzmann, Elastic(750.0), quick(), 0.1, "relative standard error"),
        (HuntCrossley, Elastic(0.5), slow(), 0.01, "phi is at the lower end"),
        (KelvinBoltzmann, synthetic.CONCHA, LATE, 0.01, "begins at"),
        (KelvinBoltzmann, synthetic.CONCHA, slow(), 0.01, ""),
    ],
    ids=["too short", "no damper", "no relaxation", "exponent", "loaded start", "sound"],
)  # fmt: skip
def test_what_a_record_does_not_determine(kind, law, motion, noise, said):
    text = doubts(kind, law, motion, noise)
    assert said in text
    assert bool(text) == bool(said)


@pytest.mark.parametrize(("times", "said"), rows(__file__, "test_another_unit_is_suspected"))
def test_another_unit_is_suspected(times, said):
    motion = quick()
    made = Motion(times[0] * motion.time, times[1] * motion.deflection)
    assert said in doubts(Elastic, Elastic(750.0 / times[1]), made)


@pytest.mark.parametrize(("parts", "said"), [(200, True), (3500, False)])
def test_rounding_that_moves_a_damping_by_half_its_error(parts, said):
    """Far less than a tenth of the power of the velocity, but seen in so long a record."""
    law = KelvinVoigt(0.574, 0.957)
    text = doubts(KelvinVoigt, law, slow(), 0.0114, 0.35 / parts)
    assert ("of the power of the velocity is rounding" in text) is said


def test_a_tissue_that_is_torn():
    """The force falls by a half while the probe goes on."""
    time = np.arange(3000) / 100
    force = 0.2 * time * np.where(time < 15, 1.0, 0.5)
    force += 0.02 * np.random.default_rng(0).standard_normal(3000)
    torn = TissueRecord(source("torn"), Motion(time, 0.0005 * time), force, False)
    for kind in LAWS.values():
        assert any("the residual is" in doubt for doubt in fit_record(kind, torn).doubts)


def test_structure_is_found_and_noise_is_none():
    generator = np.random.default_rng(1)
    x, noise = generator.uniform(-1, 1, 3000), 0.1 * generator.standard_normal(3000)
    size, p = structure(x, x**2 + noise)
    assert abs(size - np.std(x**2)) < 0.02
    assert p < 1e-100
    size, p = structure(x, noise)
    assert size < 0.01
    assert p > 0.001


def doubts_of_force(kind, force, motion=None):
    motion = motion or quick(1)
    force = force(motion) + 0.02 * np.random.default_rng(1).standard_normal(len(motion))
    return "; ".join(fit_record(kind, TissueRecord(source("a"), motion, force, False)).doubts)


@pytest.mark.parametrize(
    ("force", "said"),
    [
        (lambda m: 3.0 * np.expm1(m.deflection / 0.002), "deflection: the tissue is not linear"),
        (KelvinVoigt(400.0, 60.0).simulate, "follow the velocity: the law has another damping"),
        (lambda m: 400.0 * m.deflection + 0.3 * np.sin(m.time), "not white but wander with time"),
    ],
    ids=["stiffens", "damped", "tare wanders"],
)
def test_what_the_law_does_not_have_is_named(force, said):
    assert said in doubts_of_force(Elastic, force)


@pytest.mark.slow
def test_a_tissue_that_relaxes_is_not_taken_for_one_that_pulls():
    """At its largest deflection it has its least force."""
    time = np.arange(4000) / 20
    motion = Motion(time, 0.003 * np.clip(time / 0.5, 0, 1))
    data = record(Maxwell(400.0, 8000.0), motion, 0.01, 1)
    for kind in LAWS.values():
        assert "opposite signs" not in "; ".join(fit_record(kind, data).doubts)
    pulled = replace(record(Elastic(400.0), quick(1), 0.02, 1), force=-400.0 * quick(1).deflection)
    for kind in LAWS.values():
        assert "opposite signs" in "; ".join(fit_record(kind, pulled).doubts)


def test_an_interval_that_reaches_zero():
    motion = quick(1)
    generator = np.random.default_rng(5)
    data = TissueRecord(source("n"), Motion(motion.time, motion.deflection),
                        generator.standard_normal(len(motion)), False)  # fmt: skip
    fit = fit_record(Elastic, data)
    assert "the interval of k reaches 0" in "; ".join(fit.doubts)
    # It does, at any confidence, and grows with it.
    (small,), (middle,), (large,) = (fit.intervals(level) for level in (0.5, 0.95, 0.99))
    assert small.low == middle.low == large.low == 0.0
    assert small.high < middle.high < large.high < np.inf


@pytest.mark.parametrize("b", [0.5, 2.0, 20.0])
def test_a_wrong_sign_is_named_beside_strong_relaxation(b):
    """The faster it relaxes, the more the force follows the velocity alone."""
    data = record(Maxwell(1.129, b), slow(1), 0.01, 1)
    turned = replace(data, force=-data.force)
    for kind in (Elastic, Maxwell):
        assert "opposite signs" in "; ".join(fit_record(kind, turned).doubts)
        assert "opposite signs" not in "; ".join(fit_record(kind, data).doubts)
