"""Matrices as users hold them."""

import warnings
from fractions import Fraction

import control
import numpy as np
import pytest

from nrs_design.api.exact import read_matrix, read_number, read_rows, time_of
from nrs_design.errors import SpecError
from nrs_design.proof.mode import Time
from tests.tables import rows

F = Fraction
TENTH = F(3602879701896397, 2**55)
with warnings.catch_warnings():
    # NumPy advises against matrices; people hold them all the same.
    warnings.simplefilter("ignore", PendingDeprecationWarning)
    MATRIX = np.matrix([[0.1, 1], [2, 3]])


@pytest.mark.parametrize(
    "held",
    [
        np.array([[0.1, 1], [2, 3]]),
        [[0.1, 1], [2, 3]],
        ((F(3602879701896397, 2**55), 1), (2, 3.0)),
        [["3602879701896397/36028797018963968", "1"], [np.int64(2), np.float64(3)]],
        MATRIX,
        control.ss([[0.1, 1], [2, 3]], [[0], [1]], [[1, 0]], 0),
    ],
    ids=["array", "lists", "fractions", "texts", "matrix", "state space"],
)
def test_one_matrix_held_in_many_ways(held):
    assert read_rows(held) == [[TENTH, 1], [2, 3]]


def test_a_float_is_the_binary_number_that_it_is_and_text_is_what_is_written():
    assert read_number(0.1) == TENTH != F(1, 10)
    assert read_number("0.1") == F(1, 10)
    assert read_number(np.float32(0.1)) == F(13421773, 2**27)
    assert read_number(np.uint8(200)) == 200


def test_integer_arrays_keep_large_numbers():
    matrix = read_matrix(np.array([[2**62, 1], [1, -(2**62)]]))
    assert matrix.numerators == ((2**62, 1), (1, -(2**62)))
    assert all(type(entry) is int for row in matrix.numerators for entry in row)


@pytest.mark.parametrize(
    ("held", "said"),
    [
        *rows(__file__, "test_what_is_no_matrix_is_refused"),
        (np.zeros(3), "not a matrix"),
        ([[1j]], "not a real number"),
        (np.array([[1 + 0j]]), "not a real number"),
    ],
)
def test_what_is_no_matrix_is_refused(held, said):
    with pytest.raises(SpecError, match=said):
        read_rows(held)


def test_dt_decides_the_time():
    continuous = control.ss([[-1]], [[1]], [[1]], 0)
    sampled = control.ss([[0.5]], [[1]], [[1]], 0, 0.002)
    assert time_of([continuous], None) is Time.CONTINUOUS
    assert time_of([sampled, sampled], None) is Time.DISCRETE
    assert time_of([control.ss([[0.5]], [[1]], [[1]], 0, True)], None) is Time.DISCRETE
    assert time_of([np.eye(2)], None) is Time.CONTINUOUS
    assert time_of([np.eye(2)], "discrete") is Time.DISCRETE
    slower = control.ss([[0.5]], [[1]], [[1]], 0, 0.01)
    second = control.ss([[0.5]], [[1]], [[1]], 0, 1.0)
    unknown = control.ss([[0.5]], [[1]], [[1]], 0, True)
    assert time_of([unknown, slower], None) is Time.DISCRETE
    # True equals 1.0, but a step of a second is not one of any length.
    for mixed in ([continuous, sampled], [sampled, slower], [sampled, second]):
        with pytest.raises(SpecError, match="one time axis"):
            time_of(mixed, None)
    with pytest.raises(SpecError, match="one time axis"):
        time_of([sampled], "continuous")
    with pytest.raises(SpecError, match="not known"):
        time_of([sampled], "Discrete")


def test_a_common_denominator_is_bounded():
    rows = [[f"1/{10**90 + 2 * (10 * i + j) + 1}" for j in range(10)] for i in range(10)]
    with pytest.raises(SpecError, match="2048 binary digits"):
        read_matrix(rows)
    assert read_matrix([[5e-324, 1.0]]).denominator == 2**1074
