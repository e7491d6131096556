"""The fast check against the plain one: products, definiteness, and evidence, forged too."""

import json
from fractions import Fraction
from itertools import islice

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nrs_design.search.fast_check import (
    CLEAR_BITS,
    PACKED_ORDER,
    find_fault,
    is_clearly_positive_definite,
    multiply_packed,
)

from nrs_design.proof.evidence import read_evidence
from nrs_design.proof.exact import MAX_WORK, is_positive_definite, multiply
from nrs_design.proof.mode import Time
from nrs_design.search import fast_check
from tests.proof.graphs import common_quadratic
from tests.proof.systems import SYSTEMS, family, genuine
from tests.proof.tamper import mutations

SMALL = st.integers(-4, 4)
WIDE = st.integers(-(10**30), 10**30)


def rectangle(rows, columns, entries):
    row = st.lists(entries, min_size=columns, max_size=columns)
    return st.lists(row, min_size=rows, max_size=rows)


def symmetric(M):
    return [[M[i][j] + M[j][i] for j in range(len(M))] for i in range(len(M))]


SIZES = st.tuples(*[st.integers(1, 12)] * 3)
# What `verify` takes for a rejection.
REJECTIONS = (LookupError, TypeError, ValueError, ArithmeticError, AttributeError)


@given(
    SIZES.flatmap(
        lambda sizes: st.tuples(
            rectangle(sizes[0], sizes[1], st.one_of(SMALL, WIDE)),
            rectangle(sizes[1], sizes[2], st.one_of(SMALL, WIDE)),
        )
    )
)
def test_packed_products_are_products(factors):
    assert multiply_packed(*factors) == multiply(*factors)


@pytest.mark.parametrize("bits", [0, 1, 7, 30, 31, 64, 200])
@pytest.mark.parametrize("signs", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_the_largest_entries_of_all_sizes_do_not_overflow(bits, signs):
    a, b = (sign * (2**bits - 1) for sign in signs)
    for n in (1, 2, 3, 4, 8, 9, 16):
        packed = multiply_packed([[a] * n] * 2, [[b, -b, 1]] * n)
        assert packed == [[a * b * n, -a * b * n, a * n]] * 2


@pytest.mark.parametrize(
    ("left", "right"),
    [([[1]], [[1], [2]]), ([[1, 2]], [[1]]), ([[1, 2]], [[1, 2], [3]]), ([[1, 2], [3]], [[1]])],
)
def test_factors_that_do_not_fit(left, right):
    with pytest.raises(ValueError, match=r"needs as many|argument 2 is"):
        multiply_packed(left, right)


@given(
    st.integers(1, 8).flatmap(lambda n: rectangle(n, n, st.one_of(SMALL, WIDE))),
    st.integers(0, 10**31),
)
def test_what_is_clear_is_so(M, shift):
    S = symmetric(M)
    for i, row in enumerate(S):
        row[i] += shift
    assert is_positive_definite(S) or not is_clearly_positive_definite(S)


@given(
    st.integers(2, 7).flatmap(
        lambda n: st.tuples(
            st.lists(st.integers(0, 2 * CLEAR_BITS + 40), min_size=n, max_size=n),
            rectangle(n, n, SMALL),
        )
    ),
    st.sampled_from([-(2**40), -1, 0, 1, 2**40]),
)
def test_one_small_pivot_among_large_ones(drawn, last):
    """A congruence that rounding cannot see through: T' diag(2^e, ..., last) T, det T = 1."""
    exponents, entries = drawn
    n = len(exponents)
    T = [[entries[i][j] if j > i else int(i == j) for j in range(n)] for i in range(n)]
    pivots = [*(2**e for e in exponents[:-1]), last]
    M = [[sum(T[k][i] * pivots[k] * T[k][j] for k in range(n)) for j in range(n)] for i in range(n)]
    assert is_positive_definite(M) == (last > 0)
    assert last > 0 or not is_clearly_positive_definite(M)


def test_what_is_well_conditioned_is_clear():
    assert is_clearly_positive_definite([[2, -1, 0], [-1, 2, -1], [0, -1, 2]])
    assert is_clearly_positive_definite([[2**90, 1], [1, 2**90]])


@pytest.mark.parametrize("M", [[], [[0]], [[2, 1], [0, 2]], [[1, 0]], [[2 ** (MAX_WORK + 1)]]])
def test_nothing_is_clear_that_the_plain_check_would_not_accept(M):
    assert not is_clearly_positive_definite(M)


@pytest.mark.parametrize("every", [5, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize("example", SYSTEMS)
def test_genuine_and_forged_evidence_meets_the_same_answer(example, every, monkeypatch):
    monkeypatch.setattr(fast_check, "PACKED_ORDER", 1)
    system, evidence = genuine(example)
    assert find_fault(evidence, system) is None
    stored = json.loads(json.dumps({"kind": evidence.kind, **evidence.to_fields()}))
    for words, fields in islice(mutations(stored), None, None, every):
        try:
            forged = read_evidence(fields, system)
        except REJECTIONS:
            continue
        assert find_fault(forged, system) == forged.find_fault(system), words


@pytest.mark.parametrize("time", list(Time))
@settings(max_examples=25)
@given(data=st.data())
def test_large_orders_meet_the_same_answer(time, data):
    """Diagonally dominant modes with Q = I, at rates on both sides of the best."""
    n = PACKED_ORDER
    rows = data.draw(rectangle(n, n, SMALL))
    own = -20 if time is Time.CONTINUOUS else 0
    A = [[Fraction(e + own * (i == j), 20) for j, e in enumerate(r)] for i, r in enumerate(rows)]
    system = family(A, time=time)
    Q = tuple(tuple(int(i == j) for j in range(n)) for i in range(n))
    claimed = common_quadratic(Q, 0, Fraction(data.draw(st.integers(1, 39)), 40))
    for evidence in (claimed, common_quadratic((*Q[:-1], (1, *Q[-1][1:])), 0, claimed.rate)):
        assert find_fault(evidence, system) == evidence.find_fault(system)
