"""Search for one function per mode."""

import numpy as np
import pytest

from nrs_design.certificates.search.allowance import Allowance
from nrs_design.certificates.search.family import Family
from nrs_design.certificates.search.mode_quadratic import _Found, _Problem, find_mode_functions
from nrs_design.switched.system import Switching
from tests.certificates.systems import (
    ando_shih,
    geromel_colaneri,
    rectangular,
    shears,
    slow_switching_in_steps,
)


@pytest.mark.parametrize(
    "system",
    [geromel_colaneri("2.752"), ando_shih("0.99"), rectangular(), slow_switching_in_steps()],
)
def test_what_is_found_passes_the_exact_check(system):
    assert find_mode_functions(system, Family.of(system).limit).find_fault(system) is None


@pytest.mark.parametrize("system", [geromel_colaneri("2.74"), shears(), ando_shih("1.001")])
def test_nothing_is_found_where_there_is_nothing(system):
    assert find_mode_functions(system, Family.of(system).limit) is None


def test_no_ends_of_constant_parameters():
    system = shears(Switching(transitions=(), fixed_ends=(("m0", "m1"),)))
    assert find_mode_functions(system, Family.of(system).limit) is None


@pytest.mark.parametrize(
    "lie", [np.nan, np.inf, -1.0, 0.0, 1e300],
)  # fmt: skip
def test_functions_that_lie_give_no_verdict(lie):
    system = geromel_colaneri("2.76")
    problem = _Problem(system, 1)
    functions = [np.full((2, 2), lie)] * 2
    try:
        assert problem.round(_Found(functions, []), 1e-3) is None
    except (OverflowError, ValueError):
        return


@pytest.mark.parametrize("rate", [0.0, -1.0, 0.5, 1e300])
def test_rates_that_lie_give_no_verdict(rate):
    system = geromel_colaneri("2.76")
    problem = _Problem(system, 1)
    found = problem.solve(1e-4, Allowance())
    assert problem.round(found, rate) is None
