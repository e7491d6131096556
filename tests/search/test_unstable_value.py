"""Search for values of a constant parameter at which something grows."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.search.acceptance import OUT_OF_RANGE
from nrs_design.search.family import Family
from nrs_design.search.unstable_value import search_switching_at_values, search_value
from tests.proof.systems import family, hidden_shears, hidden_value
from tests.proof.truth import holds
from tests.search.support import outcome

TIMES = list(Time)


@pytest.mark.parametrize("time", TIMES)
def test_a_value_inside_the_range_is_found(time):
    """Both ends are stable; the worst share is one half, where the radius is c / 2."""
    system = hidden_value("2.1", time)
    evidence, words = outcome(search_value, system)
    assert words == "found"
    assert evidence.shares == (Fraction(1, 2),)
    assert holds(system, evidence)


@pytest.mark.parametrize("time", TIMES)
def test_short_of_the_limit_nothing_is_claimed(time):
    evidence, words = outcome(search_value, hidden_value("1.99", time))
    assert evidence is None
    assert words == "every mode is stable at every value tried"


def test_a_narrow_range_of_values_is_not_missed():
    """Unstable for shares within 0.005 of one half, far from every end."""
    system = hidden_value(2 + Fraction(1, 10**4))
    assert outcome(search_value, system)[0].find_fault(system) is None


@pytest.mark.parametrize("time", TIMES)
def test_switching_at_one_value(time):
    """At every value all modes are stable, and at both ends switching is; in between it grows."""
    system = hidden_shears(time)
    assert outcome(search_value, system)[0] is None
    evidence, _ = outcome(search_switching_at_values, system)
    assert evidence.shares == (Fraction(1, 2),)
    assert holds(system, evidence)


def test_switching_needs_two_modes_at_a_value():
    evidence, words = outcome(search_switching_at_values, hidden_value("1.5"))
    assert evidence is None
    assert words.startswith("not tried: that takes two modes")


def test_modes_beyond_floating_point_are_left_alone():
    system = family([[-1, 0], [0, -1]], [[-(10**400), 0], [0, -1]])
    broken = Family.of(system)
    assert not np.isfinite(broken.matrices).all()
    assert outcome(search_value, system) == (None, OUT_OF_RANGE)
