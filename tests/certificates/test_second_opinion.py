"""Flint's veto: it agrees on everything that is right, and stops everything else."""

from dataclasses import replace
from fractions import Fraction

import flint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.certificates.second_opinion import agrees, finds_positive, has_positive_spectrum
from nrs_design.controllers.taylor import exponential_nearly
from nrs_design.errors import InternalError
from nrs_design.proof.channels import Rounding
from nrs_design.proof.evidence import BlockTriangular
from nrs_design.proof.evidence.growing_sequence import GrowingSequence, staying
from nrs_design.proof.exact import is_positive_definite
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.certify import certify
from tests.proof.graphs import common_quadratic, mode_quadratic
from tests.proof.systems import PAIR, SYSTEMS, family, genuine, matrix
from tests.tables import rows

INTS = st.integers(-9, 9)
STABLE = family([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])
UNSTABLE = family([[-1, 0], [0, -2]], [[0, 1], [-1, 0]])
CONTINUOUS, DISCRETE = Time
HALF, TINY = Fraction(1, 2), Fraction(1, 2**60)


@settings(deadline=None)
@given(st.sampled_from([1, 4, 9, 16, 25]).flatmap(lambda k: st.lists(INTS, min_size=k, max_size=k)))
def test_descartes_agrees_with_bareiss(entries):
    n = round(len(entries) ** 0.5)
    M = [
        [entries[i * n + j] + entries[j * n + i] + 12 * (i == j) for j in range(n)]
        for i in range(n)
    ]
    assert has_positive_spectrum(flint.fmpz_mat(M)) == is_positive_definite(M)
    # Long numbers are rounded down at first; what is just definite is not lost, nor gained.
    units = [3 ** (40 * i) for i in range(n)]
    long = [
        [a * b * e << 99 for b, e in zip(units, row, strict=True)]
        for a, row in zip(units, M, strict=True)
    ]
    assert finds_positive(long) == is_positive_definite(M)
    assert finds_positive(M) == is_positive_definite(M)


@pytest.mark.parametrize("off", [-1, 0, 1])
def test_a_matrix_that_is_nearly_singular(off):
    """What rounding would hide is decided from the matrix itself."""
    large = 2**200
    M = [[large, large], [large, large + off]]
    assert finds_positive(M) == is_positive_definite(M) == (off > 0)


def test_what_rounding_down_would_make_positive():
    """Rounded down to multiples of 2^152, the entries beside the diagonal lose nearly one."""
    large, unit = 2**199, 2**152
    beside = large + unit - 1
    M = [[large, beside], [beside, large + unit]]
    short = [[large // unit, beside // unit], [beside // unit, large // unit + 1]]
    assert is_positive_definite(short)
    assert not is_positive_definite(M)
    assert not finds_positive(M)


def test_no_proof_without_flint(monkeypatch):
    class Upset:
        def __init__(self, rows):
            self.n = len(rows)

        def charpoly(self):
            return flint.fmpz_poly([1] * self.n + [1])

    monkeypatch.setattr(flint, "fmpz_mat", Upset)
    with pytest.raises(InternalError, match="disagree"):
        certify(STABLE)


def test_no_refutation_without_flint(monkeypatch):
    evidence = certify(UNSTABLE).evidence

    class Calm:
        def __init__(self, rows):
            pass

        def charpoly(self):
            return flint.fmpz_poly([1, 1])

    monkeypatch.setattr(flint, "fmpz_mat", Calm)
    assert not agrees(UNSTABLE, evidence)
    with pytest.raises(InternalError, match="disagree"):
        certify(UNSTABLE)


def test_veto_on_a_stable_mode_called_unstable():
    assert not agrees(STABLE, staying("m0"))
    discrete = family([["1/2"]], time=Time.DISCRETE)
    assert not agrees(discrete, staying("m0"))


@pytest.mark.parametrize(
    "example", ["mode-quadratic, dwell", "mode-quadratic, left in time", "growing-sequence, period"]
)
def test_no_exponential_without_a_taylor_series(monkeypatch, example):
    """An enclosure by flint that is a little off meets with a veto."""
    system, evidence = genuine(example)
    assert agrees(system, evidence)
    exp = flint.arb_mat.exp

    class Off(flint.arb_mat):
        def exp(self):
            return exp(self) * (1 + flint.arb(2) ** -150)

    monkeypatch.setattr(flint, "arb_mat", Off)
    assert not agrees(system, evidence)


@pytest.mark.parametrize("example", SYSTEMS)
def test_agreement_on_everything_that_holds(example):
    assert agrees(*genuine(example))


@pytest.mark.parametrize(("coefficients", "positive"), rows(__file__, "test_signs_by_descartes"))
def test_signs_by_descartes(coefficients, positive):
    class Known:
        def charpoly(self):
            return flint.fmpz_poly(coefficients)

    assert has_positive_spectrum(Known()) is positive


@pytest.mark.parametrize(
    ("matrices", "time", "Q", "rate", "holds"),
    rows(__file__, "test_opinion_on_a_quadratic_function"),
)
def test_opinion_on_a_quadratic_function(matrices, time, Q, rate, holds):
    number, moved = rate
    Q = tuple(map(tuple, Q))
    evidence = common_quadratic(Q, 0, Fraction(number) + moved * TINY)
    system = family(*matrices, time=Time(time))
    assert agrees(system, evidence) is holds
    assert (evidence.find_fault(system) is None) is holds


@pytest.mark.parametrize(("rate", "holds"), [("0.7501", True), ("0.7499", False)])
def test_opinion_on_a_function_with_rounding(rate, holds):
    """``x+ = x/2 + r`` with ``|r| <= |x|/4``: 3/4 at worst, where without it 1/2 is."""
    one = matrix([[1]])
    system = family([["1/2"]], time=DISCRETE)
    rounded = replace(system, roundings=(Rounding("x", (one,), (matrix([["1/4"]]),)),))
    covered = common_quadratic(((1,),), 0, Fraction(rate), (3,))
    assert agrees(rounded, covered) is holds
    assert (covered.find_fault(rounded) is None) is holds
    assert agrees(rounded, replace(covered, multipliers=()))


@pytest.mark.parametrize(
    ("A", "time", "is_vetoed"), rows(__file__, "test_veto_on_what_is_surely_stable")
)
def test_veto_on_what_is_surely_stable(A, time, is_vetoed):
    calm, time = [["-1/4", 0], [0, "-1/4"]], Time(time)
    system = family(calm, A, time=time)
    assert agrees(system, staying("m1")) is not is_vetoed
    assert not agrees(system, staying("m0"))
    # A mixture of the two halves, which is A.
    whole = [[2 * Fraction(entry) for entry in row] for row in A]
    halves = family(whole, [[0, 0], [0, 0]], time=time)
    mixed = GrowingSequence((("m0", HALF), ("m1", HALF)))
    assert agrees(halves, mixed) is not is_vetoed
    # The parameter's value in the middle of these.
    ends = replace(halves, switching=PAIR)
    assert agrees(ends, replace(staying("m0 to m1"), shares=(HALF,))) is not is_vetoed


def test_every_part_of_a_block_triangular_system_is_asked():
    system = family([[-1, 5], [0, -2]])
    one = common_quadratic(((1,),), 0, HALF)
    fast = replace(one, rate=Fraction(3, 2))
    for first, second, holds in ((one, fast, True), (fast, one, False), (fast, fast, False)):
        assert agrees(system, BlockTriangular(((0,), (1,)), ((0, first), (1, second)))) is holds


def test_every_form_is_asked():
    """Of the kinds of which nothing is formed anew."""
    system = family([["-1/2"]], [["1/4"]], time=DISCRETE, switching=Switching(Fraction(2)))
    for first, second, holds in ((1, 1, True), (1, 20, False), (100, 1, False), (-1, 1, False)):
        functions = (("m0", ((first,),)), ("m1", ((second,),)))
        assert agrees(system, mode_quadratic(functions, 0, Fraction(3, 4))) is holds


def recorded(monkeypatch, system, evidence):
    """Return the times for which a Taylor series was asked, by the first entry of its matrix."""
    asked = []

    def record(A, time):
        asked.append((A.fractions()[0][0], time))
        return exponential_nearly(A, time)

    monkeypatch.setattr("nrs_design.controllers.taylor.exponential_nearly", record)
    assert agrees(system, evidence)
    return sorted(asked)


def test_both_ends_of_every_stay_meet_a_series(monkeypatch):
    stays = (("m0", Stay(HALF, Fraction(1))), ("m1", Stay(Fraction(3), Fraction(4))))
    system = family([[1]], [[-2]], [[-3]], switching=Switching(stays=stays))
    functions = tuple((f"m{k}", ((q,),)) for k, q in enumerate((400, 1, 1)))
    one_way = replace(system.switching, transitions=(("m0", "m1"),))
    evidence = mode_quadratic(functions, 0, Fraction(1, 8), ("m0",), 8)
    asked = recorded(monkeypatch, replace(system, switching=one_way), evidence)
    # At the rate 1/8; m1 decreases, so that its longest stay is of no interest; m2 has no dwell.
    assert asked == [
        (Fraction(-15, 8), Fraction(3)),
        (Fraction(9, 8), HALF),
        (Fraction(9, 8), Fraction(1)),
    ]


def test_every_step_of_a_period_meets_a_series(monkeypatch):
    system, evidence = genuine("growing-sequence, period")
    modes = {mode.name: mode.A.fractions()[0][0] for mode in system.modes}
    asked = recorded(monkeypatch, system, evidence)
    assert asked == sorted((modes[name], time) for name, time in evidence.steps)


@pytest.mark.parametrize("example", ["mode-quadratic, left", "growing-sequence, steps"])
def test_no_series_where_steps_are_counted(monkeypatch, example):
    assert recorded(monkeypatch, *genuine(example)) == []
