"""Conversion of exact modes to floating point."""

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.search.candidates import OUT_OF_RANGE
from nrs_design.search.common_quadratic import search_by_lmi
from nrs_design.search.family import Family, floats_in_silence
from tests.support import dayawansa_martin, family


def test_matrices_are_balanced_and_the_exponents_undo_it():
    system = family([[-1, 2**20], [0, -1]], [[-1, 0], ["1/1048576", -1]])
    converted = Family.of(system)
    assert np.abs(converted.matrices).max() <= 2
    powers = 2.0**converted.exponents
    undone = powers[None, :, None] * converted.matrices / powers[None, None, :]
    np.testing.assert_array_equal(undone, [mode.A.floats() for mode in system.modes])


def test_limit_is_the_rate_of_the_slowest_mode():
    modes = [[-2, 0], [0, -3]], [[-1, 5], [0, -4]]
    assert Family.of(family(*modes)).limit == 1.0
    discrete = family([["1/2", 0], [0, "1/4"]], [["1/8", 0], [0, "-3/4"]], time=Time.DISCRETE)
    assert Family.of(discrete).limit == 0.75


def test_numbers_that_no_machine_integer_holds():
    third = family([["-1/3", 10**30], [0, -1]])
    with floats_in_silence():
        assert Family.of(third).limit == 1 / 3


def test_conversion_never_raises_and_the_searches_say_that_they_cannot_work():
    with floats_in_silence():
        converted = Family.of(family([[-1, 10**400], [0, -1]]))
        assert np.isnan(converted.limit)
        with pytest.raises(StopIteration) as end:
            next(search_by_lmi(converted))
        assert end.value.value == OUT_OF_RANGE
    assert np.isfinite(Family.of(dayawansa_martin(5)).matrices).all()
