"""A hand with a mass: its force, its impedance, and what it refuses to leave out."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.errors import AssemblyError, DesignError, InternalError
from nrs_design.models.contact import Hand, KelvinVoigt
from nrs_design.models.contact.environment import Environment, touch_at_once
from nrs_design.models.contact.motion import Motion
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import coordinates

HAND = Hand(57.0, 7.0, 0.2)


def test_force_of_a_swing():
    """At the frequency w the force is (k - m w^2) delta + b delta'."""
    t = np.linspace(0, 1, 2001)
    motion = Motion(t, 0.1 * np.sin(8 * t))
    expected = (57.0 - 0.2 * 64) * 0.1 * np.sin(8 * t) + 7.0 * 0.8 * np.cos(8 * t)
    inner = slice(5, -5)
    assert HAND.simulate(motion)[inner] == pytest.approx(expected[inner], abs=1e-4)
    assert HAND.sensitivities(motion).sum(axis=1) == pytest.approx(HAND.simulate(motion))


def test_impedance_at_a_frequency():
    s = 5j
    above, below = HAND.impedance
    assert np.polyval(above, s) / np.polyval(below, s) == pytest.approx(57 / s + 7 + 0.2 * s)
    assert HAND.replace_stiffness(Fraction(60)) == Hand(60, 7.0, 0.2)


def test_without_mass_it_is_a_spring_beside_a_damper():
    velocity, acceleration, deflection = coordinates(3)
    k, b = Fraction(50), Fraction(3)
    plain = KelvinVoigt(k, b).react(velocity, [deflection])
    light = Hand(k, b, Fraction(0)).react_accelerated(velocity, acceleration, [deflection])
    assert light == plain
    assert KelvinVoigt(k, b).react_accelerated(velocity, acceleration, [deflection]) == plain
    heavy = Hand(k, b, Fraction(2)).react_accelerated(velocity, acceleration, [deflection])
    assert heavy == ([b, 2, k], [velocity])
    assert not Hand(k, Fraction(0), Fraction(1)).is_spring
    assert Hand(k, Fraction(0), Fraction(0)).is_spring


def test_the_mass_is_never_left_out():
    velocity, _, deflection = coordinates(3)
    with pytest.raises(AssemblyError, match="has a mass"):
        HAND.react(velocity, [deflection])
    with pytest.raises(DesignError, match="not modelled"):
        HAND.element  # noqa: B018
    ranges = tuple(map(Interval.point, (Fraction(50), Fraction(3), Fraction(1))))
    hand = Environment("hand", Hand, ranges)
    with pytest.raises(InternalError, match="mass or memory of hand"):
        touch_at_once((hand, hand), losable=False)


def test_at_the_pivot_every_parameter_takes_the_square_of_the_arm():
    assert Hand(100.0, 10.0, 1.0).convert_to_pivot(0.5) == Hand(25.0, 2.5, 0.25)
    assert Hand.units(rotational=False) == ("N/m", "N*s/m", "kg")
    assert Hand.units(rotational=True) == ("N*m/rad", "N*m*s/rad", "kg*m^2")
