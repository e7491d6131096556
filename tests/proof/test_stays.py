"""Stays and switches as steps: powers, enclosures and limits, against the definition."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.proof import stays as module
from nrs_design.proof.exact import is_positive_definite
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.stays import EnclosedStep, find_odd_stays, power, shifted, steps_of_stays
from nrs_design.proof.steps import Stays
from nrs_design.proof.switching import Edge, Stay, Switching
from tests.proof.graphs import mode_quadratic, scalars
from tests.proof.systems import family, left_within, resets_between
from tests.tables import by_rows

A = RationalMatrix.from_rows([[Fraction(1, 2), 3], [-1, Fraction(2, 7)]])
HALF, IN_STEPS = Fraction(1, 2), {"time": Time.DISCRETE}
LONG = "the dwell time is too long for such large numbers"
PIECES = "the stays are enclosed in too few or too many pieces"
SWITCHES = "there are too many switches to check"
RESETS = resets_between(("m0", "m1", [[1, 0], [0, 1]]), ("m1", "m0", [[1, 0], [0, 1]]))


def odd(system, leaving=(), pieces=1, bits=1):
    return find_odd_stays(system, Stays(leaving, pieces), bits)


@pytest.mark.parametrize("M", [A, RationalMatrix.from_rows([[3]])])
def test_a_power_is_a_product_of_as_many_factors(M):
    n = range(M.shape[0])
    product = [[Fraction(int(i == j)) for j in n] for i in n]
    for exponent in range(9):
        assert power(M, exponent).fractions() == product
        F = M.fractions()
        product = [[sum(product[i][k] * F[k][j] for k in n) for j in n] for i in n]


def test_a_shift_is_added_to_the_diagonal():
    assert shifted(A, Fraction(1, 3)).fractions() == [[Fraction(5, 6), 3], [-1, Fraction(13, 21)]]


# exp(-2) is 0.1353...: one thousand decreases to a tenth of it, 7389 being exp(2) of it.
@by_rows("given", "shown")
def test_the_form_of_a_stay_against_the_exponential(given, shown):
    entry, rate, begin, end, before, after, *gain = given
    source, target = (Mode(name, RationalMatrix.from_rows([[entry]])) for name in "ij")
    reset = RationalMatrix.from_rows([[Fraction(gain[0])]]) if gain else None
    step = EnclosedStep("", Edge(source, target, reset), Fraction(begin), Fraction(end))
    form = step.form(((before,),), ((after,),), Fraction(rate))
    assert is_positive_definite(form) is shown
    assert (step.mode, step.source, step.target) == ("i", "i", "j")


@pytest.mark.parametrize(("first", "shown"), [("0.9995", False), ("1.001", True)])
def test_between_the_ends_of_a_stay_a_form_may_rise(first, shown):
    """Of a rotation, ``F - v v'`` with v = (cos t, sin t) is least at t = pi, in the middle.

    Both ends, 0.05 from there, would pass in both cases: what is between is of second order.
    """
    turn = RationalMatrix.from_rows([[0, 1], [-1, 0]])
    edge = Edge(Mode("i", turn), Mode("j", turn), None)
    middle, half, over = Fraction(355, 113), Fraction(1, 20), 10**4
    before = ((int(Fraction(first) * over), 0), (0, 100 * over))
    after = ((over, 0), (0, 0))
    for time in (middle - half, middle + half):
        end = EnclosedStep("", edge, time, time)
        assert is_positive_definite(end.form(before, after, Fraction(0)))
    step = EnclosedStep("", edge, middle - half, middle + half)
    form = step.form(before, after, Fraction(0))
    assert len(form) == 4
    assert not any(any(row[2:]) for row in form[:2])
    assert is_positive_definite(form) is shown


def test_forms_of_steps_by_hand():
    """``rho^2k Q0 - (G A^k)^2 Q1`` for A = 1/3, G = 2/5, rho = 3/4, over ``(5 3^k 4^k)^2``."""
    resets = resets_between(("m0", "m1", [["2/5"]]))
    rules = replace(left_within((2, 3), (1, 4)), resets=resets)
    system = family([["1/3"]], [["1/2"]], **IN_STEPS, switching=rules)
    evidence = scalars(7, 11, rate=Fraction(3, 4), leaving=("m0",))
    first, second, m1, two, three, back = (form[0][0] for _, form in evidence.forms(system))
    assert (first, second) == (7, 11)
    assert m1 == 4**2 * 11 * (Fraction(9, 16) - Fraction(1, 4))
    for k, form in ((2, two), (3, three)):
        decrease = Fraction(3, 4) ** (2 * k) * 7 - (Fraction(2, 5) / 3**k) ** 2 * 11
        assert form == (5 * 3**k * 4**k) ** 2 * decrease
    assert back == 4**2 * (Fraction(9, 16) * 11 - Fraction(1, 4) * 7)
    words = [failure.removeprefix("V does not decrease at the claimed rate ") for failure, _ in
             evidence.forms(system)]  # fmt: skip
    assert words[2:] == [
        "in mode m1",
        "after some stay, from m0 to m1",
        "after some stay, from m0 to m1",
        "after the dwell time, from m1 to m0",
    ]


def test_the_state_moves_before_it_is_reset():
    resets = resets_between(("m0", "m1", [[0, 1], [0, 0]]))
    rules = Switching(transitions=(("m0", "m1"),), resets=resets)
    system = family([[0, 0], ["1/2", 0]], [[0, 0], [0, 0]], **IN_STEPS, switching=rules)
    forms = (("m0", ((1, 0), (0, 1))), ("m1", ((1, 0), (0, 1))))
    *_, (_, form) = mode_quadratic(forms, 0, Fraction(3, 4)).forms(system)
    # A x = (0, x1/2), and the reset takes that to (x1/2, 0).
    assert form[0][0] * 9 * 4 == form[1][1] * (9 * 4 - 16) * (4 if form[0][0] > form[1][1] else 1)


def test_pieces_of_a_stay():
    system = family([[1]], [[-2]], switching=left_within((HALF, 2), (3, 4)))
    steps = list(steps_of_stays(system, Stays(("m0",), 3), lambda count: 1))
    assert all(step.time for step in steps)
    asked = [(s.mode, s.begin, s.end) for s in steps if isinstance(s, EnclosedStep)]
    ends = [HALF, Fraction(1), Fraction(3, 2), Fraction(2)]
    pieces = [("m0", *pair) for pair in pairwise(ends)]
    assert asked == [*pieces, ("m1", Fraction(3), Fraction(3))]


@pytest.mark.parametrize(("gain", "rises"), [("4/3", False), ("-4/3", False), ("1.34", True)])
def test_a_switch_at_once_may_not_raise_the_function(gain, rises):
    """``16 - (4/3)^2 9`` is zero."""
    rules = Switching(transitions=(("m0", "m1"),), resets=resets_between(("m0", "m1", [[gain]])))
    system = family([[-1]], [[-1]], switching=rules)
    fault = "V rises at the switch from m0 to m1" if rises else None
    assert scalars(16, 9).find_misfit(system) == fault
    # Half a second of decay makes up for a function that is twice as large.
    later = Switching(HALF, (("m0", "m1"),))
    slow = replace(scalars(1, 2), rate=Fraction(1, 100))
    assert "rises" in slow.find_fault(replace(system, switching=replace(later, dwell_time=0)))
    assert slow.find_fault(replace(system, switching=later)) is None


@by_rows("dwell", "time", "fault", time=Time, dwell=Fraction)
def test_dwell_times_within_the_limits(dwell, time, fault):
    system = family([["-1/2"]], [["-1/2"]], time=time)
    assert odd(replace(system, switching=Switching(Fraction(dwell)))) == fault
    for stays in ((1, dwell), (dwell, dwell)), ((dwell, dwell), (1, dwell)):
        left = replace(system, switching=left_within(*stays))
        assert odd(left, ("m0", "m1")) == fault


@by_rows("leaving", "fault")
def test_only_what_must_be_left_need_not_decrease(leaving, fault):
    assert odd(family([[-1]], [[-1]], switching=left_within((0, 1))), leaving) == fault


@pytest.mark.parametrize("transitions", [(), (("m1", "m0"),)])
def test_what_must_be_left_can_be_left(transitions):
    """What the rules let no signal do says nothing about a robot that stays."""
    system = family([[-1]], [[-1]], switching=left_within((0, 1), transitions=transitions))
    assert odd(system, ("m0",)) == "no switch leads from a mode that must be left"
    assert odd(system) is None


def test_pieces_are_limited(monkeypatch):
    """Of three modes two are left, each in two ways."""
    system = family([[-1]], [[-1]], [[-1]], switching=left_within((1, 2), (1, 2)))
    assert Stays() == Stays((), 1)
    for pieces in (0, -1, 4097):
        assert odd(system, ("m0",), pieces) == PIECES
    assert odd(system, ("m0",), 4096) is None
    for count, fault in ((64, None), (65, PIECES)):
        ways = tuple(("m0", f"m{k}") for k in range(1, count + 1))
        many = family(*[[[-1]]] * 66, switching=left_within((1, 2), transitions=ways))
        assert odd(many, ("m0",), 4096) == fault
    monkeypatch.setattr(module, "MAX_ENCLOSED", 20)
    assert odd(system, ("m0", "m1"), 5) is None
    monkeypatch.setattr(module, "MAX_ENCLOSED", 19)
    assert odd(system, ("m0", "m1"), 5) == PIECES


def test_a_switch_needs_a_fitting_reset():
    system = family([[-1]], [[-1, 0], [0, -1]], switching=Switching(transitions=(("m0", "m1"),)))
    assert odd(system) == "the switch from m0 to m1 has no fitting reset"


@pytest.mark.parametrize(
    ("switching", "count"),
    [
        (Switching(), 6),
        (Switching(transitions=(("m0", "m1"), ("m1", "m2"))), 2),
        (Switching(resets=RESETS), 8),
        (Switching(transitions=(("m0", "m1"),), resets=RESETS), 3),
    ],
)
def test_the_most_switches(monkeypatch, switching, count):
    system = family(*[[[-1, 0], [0, -1]]] * 3, switching=switching)
    for limit, value in (("SWITCHES", count), ("WORK", count * 2**3)):
        with monkeypatch.context() as patch:
            patch.setattr(module, f"MAX_{limit}", value)
            assert odd(system) is None
            patch.setattr(module, f"MAX_{limit}", value - 1)
            assert odd(system) == SWITCHES


@pytest.mark.parametrize(("beyond", "faults"), [(0, (None, None)), (1, (SWITCHES, LONG))])
def test_a_million_switches_and_a_million_bits(beyond, faults):
    rules = Switching(transitions=(("m0", "m1"),) * (2**20 + beyond))
    assert odd(family([[-1]], [[-1]], switching=rules)) == faults[0]
    long = family([[1]], [[1]], **IN_STEPS, switching=Switching(Fraction(4000)))
    assert odd(long, bits=250 + beyond) == faults[1]


@pytest.mark.parametrize(
    ("system", "limit", "value"),
    [
        # The bits of the largest number, once for every step of the longest stay that counts.
        (family([[7]], [[1]], **IN_STEPS, switching=Switching(Fraction(4))), "POWER_BITS", 12),
        (family([[1]], [["1/4"]], **IN_STEPS, switching=Switching(Fraction(4))), "POWER_BITS", 12),
        (family([[7]], [[1]], **IN_STEPS, switching=left_within((1, 4))), "POWER_BITS", 12),
        # The same for products of matrices, and for all stays in modes that are left.
        (family([[7]], [[1]], **IN_STEPS, switching=Switching(Fraction(4))), "WORK", 12),
        (family([[7]], [[1]], **IN_STEPS, switching=left_within((1, 4))), "WORK", 3 * 10),
        (family([[7]], [[1]], [[1]], **IN_STEPS, switching=left_within((2, 4))), "WORK", 3 * 18),
    ],
)
def test_the_largest_powers(monkeypatch, system, limit, value):
    left = dict(system.switching.stays).get("m0", Stay()).longest is not None
    leaving = ("m0",) if left else ()
    monkeypatch.setattr(module, f"MAX_{limit}", value)
    assert odd(system, leaving) is None
    monkeypatch.setattr(module, f"MAX_{limit}", value - 1)
    assert odd(system, leaving) == LONG
    # The rate counts among the numbers of a power; in continuous time none is formed.
    monkeypatch.setattr(module, f"MAX_{limit}", value)
    assert odd(system, leaving, bits=20) == LONG
    assert odd(replace(system, time=Time.CONTINUOUS), leaving, bits=20) is None


@pytest.mark.parametrize("seed", range(40))
def test_what_is_shown_of_a_range_holds_at_every_time_in_it(seed):
    """In forms that are nearly flat, too; and a range in which a mode moves little is shown."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))
    rows = [[Fraction(int(v), 16) for v in row] for row in rng.integers(-40, 20, (n, n))]
    S = rng.normal(size=(n, n)) * 10.0 ** rng.integers(-3, 3, n)
    before = np.round(S.T @ S * 2.0**30).astype(object)
    before = [[int(v) for v in row] for row in (before + before.T) // 2]
    begin, width = Fraction(int(rng.integers(0, 8)), 8), Fraction(1, int(2 ** rng.integers(1, 12)))
    times = np.linspace(float(begin), float(begin + width), 33)
    flows = [expm(np.array(rows, dtype=float) * t) for t in times]
    F = np.array(before, dtype=float)
    # After the stay, the same form in units in which it nearly rises, or does so a little.
    growth = max(np.linalg.eigvals(np.linalg.solve(F, E.T @ F @ E)).real.max() for E in flows)
    for share, may in ((0.5, True), (1.01, False)):
        after = [[int(v * share / growth * 2**40) for v in row] for row in before]
        scaled = [[v * 2**40 for v in row] for row in before]
        modes = (Mode(name, RationalMatrix.from_rows(rows)) for name in "ij")
        step = EnclosedStep("", Edge(*modes, None), begin, begin + width)
        shown = is_positive_definite(step.form(scaled, after, Fraction(0)))
        assert may or not shown
        T = np.linalg.inv(np.linalg.cholesky(F)).T
        moved = np.linalg.norm(np.linalg.inv(T) @ np.array(rows, dtype=float) @ T) * float(width)
        assert shown or not may or moved > 0.5
