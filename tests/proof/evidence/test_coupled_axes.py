"""One function for all axes: known answers, attacks, what each condition bars."""

from dataclasses import replace
from fractions import Fraction
from math import exp
from random import Random

import numpy as np
import pytest

from nrs_design.proof.channels import Coupling, Rounding
from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import CommonQuadratic, ConewiseQuadratic, CoupledAxes, Shows
from nrs_design.proof.evidence.abstract import ROUNDED
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.switching import Reset, Switching
from nrs_design.proof.system import SwitchedSystem
from tests.proof.systems import bouncing, family, genuine, leaning, matrix
from tests.proof.truth import decrease, holds, is_positive_multiple
from tests.support import broken

ALL = ("coupled-axes", "coupled-axes, kept", "coupled-axes, pulling")


def coupled(system: SwitchedSystem, *parts: tuple) -> SwitchedSystem:
    """Couple a system by columns and rows for every mode."""
    couplings = (
        Coupling(f"c{i}", *(tuple(map(matrix, part)) for part in columns_and_rows))
        for i, columns_and_rows in enumerate(parts)
    )
    return replace(system, couplings=tuple(couplings))


def scalar(size: str) -> SwitchedSystem:
    """``x' = -x + w`` with ``|w| <= c |x|`` over all axes: decays iff c < 1, at the rate 1 - c."""
    return coupled(family([[-1]]), ([[[1]]], [[[size]]]))


@pytest.mark.parametrize("example", ALL)
def test_axes_that_lean_on_each_other_are_proved(example):
    system, evidence = genuine(example)
    assert evidence.find_fault(system) is None
    assert agrees(system, evidence)
    assert holds(system, evidence)
    assert evidence.shows is Shows.STABILITY
    claim = evidence.claim(system)
    assert "For any number of axes that act on each other within the stated bounds" in claim
    assert ("contact lost and made again at any time" in claim) == (system.contact is not None)
    assert ("Where free motion ends is not claimed" in claim) == (system.contact is not None)
    assert "contact is kept" not in claim
    assert "in any of 2 modes" in claim
    assert ("and 1 mode of free motion" in claim) == (system.contact is not None)


@pytest.mark.parametrize(("size", "rate", "tau"), [("1/2", "1/4", 3), ("9/10", "1/20", 1)])
def test_a_scalar_is_proved_up_to_its_rate(size, rate, tau):
    """By hand: ``2 (1 - alpha) tau - c^2 tau^2 - 1 > 0`` for some tau iff ``1 - alpha > c``."""
    system = scalar(size)
    assert CoupledAxes(((1,),), 0, Fraction(rate), (tau,)).find_fault(system) is None
    border = 1 - Fraction(size)
    for numerator in range(1, 200):
        item = CoupledAxes(((16,),), 4, border, (numerator,))
        assert "in mode m0" in item.find_fault(system)


def test_the_form_by_hand():
    """A in thirds, q in fifths, B in sevenths, Q and tau in quarters."""
    system = coupled(
        family([["-4/3", "1/3"], [0, -1]]), ([[["1/7"], ["2/7"]]], [[["1/5", "-2/5"]]])
    )
    item = CoupledAxes(((8, 1), (1, 4)), 2, Fraction(1, 2), (3,))
    _, (_, form) = item.forms(system)
    # -(A'Q + QA + Q) - tau q'q, -QB and tau, with Q = [[2, 1/4], [1/4, 1]] and tau = 3/4.
    F = Fraction
    upper = [F(16, 3) - 2 - F(3, 100), F(-2, 3) + F(1, 3) + F(1, 4) - F(1, 4) + F(6, 100)]
    lower = F(-1, 6) + 2 - 1 - F(12, 100)
    side = [-F(2, 7) - F(1, 14), -F(1, 28) - F(2, 7)]
    wanted = [[upper[0], upper[1], side[0]], [upper[1], lower, side[1]], [*side, F(3, 4)]]
    assert is_positive_multiple(form, wanted)


def test_one_tau_for_every_mode():
    """Each mode has a tau of its own, and two axes that take turns in the modes grow.

    One axis is pushed tenfold by a twentieth of its state, the other by a twentieth of tenfold:
    ``x1' = -x1 + 10 w1`` with w1 all of ``10 x2``, then the other way round.
    """
    pair = coupled(family([[-1]], [[-1]]), ([[[10]], [["1/20"]]], [[["1/20"]], [[10]]]))
    first, second = (
        replace(
            pair,
            modes=(pair.modes[k],),
            couplings=(Coupling("c", c.columns[k : k + 1], c.rows[k : k + 1]),),
        )
        for k, c in enumerate(pair.couplings * 2)
    )
    rate, unit = Fraction(1, 4), 1024
    assert CoupledAxes(((unit,),), 10, rate, (200 * unit,)).find_fault(first) is None
    assert CoupledAxes(((unit,),), 10, rate, (unit // 128,)).find_fault(second) is None
    for power in range(24):
        assert CoupledAxes(((unit,),), 10, rate, (1 << power,)).find_fault(pair) is not None
    time = 0.1
    turn = exp(-time) * np.array([[1.0, 10 * 10 * time], [0.0, 1.0]])
    assert np.abs(np.linalg.eigvals(turn @ turn.T)).max() > 80


# Q of the bouncing mass, and couplings of contact and of free motion; the mass speeds up to 2 1/s
# in contact, or in flight, or V rises while the environment lags.
BARRED = {
    "in mode m0": (0, 4, 0),
    "in free motion, mode free": (0, 0, 4),
    "while the environment lags, mode free": (1, 0, "7/4"),
}


@pytest.mark.parametrize("where", BARRED)
def test_each_condition_bars_what_is_false(where):
    damping, touching, flying = BARRED[where]
    system = bouncing(damping)
    system = replace(system, modes=system.modes[:1])
    free = Mode("free", matrix([[-2, 0], [1, 0]]))
    system = replace(system, contact=replace(system.contact, free=(free,)))
    pulls = system.contact.pulls
    column = [[1], [0]]
    system = coupled(system, ([column] * 2, [[[touching, 0]], [[flying, 0]]]))
    unit, found = 64, set()
    for tau in range(1, 1024, 8):
        for multiplier in (0, 1, 4, 16, 64, 256) if pulls else (0,):
            item = CoupledAxes(
                ((4 * unit, 2 * unit), (2 * unit, 6 * unit)),
                6,
                Fraction(1, 100),
                (tau,),
                (multiplier,) * len(pulls),
            )
            places = broken(system, item)
            assert where in places
            found.add(frozenset(places))
    # With some multipliers nothing else is broken.
    assert frozenset({where}) in found
    assert rises(where, touching, flying)


def rises(where: str, touching: int, flying: int | str) -> bool:
    """Tell whether an axis by itself grows, with all that the bound allows against it."""
    if where == "in mode m0":
        # [[-2 + q, -1], [1, 0]] has no eigenvalue on the left, and no spiral: it stays in contact.
        return touching - 2 > 0 and (touching - 2) ** 2 >= 4
    if where == "in free motion, mode free":
        return -2 + flying > 0
    # V = 4 v^2 + 4 v delta + 6 delta^2 just below the surface, on the way out without force.
    v, delta, w = Fraction(-1), Fraction(1, 1000), -Fraction(flying)
    assert v + delta < 0
    return (8 * v + 4 * delta) * (-2 * v + w) + (4 * v + 12 * delta) * v > 0


@pytest.mark.parametrize("example", ALL)
@pytest.mark.parametrize("seed", range(20))
def test_no_motion_of_three_axes_within_the_bounds_raises_the_function(example, seed):
    """At random states, each axis in a mode of its own, with all that the bounds allow."""
    system, item = genuine(example)
    scale = Fraction(1, 2**item.denominator_log2)
    Q = [[scale * entry for entry in row] for row in item.Q]
    value = rise = Fraction(0)
    for x, moves, kept in pushed_axes(system, Random(seed)):
        w, moved = x[:kept], moves[:kept]
        forces = [dot(row[:kept], w) for row in Q[:kept]]
        value += dot(forces, w)
        rise += 2 * dot(forces, moved)
    assert rise <= -2 * item.rate * value


def pushed_axes(system: SwitchedSystem, random: Random):
    """Yield of three axes the state, what becomes of it under random pushes, and what V sees."""
    axes = [situation(system, random) for _ in range(3)]
    sizes = [
        sum(dot(part.rows[k].fractions()[0], x) ** 2 for k, _, x, _ in axes)
        for part in system.couplings
    ]
    pushes = [share(size, random) for size in sizes]
    for i, (k, A, x, kept) in enumerate(axes):
        moves = [dot(row, x) for row in A]
        for part, push in zip(system.couplings, pushes, strict=True):
            column = part.columns[k].fractions()
            moves = [a + push[i] * b for a, (b,) in zip(moves, column, strict=True)]
        yield x, moves, kept


def situation(system: SwitchedSystem, random: Random):
    """Return a mode, its matrix, a state that it can be in, and how many entries V has of it."""
    n, contact = system.order, system.contact
    x = [Fraction(random.randint(-9, 9)) for _ in range(n)]
    modes, free = system.modes, () if contact is None else contact.free
    k = random.randrange(len(modes) + len(free))
    if k < len(modes):
        x[-1] = abs(x[-1]) if free else x[-1]
        return k, modes[k].A.fractions(), x, n
    pulls = contact.pulls
    A = free[k - len(modes)].A.fractions()
    if pulls and random.random() < 0.5:
        x[-1] = abs(x[-1])
        if dot(random.choice(pulls).fractions()[0], x) <= 0:
            return k, A, x, n
    return k, A, [*x[:-1], -abs(x[-1])], n - 1


def share(square: Fraction, random: Random) -> list[Fraction]:
    """Return three numbers of which the squares add up to just below a square."""
    direction = [random.gauss(0, 1) for _ in range(3)]
    length = sum(entry**2 for entry in direction) ** 0.5
    size = float(square) ** 0.5 * (1 - 1e-9)
    return [Fraction(size * entry / length) for entry in direction]


def dot(left, right):
    return sum((a * b for a, b in zip(left, right, strict=True)), Fraction(0))


def test_other_functions_do_not_cover_what_axes_do():
    system = leaning(bouncing(), "1/8")
    alone = (
        ConewiseQuadratic(((4, 2), (2, 6)), 0, Fraction(1, 5), ()),
        CommonQuadratic(((4, 2), (2, 6)), 0, Fraction(1, 5)),
    )
    for item in alone:
        assert item.find_fault(bouncing()) is None
        assert "does not cover what axes do to each other" in item.find_fault(system)


def test_a_refutation_is_that_of_one_axis():
    system, evidence = genuine("growing-sequence, mode")
    among = coupled(system, ([[[1], [0]]], [[[1, 0]]]))
    assert evidence.find_fault(among) is None
    assert evidence.claim(among).endswith("which is within what is said of them.")
    assert "on which the others do not act" not in evidence.claim(system)


def test_that_no_common_function_exists_is_said_of_matrices():
    system, evidence = genuine("no-common-quadratic")
    among = coupled(system, ([[[1], [0]]] * 2, [[[1, 0]]] * 2))
    assert evidence.find_fault(among) is None
    assert evidence.claim(among) == evidence.claim(system)


SYSTEM, GENUINE = genuine("coupled-axes, pulling")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"taus": ()}, "one multiplier for each coupling"),
        ({"taus": (*GENUINE.taus, 1)}, "one multiplier for each coupling"),
        ({"taus": (-GENUINE.taus[0],)}, "does not decrease"),
        ({"taus": (0,)}, "does not decrease"),
        ({"multipliers": ()}, "for each condition that needs it"),
        ({"multipliers": (-1,) * len(GENUINE.multipliers)}, "is negative"),
        ({"Q": ((1,),)}, "not a 2 x 2 matrix"),
        ({"Q": ((4, 1), (2, 6))}, "not symmetric"),
        ({"Q": tuple(tuple(-e for e in row) for row in GENUINE.Q)}, "not symmetric and positive"),
        ({"rate": Fraction(0)}, "not one of exponential decay"),
        ({"rate": Fraction(5)}, "does not decrease"),
    ],
)
def test_numbers_that_do_not_fit_are_refused(changes, words):
    assert words in replace(GENUINE, **changes).find_fault(SYSTEM)


def test_no_force_has_to_be_used():
    idle = replace(GENUINE, multipliers=(0,) * len(GENUINE.multipliers))
    assert idle.find_misfit(SYSTEM) is None


def test_every_form_in_fractions():
    """Three states, two couplings, two forces, and no two denominators alike."""
    contact = [["-4/3", "1/3", "-1/2"], [0, "-6/5", 1], [1, "1/7", "-1/9"]]
    free = [["-4/3", "1/5", 0], ["1/4", -1, 0], [1, "1/7", 0]]
    pulls = (matrix([["1/2", "1/3", "3/5"]]), matrix([["1/11", 0, "1/4"]]))
    B = [[["1/7"], ["2/3"], ["1/5"]], [[1], ["1/2"], ["1/3"]]]
    q = [[["1/5", "-2/5", "1/6"]], [["1/9", "1/2", 0]]]
    system = coupled(
        replace(family(contact), contact=Contact((Mode("f", matrix(free)),), pulls)),
        (B, q),
        (B[::-1], [[["1/3", 0, 2]], q[1]]),
    )
    item = CoupledAxes(((8, 1, 2), (1, 4, 0), (2, 0, 5)), 2, Fraction(2, 3), (3, 5), (7, 6))
    Q, taus = [[Fraction(e, 4) for e in row] for row in item.Q], (Fraction(3, 4), Fraction(5, 4))
    wanted = [
        Q,
        bordered(system, item.rate, Q, taus, 0, 3),
        bordered(system, item.rate, Q, taus, 1, 2),
    ]
    for f, weight in zip(pulls, (Fraction(7, 4), Fraction(6, 4)), strict=True):
        lagging = bordered(system, item.rate, Q, taus, 1, 3)
        for j, entry in enumerate(f.fractions()[0]):
            lagging[2][j] += weight * entry
            lagging[j][2] += weight * entry
        wanted.append(lagging)
    assert item.find_misfit(system) is None
    for (_, form), expected in zip(item.forms(system), wanted, strict=True):
        assert is_positive_multiple(form, expected)


def bordered(system, rate, Q, taus, k, kept):
    """Return the form of a motion as the class states it, on so many of the states."""
    modes = (*system.modes, *system.contact.free)
    A, Q = ([row[:kept] for row in M[:kept]] for M in (modes[k].A.fractions(), Q))
    q = [part.rows[k].fractions()[0][:kept] for part in system.couplings]
    B = [[b for (b,) in part.columns[k].fractions()[:kept]] for part in system.couplings]
    form = decrease(A, Q, rate, Time.CONTINUOUS)
    for i in range(kept):
        for j in range(kept):
            form[i][j] -= sum(t * row[i] * row[j] for t, row in zip(taus, q, strict=True))
    sides = [[-dot(row, column) for row in Q] for column in B]
    rows = [[*row, *(side[i] for side in sides)] for i, row in enumerate(form)]
    corner = [[t * (i == j) for j in range(len(taus))] for i, t in enumerate(taus)]
    return [*rows, *([*side, *row] for side, row in zip(sides, corner, strict=True))]


def test_a_larger_bound_is_refused():
    part = SYSTEM.couplings[0]
    for k in range(len(part.rows)):
        larger = matrix([[100 * entry for entry in part.rows[k].fractions()[0]]])
        rows = (*part.rows[:k], larger, *part.rows[k + 1 :])
        assert GENUINE.find_fault(replace(SYSTEM, couplings=(replace(part, rows=rows),)))


def test_a_system_without_couplings_is_none_of_its():
    assert "does not say what axes do" in GENUINE.find_fault(replace(SYSTEM, couplings=()))


def test_resets_are_not_covered():
    resets = (Reset("m0", "m1", matrix([[9, 0], [0, 9]])),)
    assert "kind of switching" in GENUINE.find_fault(
        replace(SYSTEM, switching=Switching(resets=resets))
    )


IN_STEPS = ("coupled-axes, steps", "coupled-axes, kept in steps", "coupled-axes, pulling in steps")


@pytest.mark.parametrize("example", IN_STEPS)
def test_axes_that_lean_on_each_other_in_steps_are_proved(example):
    system, evidence = genuine(example)
    assert evidence.find_fault(system) is None
    assert agrees(system, evidence)
    assert holds(system, evidence)
    assert "|w(t)| <= rho^t |w(0)|" in evidence.claim(system)
    assert type(evidence).from_fields(evidence.to_fields(), system) == evidence


def scalar_in_steps(size: str) -> SwitchedSystem:
    """``x+ = x/2 + w`` with ``|w| <= c |x|`` over all axes: decays iff c < 1/2, at 1/2 + c."""
    return coupled(family([["1/2"]], time=Time.DISCRETE), ([[[1]]], [[[size]]]))


def test_a_scalar_in_steps_is_proved_up_to_its_rate():
    system = scalar_in_steps("1/4")
    assert CoupledAxes(((1,),), 0, Fraction("0.7501"), (3,)).find_fault(system) is None
    for numerator in range(1, 200):
        item = CoupledAxes(((16,),), 4, Fraction("0.7499"), (numerator,))
        assert "in mode m0" in item.find_fault(system)
        border = CoupledAxes(((16,),), 4, Fraction("0.9999"), (numerator,))
        assert border.find_fault(scalar_in_steps("1/2")) is not None


def test_one_tau_for_every_mode_in_steps():
    """As in continuous time: each mode has a tau of its own, and two axes that take turns grow."""
    A = [["1/2"]]
    modes = family(A, A, time=Time.DISCRETE)
    pair = coupled(modes, ([[[2]], [["1/100"]]], [[["1/100"]], [[2]]]))
    (c,) = pair.couplings
    unit = 1024
    for k, tau in enumerate((40 * unit, unit // 200)):
        part = replace(c, columns=c.columns[k : k + 1], rows=c.rows[k : k + 1])
        single = replace(pair, modes=pair.modes[k : k + 1], couplings=(part,))
        item = CoupledAxes(((unit,),), 10, Fraction(9, 10), (tau,))
        assert item.find_fault(single) is None
    for power in range(24):
        item = CoupledAxes(((unit,),), 10, Fraction(99, 100), (1 << power,))
        assert item.find_fault(pair) is not None
    # One axis is pushed twofold by twice the state of the other, then the other way round.
    turn = np.array([[0.5, 4.0], [0.0, 0.5]])
    assert np.abs(np.linalg.eigvals(turn @ turn.T)).max() > 16


@pytest.mark.parametrize("motion", range(3))
@pytest.mark.parametrize("column", [[[1], [0]], [[0], [1]]])
def test_a_wild_push_in_any_motion_is_refused(motion, column):
    """In either mode, and in free motion; on the speed, or on the way by which contact is lost."""
    system, item = genuine("coupled-axes, steps")
    first = system.couplings[0]
    rows, columns = list(first.rows), list(first.columns)
    rows[motion], columns[motion] = matrix([[4, 0]]), matrix(column)
    part = replace(first, rows=tuple(rows), columns=tuple(columns))
    pushed = replace(system, couplings=(part, *system.couplings[1:]))
    for tau in (0, 1, 100, 10**4, 10**6, 10**8, item.taus[0]):
        assert replace(item, taus=(tau, *item.taus[1:])).find_fault(pushed) is not None


@pytest.mark.parametrize("example", ["coupled-axes, steps", "coupled-axes, pulling in steps"])
@pytest.mark.parametrize("seed", range(20))
def test_no_step_of_three_axes_within_the_bounds_raises_the_function(example, seed):
    system, item = genuine(example)
    scale = Fraction(1, 2**item.denominator_log2)
    Q = [[scale * entry for entry in row] for row in item.Q]
    before = after = Fraction(0)
    for x, moved, _ in pushed_axes(system, Random(seed)):
        before, after = before + value(Q, x), after + value(Q, moved)
    assert after <= item.rate**2 * before


def value(Q, x):
    w = [*x[:-1], max(x[-1], Fraction(0))]
    return dot(w, [dot(row, w) for row in Q])


def test_what_is_rounded_pushes_the_other_axes():
    """``x+ = x/2 + r + w``, |r| <= |x|/8 and |w| <= |x + 2 r|/8: 25/32 a step, without 2 r 3/4."""
    system = replace(
        family([["1/2"]], time=Time.DISCRETE),
        roundings=(Rounding("a", (matrix([[1]]),), (matrix([["1/8"]]),)),),
        couplings=(Coupling("c", (matrix([[1]]),), (matrix([["1/8", "1/4"]]),)),),
    )
    blind = replace(system, couplings=(Coupling("c", (matrix([[1]]),), (matrix([["1/8", 0]]),)),))

    def some(rate: str, target: SwitchedSystem) -> bool:
        return any(
            CoupledAxes(((8,),), 3, Fraction(rate), (tau,), (), (rho,)).find_fault(target) is None
            for tau in range(1, 120, 2)
            for rho in range(1, 120, 2)
        )

    assert some("0.79", system)
    assert some("0.76", blind)
    assert not some("0.78", system)
    exact = CoupledAxes(((8,),), 3, Fraction("0.63"), (40,))
    assert exact.find_fault(system) is None
    assert "computed without rounding" in exact.claim(system)
    assert not exact.covers_rounding
    covered = CoupledAxes(((8,),), 3, Fraction("0.8"), (40,), (), (63,))
    assert covered.find_fault(system) is None
    assert covered.covers_rounding
    assert covered.claim(system).endswith(ROUNDED)
    twice = replace(covered, roundings=(63, 63))
    assert twice.find_fault(system) == "there is not one multiplier for each rounding"
    less = replace(covered, roundings=(-63,))
    assert less.find_fault(system) == "the multiplier of a rounding is negative"
