"""The law as a processor runs it: coefficients by formula, and against a general discretization."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nrs_design.controllers.sampled import SampledMotion
from scipy.signal import cont2discrete

from nrs_design.controllers.float32 import is_float32, to_float32
from nrs_design.controllers.laws import Admittance, ProportionalDerivative

PERIOD = Fraction(1, 500)
LAW = Admittance(to_float32(Fraction("0.01")), to_float32(Fraction("2.15")))


def test_the_backward_difference_of_the_thesis_robot():
    """Kd = 2060 rpm s/rad over 2 ms is a single-precision number by itself."""
    motion = ProportionalDerivative(Fraction(117359), Fraction(2060)).sampled(PERIOD)
    assert motion == SampledMotion(Fraction(117359), Fraction(1_030_000))


@settings(deadline=None)
@given(st.floats(2**-10, 1, width=32), st.floats(0.125, 20, width=32), st.integers(1, 50))
def test_exact_steps_are_those_of_a_held_force(Mt, Bt, ms):
    period = Fraction(ms, 1000)
    law = Admittance(Fraction(Mt), Fraction(Bt)).sampled(period, "exact")
    a, b, *_ = cont2discrete(
        (np.array([[-Bt / Mt]]), np.array([[1 / Mt]]), np.eye(1), np.zeros((1, 1))), float(period)
    )
    assert float(law.a) == pytest.approx(a.item(), rel=1e-6, abs=1e-12)
    assert float(law.b) == pytest.approx(b.item(), rel=1e-6)
    assert all(map(is_float32, law.coefficients.values()))


def test_one_step_of_euler():
    law = LAW.sampled(PERIOD, "euler")
    assert law.a == to_float32(1 - LAW.Bt * PERIOD / LAW.Mt)
    assert law.b == to_float32(PERIOD / LAW.Mt)


def test_without_inertia_the_law_has_no_memory():
    law = Admittance(Fraction(0), Fraction(2)).sampled(PERIOD, "exact")
    assert law.coefficients == {"b": Fraction(1, 2), "T": to_float32(PERIOD)}


def test_a_spring_is_a_coefficient_of_its_own():
    """Its force counts as force: the other coefficients are those of the law without it."""
    sprung = replace(LAW, Kt=Fraction(1, 2))
    for method in ("exact", "euler"):
        plain = LAW.sampled(PERIOD, method).coefficients
        assert sprung.sampled(PERIOD, method).coefficients == plain | {"Kt": Fraction(1, 2)}
