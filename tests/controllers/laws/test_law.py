"""What a law is taken to be until it says more of itself."""

from dataclasses import dataclass
from fractions import Fraction

import pytest

from nrs_design.controllers.laws import AbstractCompliantLaw, Admittance
from nrs_design.spec.controllers import PositionControllerSpec


@dataclass(frozen=True, slots=True)
class Unbounded(AbstractCompliantLaw):
    """A law that says nothing of the gain that its spec does not bound."""

    K: Fraction

    def respond(self, force, states):
        return force, states

    def discretize(self, period, method):
        raise NotImplementedError


def test_a_gain_that_neither_spec_nor_law_limits_is_not_allowed():
    """A certificate may quote any gain: one that nothing is held against must not pass."""
    given = PositionControllerSpec(type="position")
    assert Unbounded(Fraction(1)).find_fault(given) == "gain K has no bounds in the spec"


def test_by_default_a_law_has_no_states():
    law = Unbounded(Fraction(1))
    assert law.states == ()


def test_gains_are_taken_by_name():
    gains = {"Bt": Fraction(2), "Mt": Fraction(1), "other": Fraction(3)}
    assert Admittance.of(gains) == Admittance(Mt=Fraction(1), Bt=Fraction(2))
    with pytest.raises(KeyError, match="Bt"):
        Admittance.of({"Mt": Fraction(1)})
