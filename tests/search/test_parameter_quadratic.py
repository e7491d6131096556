"""Search for functions that are affine in a constant parameter."""

import pytest

from nrs_design.proof.switching import Switching
from nrs_design.search.parameter_quadratic import search_parameter_quadratic
from tests.proof.systems import oscillator, shears
from tests.search.support import found

PAIR = Switching(fixed_ends=(("m0", "m1"),))


@pytest.mark.parametrize("kbar", ["1/100", 7, 10**4])
def test_what_is_found_passes_the_exact_check(kbar):
    system = oscillator(kbar, PAIR)
    assert found(search_parameter_quadratic, system).find_fault(system) is None


def test_nothing_is_found_where_the_middle_is_unstable():
    assert found(search_parameter_quadratic, shears(PAIR)) is None
