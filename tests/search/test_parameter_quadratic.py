"""Search for functions that are affine in a constant parameter."""

import pytest

from nrs_design.proof.system import Switching
from nrs_design.search.family import Family
from nrs_design.search.parameter_quadratic import find_parameter_quadratic
from tests.proof.systems import oscillator, shears

PAIR = Switching(fixed_ends=(("m0", "m1"),))


def search(system):
    family = Family.of(system)
    return find_parameter_quadratic(system, family.matrices, family.exponents, family.limit)


@pytest.mark.parametrize("kbar", ["1/100", 7, 10**4])
def test_what_is_found_passes_the_exact_check(kbar):
    system = oscillator(kbar, PAIR)
    assert search(system).find_fault(system) is None


def test_nothing_is_found_where_the_middle_is_unstable():
    assert search(shears(PAIR)) is None
