"""The modes in floating point."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.search.family import Family, floats_in_silence
from tests.proof.systems import family


def test_scaling_is_a_similarity_by_powers_of_two():
    system = family([[-1, 2**20], [0, -3]], [[-2, 2**21], [-1, -3]])
    found = Family.of(system)
    D = np.diag(2.0**found.exponents)
    for mode, scaled in zip(system.modes, found.matrices, strict=True):
        assert D @ scaled @ np.linalg.inv(D) == pytest.approx(np.array(mode.A.floats()))


def test_numbers_beyond_floating_point_do_not_crash():
    with floats_in_silence():
        Family.of(family([[-(10**400), 0], [0, -1]]))


def test_modes_that_differ_by_the_last_digits_have_one_that_stands_for_them():
    nearly = Fraction(1, 2) + Fraction(1, 10**20)
    matrices = [["1/2", 1], [0, "1/4"]], [[nearly, 1], [0, "1/4"]], [["1/2", "1.001"], [0, "1/4"]]
    discrete = family(*matrices, time=Time.DISCRETE)
    assert Family.of(discrete).stand_ins() == {"m0": "m0", "m1": "m0", "m2": "m2"}
    ruled = family(*matrices, time=Time.DISCRETE, switching=Switching(Fraction(3)))
    assert Family.of(ruled).stand_ins() == {}
    assert Family.of(family(*matrices)).stand_ins() == {}


def test_numbers_that_no_machine_integer_holds():
    with floats_in_silence():
        assert Family.of(family([["-1/3", 10**30], [0, -1]])).limit == 1 / 3
