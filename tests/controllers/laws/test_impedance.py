"""The admittance as a processor runs it: its coefficients."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import cont2discrete

from nrs_design.controllers.float32 import is_float32, round_float32
from nrs_design.controllers.laws import Admittance

PERIOD = Fraction(1, 500)
LAW = Admittance(round_float32(Fraction("0.01")), round_float32(Fraction("2.15")))


@settings(deadline=None)
@given(st.floats(2**-10, 1, width=32), st.floats(0.125, 20, width=32), st.integers(1, 50))
def test_exact_steps_are_those_of_a_held_force(Mt, Bt, ms):
    period = Fraction(ms, 1000)
    held = Admittance(Fraction(Mt), Fraction(Bt)).discretize(period, "exact").numbers
    a, b, *_ = cont2discrete(
        (np.array([[-Bt / Mt]]), np.array([[1 / Mt]]), np.eye(1), np.zeros((1, 1))), float(period)
    )
    assert float(held["a"]) == pytest.approx(a.item(), rel=1e-6, abs=1e-12)
    assert float(held["b"]) == pytest.approx(b.item(), rel=1e-6)
    assert all(map(is_float32, held.values()))


def test_one_step_of_euler():
    held = LAW.discretize(PERIOD, "euler").numbers
    assert held["a"] == round_float32(1 - LAW.Bt * PERIOD / LAW.Mt)
    assert held["b"] == round_float32(PERIOD / LAW.Mt)


def test_without_inertia_the_law_has_no_memory():
    held = Admittance(Fraction(0), Fraction(2)).discretize(PERIOD, "exact").numbers
    assert held == {"b": Fraction(1, 2), "T": round_float32(PERIOD)}


def test_a_spring_is_a_coefficient_of_its_own():
    """Its force counts as force: the other coefficients are those of the law without it."""
    sprung = replace(LAW, Kt=Fraction(1, 2))
    for method in ("exact", "euler"):
        plain = LAW.discretize(PERIOD, method).numbers
        assert sprung.discretize(PERIOD, method).numbers == {**plain, "Kt": Fraction(1, 2)}
