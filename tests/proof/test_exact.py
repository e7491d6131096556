"""The trusted file. Published cases first, then independent oracles, then bad input."""

from fractions import Fraction
from math import gcd

import pytest
from flint import fmpz_mat
from hypothesis import example, given, settings
from hypothesis import strategies as st

from nrs_design.proof import exact
from nrs_design.proof import exact as trusted
from nrs_design.proof.mode import Time
from tests.proof.truth import is_definite, is_stable_by_lyapunov, times, transpose
from tests.support import matrix
from tests.tables import by_rows

SMALL = st.integers(-4, 4)
WIDE = st.integers(-(10**30), 10**30)
ENTRIES = st.one_of(SMALL, WIDE)
UP_TO_8 = st.integers(1, 8)


def squares(entries, sizes=UP_TO_8):
    return sizes.flatmap(
        lambda n: st.lists(st.lists(entries, min_size=n, max_size=n), min_size=n, max_size=n)
    )


def rectangle(rows, columns):
    entries = st.one_of(SMALL, WIDE)
    row = st.lists(entries, min_size=columns, max_size=columns)
    return st.lists(row, min_size=rows, max_size=rows)


def symmetric(M):
    return [
        [a + b for a, b in zip(*rows, strict=True)] for rows in zip(M, transpose(M), strict=False)
    ]


def hilbert(n, sign=1):
    """Integer multiple of the Hilbert matrix, the last diagonal entry optionally negated."""
    factor = 1
    for k in range(1, 2 * n):
        factor = factor * k // gcd(factor, k)
    M = [[factor // (i + j + 1) for j in range(n)] for i in range(n)]
    M[-1][-1] *= sign
    return M


class TestPositiveDefinite:
    @pytest.mark.parametrize("n", range(1, 13))
    def test_hilbert_matrices(self, n):
        # D. Hilbert 1894: positive definite, with determinants that no float resolves.
        assert exact.is_positive_definite(hilbert(n))
        assert n == 1 or not exact.is_positive_definite(hilbert(n, sign=-1))

    def test_hilbert_12_at_the_edge(self):
        # Taking det(H_n)/det(H_{n-1}) off the last entry makes it exactly singular.
        M = hilbert(12)
        last = Fraction(int(fmpz_mat(M).det()), int(fmpz_mat([r[:-1] for r in M[:-1]]).det()))
        scaled = [[e * last.denominator for e in row] for row in M]
        scaled[-1][-1] -= last.numerator
        assert not exact.is_positive_definite(scaled)
        scaled[-1][-1] += 1
        assert exact.is_positive_definite(scaled)

    @by_rows("M", "definite")
    def test_known_definite(self, M, definite):
        assert exact.is_positive_definite(M) is definite

    @given(squares(st.one_of(SMALL, WIDE)))
    def test_against_elimination_in_fractions(self, M):
        S = symmetric(M)
        assert exact.is_positive_definite(S) == is_definite(S)

    @by_rows("M")
    def test_not_symmetric_is_an_error(self, M):
        with pytest.raises(ValueError, match=r"symmetric|zip"):
            exact.is_positive_definite(M)

    def test_one_entry_off_by_one_is_not_symmetric(self):
        M = hilbert(8)
        M[2][5] += 1
        assert not exact.is_symmetric(M)


class TestLimits:
    @pytest.mark.parametrize(("n", "bits"), [(10, 10**5), (100, 100)])
    def test_the_largest_form(self, n, bits):
        M = [[2 ** (bits - 1) * (i == j == n // 2) for j in range(n)] for i in range(n)]
        assert not exact.is_too_large(M)
        M[-1][0] = -(2**bits)
        assert exact.is_too_large(M)

    def test_the_work_of_a_spectrum(self):
        """``n^4 b (1 + n b / 3000)``: products of long numbers take more."""
        assert exact.spectrum_work(10, 300) == 10**4 * 300 * 2
        assert exact.spectrum_work(2, 750) == 12_000 * 3 // 2
        assert exact.spectrum_work(5, 6_000) == 5**4 * 6_000 * 11
        assert exact.spectrum_work(1, 1) == 1

    def test_the_largest_spectrum(self):
        limit = trusted.MAX_SPECTRUM_WORK
        assert exact.spectrum_work(10, 5329) <= limit < exact.spectrum_work(10, 5330)

    @by_rows("M", "bits")
    def test_lengths(self, M, bits):
        assert exact.bit_length(M) == bits

    @pytest.mark.parametrize(("denominators", "common"), [([], 1), ([6], 6), ([4, 6, 1], 12)])
    def test_denominators_that_are_brought_together(self, denominators, common):
        assert exact.common_denominator(denominators) == common

    def test_the_longest_common_denominator(self):
        assert exact.common_denominator([2**99_999]) == 2**99_999
        assert exact.common_denominator([3, 2**60_000]) == 3 * 2**60_000
        assert exact.common_denominator([2**100_000]) is None
        assert exact.common_denominator([2**60_000, 3**30_000, 1]) is None


class TestPositiveSemidefinite:
    @by_rows("M", "semidefinite")
    def test_known_semidefinite(self, M, semidefinite):
        assert exact.is_positive_semidefinite(M) is semidefinite

    @pytest.mark.parametrize("M", [[], [[1, 2], [3, 1]], [[1, 0]]])
    def test_not_symmetric_is_an_error(self, M):
        with pytest.raises(ValueError, match=r"symmetric|zip"):
            exact.is_positive_semidefinite(M)

    @given(squares(SMALL, st.integers(1, 4)))
    def test_all_principal_minors(self, M):
        """A symmetric matrix is positive semidefinite iff no principal minor is negative."""
        S = symmetric(M)
        picked = ([i for i in range(len(S)) if mask >> i & 1] for mask in range(1, 2 ** len(S)))
        minors = (fmpz_mat([[S[i][j] for j in rows] for i in rows]).det() for rows in picked)
        assert exact.is_positive_semidefinite(S) == all(minor >= 0 for minor in minors)


@given(rectangle(2, 3), rectangle(2, 3), SMALL)
def test_sums(left, right, weight):
    added = [
        [a + weight * b for a, b in zip(*rows, strict=True)]
        for rows in zip(left, right, strict=True)
    ]
    assert exact.add(left, right, weight) == added
    assert exact.add(left, right) == exact.add(left, right, 1)


@pytest.mark.parametrize("other", [[[1]], [[1, 2]], [[1], [2]], [[1, 2], [3]]])
def test_only_matrices_of_one_shape_are_added(other):
    with pytest.raises(ValueError, match="zip"):
        exact.add([[1, 2], [3, 4]], other)


class TestProducts:
    @given(
        st.tuples(st.integers(1, 6), st.integers(1, 6), st.integers(1, 6)).flatmap(
            lambda sizes: st.tuples(rectangle(sizes[0], sizes[1]), rectangle(sizes[1], sizes[2]))
        )
    )
    def test_against_sums_of_products(self, factors):
        left, right = factors
        assert exact.multiply(left, right) == times(left, right)

    @given(squares(WIDE), SMALL)
    def test_congruence(self, Q, factor):
        L = [[factor + i, i * i - factor] for i in range(len(Q))]
        assert exact.congruence(L, Q) == times(transpose(L), times(Q, L))

    @by_rows("left", "right")
    def test_factors_that_do_not_fit(self, left, right):
        with pytest.raises(ValueError, match=r"needs as many|argument 2 is"):
            exact.multiply(left, right)


class TestCharacteristicPolynomial:
    @given(squares(st.one_of(SMALL, WIDE)))
    def test_against_flint(self, N):
        wanted = [int(c) for c in reversed(fmpz_mat(N).charpoly().coeffs())]
        assert exact.characteristic_polynomial(N) == wanted


class TestHurwitz:
    @by_rows("coefficients", "stable")
    def test_known_polynomials(self, coefficients, stable):
        assert exact.is_hurwitz_polynomial(coefficients) is stable

    @by_rows("A", "stable")
    def test_known_hurwitz_matrices(self, A, stable):
        assert exact.is_hurwitz(matrix(A).numerators) is stable

    @settings(deadline=None)
    @given(squares(ENTRIES, st.integers(1, 4)), st.sampled_from([0, 1, 3, 8, 2 * 10**30]))
    def test_against_the_lyapunov_equation(self, N, shift):
        shifted = [[e - shift * (i == j) for j, e in enumerate(r)] for i, r in enumerate(N)]
        assert exact.is_hurwitz(shifted) == is_stable_by_lyapunov(shifted, Time.CONTINUOUS)


class TestSchur:
    @by_rows("A", "stable")
    def test_known_schur_matrices(self, A, stable):
        M = matrix(A)
        assert exact.is_schur(M.numerators, M.denominator) is stable

    @settings(deadline=None)
    @given(squares(ENTRIES, st.integers(1, 4)), st.sampled_from([1, 2, 3, 4, 5, 8, 10**31]))
    @example([[1, 0], [0, 1]], 1)
    @example([[-1, 1], [0, -1]], 1)
    def test_against_the_stein_equation(self, N, denominator):
        A = [[Fraction(e, denominator) for e in row] for row in N]
        assert exact.is_schur(N, denominator) == is_stable_by_lyapunov(A, Time.DISCRETE)


@pytest.mark.parametrize("n", [16, 32])
def test_large_matrices(n):
    """Tridiagonal -2, 1, 1: eigenvalues -2 + 2 cos(...) < 0, inside (-4, 0)."""
    T = [[-2 if i == j else int(abs(i - j) == 1) for j in range(n)] for i in range(n)]
    assert exact.is_hurwitz(T)
    assert exact.is_positive_definite([[-e for e in row] for row in T])
    assert exact.is_schur(T, 4)
    T[0][0] += 2  # then the largest eigenvalue is positive
    assert not exact.is_hurwitz(T)


def test_multiples():
    assert exact.scaled([[1, -2]], 3) == [[3, -6]]
