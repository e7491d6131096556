"""The exact verdict on a proposed quadratic function."""

from fractions import Fraction

import pytest
from flint import fmpq_mat, fmpz_mat
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.api.lyapunov import check_quadratic, decrease, indefinite_vector
from nrs_design.proof.exact import TooLargeError
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from tests.proof import truth
from tests.support import matrix
from tests.tables import rows

F = Fraction
entries = st.integers(-6, 6)
symmetric = st.integers(1, 4).flatmap(
    lambda n: st.lists(entries, min_size=n * n, max_size=n * n).map(
        lambda flat: [[flat[min(i, j) * n + max(i, j)] for j in range(n)] for i in range(n)]
    )
)


def modes(*matrices):
    return [Mode(f"m{k}", matrix(A)) for k, A in enumerate(matrices)]


# Dayawansa and Martin 1999, a = 5, below 3 + 2 sqrt(2).
PAIR = modes([[-1, -1], [1, -1]], [[-1, -5], ["1/5", -1]])


def test_holds_at_a_rate_that_is_decided():
    P = matrix([[1, 0], [0, 5]])
    found = check_quadratic(PAIR, P, Time.CONTINUOUS)
    assert found.holds
    assert found.weak
    assert found.counterexample is None
    # By hand: in mode 1 the decrease at alpha is [[2-2a, -4], [-4, 10-10a]], singular at
    # (1-a)^2 = 4/5.
    limit = 1 - (F(4) / 5).numerator ** 0.5 / (F(4) / 5).denominator ** 0.5
    assert found.rate is not None
    assert float(found.rate) <= limit
    assert float(found.rate) == pytest.approx(limit, rel=1e-4)
    assert check_quadratic(PAIR, P, Time.CONTINUOUS, found.rate).holds
    assert bool(found) is True


@pytest.mark.parametrize(
    ("A", "time", "rate", "holds"), rows(__file__, "test_decided_at_the_rate_that_is_asked_for")
)
def test_decided_at_the_rate_that_is_asked_for(A, time, rate, holds):
    found = check_quadratic(modes([[A]]), matrix([[1]]), Time[time], F(rate))
    assert found.holds is holds
    assert found.weak
    if holds:
        assert found.rate == F(rate)


@pytest.mark.parametrize(("A", "time", "rate"), rows(__file__, "test_the_best_rate_by_hand"))
def test_the_best_rate_by_hand(A, time, rate):
    assert check_quadratic(modes([[A]]), matrix([[1]]), Time[time]).rate == F(rate)


@pytest.mark.parametrize(
    ("matrices", "P", "weak"), rows(__file__, "test_weak_is_no_increase_in_any_mode")
)
def test_weak_is_no_increase_in_any_mode(matrices, P, weak):
    found = check_quadratic(modes(*matrices), matrix(P), Time.CONTINUOUS)
    assert (found.holds, found.weak, found.rate) == (False, weak, None)


@pytest.mark.parametrize(
    ("given_modes", "P", "time", "rate", "said"),
    [
        ([*modes([[-1]]), PAIR[0]], [[1]], Time.CONTINUOUS, None, "not every mode is 1 x 1"),
        (PAIR, [[1, 0, 0], [0, 1, 0]], Time.CONTINUOUS, None, "P is 2 x 3, and not every"),
        (PAIR, [[1], [0]], Time.CONTINUOUS, None, "P is 2 x 1, and not every"),
        (PAIR, [[1, 1], [0, 5]], Time.CONTINUOUS, None, "symmetric"),
        ([], [[1]], Time.CONTINUOUS, None, "no mode"),
        (modes([["1/2"]]), [[1]], Time.CONTINUOUS, F(-1, 10**9), "rate of decay"),
        *(
            (modes([["1/2"]]), [[1]], Time.DISCRETE, rate, "rate of decay")
            for rate in (F(0), F(-1, 9), F(10, 9))
        ),
    ],
)
def test_what_is_no_question(given_modes, P, time, rate, said):
    with pytest.raises(ValueError, match=said):
        check_quadratic(given_modes, matrix(P), time, rate)


def rational(M):
    return fmpq_mat(fmpz_mat(M))


@given(symmetric)
def test_a_vector_is_found_exactly_where_a_matrix_is_not_definite(M):
    if truth.is_definite(M):
        with pytest.raises(ValueError, match="positive definite"):
            indefinite_vector(rational(M))
        return
    x = indefinite_vector(rational(M))
    assert any(x)
    rows = zip(x, M, strict=True)
    assert sum(u * m * v for u, row in rows for m, v in zip(row, x, strict=True)) <= 0


@given(symmetric, symmetric, st.sampled_from(list(Time)))
def test_the_verdict_comes_with_its_reason(A, P, time):
    if len(A) != len(P):
        A = [[int(i == j) * -1 for j in range(len(P))] for i in range(len(P))]
    found = check_quadratic(modes(A), RationalMatrix.from_rows(P), time)
    assert found.holds == (found.counterexample is None) == (found.rate is not None)
    if found.counterexample is not None and found.counterexample.mode is not None:
        assert found.counterexample.value >= 0
    if found.rate is not None:
        assert check_quadratic(modes(A), RationalMatrix.from_rows(P), time, found.rate).holds


@pytest.mark.parametrize(
    ("beyond", "third"), rows(__file__, "test_a_vector_has_as_few_digits_as_show_it")
)
def test_a_vector_has_as_few_digits_as_show_it(beyond, third):
    """``(x - y/3)^2 - e y^2`` is not positive within sqrt(e) of x = 1/3, y = 1."""
    P = matrix([[1, F(-1, 3)], [F(-1, 3), F(1, 9) - F(beyond)]])
    found = check_quadratic(PAIR, P, Time.CONTINUOUS).counterexample
    assert found.mode is None
    assert found.vector == (F(third), 1)
    assert found.value == (F(third) - F(1, 3)) ** 2 - F(beyond)


@pytest.mark.parametrize(
    ("time", "rate", "value"),
    [
        # By hand at x = (1, 0): A x = (-1, 2), P x = (3, 1).
        (Time.CONTINUOUS, F(1), 2 * (3 * -1 + 1 * 2) + 2 * 3),
        (Time.CONTINUOUS, F(5), 2 * (3 * -1 + 1 * 2) + 2 * 5 * 3),
        (Time.DISCRETE, F(1), 3 - 4 + 4 * 2 - 3),
        (Time.DISCRETE, F(1, 2), 3 - 4 + 4 * 2 - F(3, 4)),
    ],
)
def test_the_value_along_a_mode_by_hand(time, rate, value):
    given = modes([[-1, 0], [2, 0]])
    found = check_quadratic(given, matrix([[3, 1], [1, 2]]), time, rate).counterexample
    assert (found.mode, found.vector, found.value) == ("m0", (1, 0), value)


def diagonal(n, longest, denominator=1):
    """A decay of 1 in all states but the last, which has a number of so many bits."""
    last = -(2 ** (longest - 1))
    numerators = [
        [last * (i == n - 1) - (i < n - 1) if i == j else 0 for j in range(n)] for i in range(n)
    ]
    return Mode("m", RationalMatrix(tuple(map(tuple, numerators)), denominator))


def unit(n, factor=1):
    return matrix([[factor * (i == j) for j in range(n)] for i in range(n)])


# One decision about one mode of ten states and P takes 2 * 10^3 times the bits: of the mode and
# the rate, four for the sum of ten numbers, and those of P; in steps all but the last twice.
def test_the_largest_numbers_that_are_decided():
    check = check_quadratic([diagonal(10, 24_994)], unit(10), Time.CONTINUOUS)
    assert (check.holds, check.rate) == (True, None)
    assert check_quadratic([diagonal(10, 1, 2**24_993)], unit(10), Time.CONTINUOUS).holds
    for mode, P, rate in (
        (diagonal(10, 1, 2**24_994), unit(10), None),
        (diagonal(10, 24_995), unit(10), None),
        (diagonal(10, 24_994), unit(10, 2), None),
        (diagonal(10, 24_994), unit(10), F(1, 2)),
        (diagonal(10, 24_994), unit(10), F(2)),
    ):
        with pytest.raises(TooLargeError, match="too large"):
            check_quadratic([mode], P, Time.CONTINUOUS, rate)
    for pair in ([diagonal(10, 1), diagonal(10, 24_994)], [diagonal(10, 24_994), diagonal(10, 1)]):
        with pytest.raises(TooLargeError, match="too large"):
            check_quadratic(pair, unit(10), Time.CONTINUOUS)


def test_the_largest_numbers_for_which_a_rate_is_looked_for():
    found = check_quadratic([diagonal(10, 4_994)], unit(10), Time.CONTINUOUS)
    assert (found.holds, found.rate) == (True, 1 - F(1, 2**21))
    found = check_quadratic([diagonal(10, 4_995)], unit(10), Time.CONTINUOUS)
    assert (found.holds, found.rate) == (True, None)
    found = check_quadratic([diagonal(10, 4_995)], unit(10), Time.CONTINUOUS, F(2))
    assert (found.holds, found.weak, found.rate) == (False, True, None)


def test_vectors_by_hand():
    for M, x in (
        ([[1, 0, 0], [0, 1, 1], [0, 1, 1]], (0, -1, 1)),
        ([[3, 1, 0], [1, 3, 1], [0, 1, 0]], (F(1, 8), F(-3, 8), 1)),
        ([[0, 1], [1, 5]], (1, 0)),
    ):
        assert indefinite_vector(rational(M)) == x


@pytest.mark.parametrize("rate", ["0", "1/7", "2", "1/4", "1/24"])
@pytest.mark.parametrize("time", Time)
def test_what_must_be_definite_is_the_decrease(time, rate):
    A, Q = matrix([["-1/2", "1/3"], ["0.25", -2]]), ((3, 1), (1, 2))
    numerators = rational([[int(x * 12) for x in row] for row in A.fractions()])
    found = decrease(numerators / 12, rational(Q), F(rate), time)
    entries = [[F(int(x.p), int(x.q)) for x in row] for row in found.table()]
    assert truth.is_positive_multiple(entries, truth.decrease(A.fractions(), Q, F(rate), time))
