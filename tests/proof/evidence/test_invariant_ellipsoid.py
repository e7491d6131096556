"""Bounds on an output: known answers, attacks, and what each condition bars.

The limits of its numbers are rows of test_invariant_ellipsoid.yaml.
"""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.certificates.second_opinion import agrees
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.contact import Contact
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.evidence import InvariantEllipsoid, Shows
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from tests.proof.graphs import common_quadratic
from tests.proof.rows import cases, check
from tests.proof.systems import (
    LAGGING,
    Entry,
    Rows,
    bouncing,
    bouncing_in_steps,
    crowded,
    family,
    matrix,
    pushed,
)
from tests.proof.truth import (
    combine,
    holds,
    inequality,
    is_definite,
    is_in_other_units,
    is_positive_multiple,
    moves,
)


def pushing(Q, log2, share, level, *multipliers):
    numbers = (Fraction(share),), Fraction(level), multipliers
    return InvariantEllipsoid(("push",), "force", Q, log2, *numbers)


# By hand, for pushes of 1/4: V = 13 v^2 + 10 v delta + 14 delta^2, about.
BOUNCE = pushing(((55, 22), (22, 56)), 2, "1/2", "3/5")
STEPS = pushing(((3059, 1375), (1375, 3495)), 8, "0.0457", "0.61", 2598)
PULLED = replace(BOUNCE, Q=((60, 17), (17, 55)), shares=(Fraction(1, 3),), multipliers=(80, 80))
GENUINE = (
    (pushed(bouncing()), BOUNCE),
    (pushed(bouncing(1)), PULLED),
    (pushed(replace(bouncing(), contact=None)), BOUNCE),
    (pushed(bouncing_in_steps()), STEPS),
)


@pytest.mark.parametrize("case", cases(__file__))
def test_what_a_row_says(case):
    check(case)


@pytest.mark.parametrize(("system", "evidence"), GENUINE)
def test_a_pushed_mass_is_bounded(system, evidence):
    assert agrees(system, evidence)
    assert evidence.shows is Shows.BOUND
    assert evidence.proved_rate(system) is None
    claim = evidence.claim(system)
    assert claim.startswith("While |push| <= 0.25 N and nothing else disturbs")
    assert ("contact lost and made again" in claim) == (system.contact is not None)
    assert ("|force| at a step never" in claim) == (system.time is Time.DISCRETE)
    assert claim.endswith("The limit of 1 N is kept.")


def scalar(A: Entry, B: Entry, bound: Entry = 1, time: Time = Time.CONTINUOUS) -> SwitchedSystem:
    return replace(
        family([[A]], time=time),
        channels=(Channel("d", "", Fraction(bound), (matrix([[B]]),)),),
        outputs=(Output("z", "", (matrix([[1]]),)),),
    )


def of_scalar(Q: int, share: Entry, level: Entry, denominator_log2: int = 0) -> InvariantEllipsoid:
    return InvariantEllipsoid(
        ("d",), "z", ((Q,),), denominator_log2, (Fraction(share),), Fraction(level), ()
    )


@pytest.mark.parametrize(
    ("system", "share"),
    [
        # x' = -x + 2 d, |d| <= 3: from rest, |x| comes as near to 6 as it likes.
        (scalar(-1, 2, 3), 1),
        # x+ = x/2 + 3 d, |d| <= 1: as near to 6.
        (scalar("1/2", 3, 1, Time.DISCRETE), "1/2"),
    ],
)
def test_the_exact_bound_of_one_state(system, share):
    """V = x^2/36 and the least level are the border: what is a little looser is proved."""
    scale = 2**40

    def candidate(reach: Fraction, level: Fraction) -> InvariantEllipsoid:
        return of_scalar(int(scale / reach**2), share, level, 40)

    little = Fraction(1, 10**6)
    loose = candidate(6 + little, 6 + 2 * little)
    assert loose.find_fault(system) is None
    assert "can be left" in candidate(6 - little, Fraction(7)).find_fault(system)
    assert "beyond the level" in replace(loose, level=Fraction(6)).find_fault(system)
    assert "can be left" in replace(loose, shares=(Fraction(9, 10) * loose.shares[0],)).find_fault(
        system
    )


def test_the_bound_in_numbers():
    """Its output and disturbance are those of the system, by name."""
    system = pushed(bouncing())
    bound = BOUNCE.bound(system)
    assert bound.output == system.outputs[0]
    assert bound.channels == system.channels
    assert (bound.level, bound.share) == (BOUNCE.level, sum(BOUNCE.shares))
    others = (replace(system.outputs[0], name="other"), *system.outputs)
    assert BOUNCE.bound(replace(system, outputs=others)) == bound


def test_a_function_that_decreases_bounds_no_output():
    assert common_quadratic(((1,),), 0, Fraction(1)).bound(family([[-2]])) is None


# Families that leave the set, with evidence that keeps all conditions but one. The disturbance
# pushes the deflection too.
def moved(
    contact: Rows, free: Rows, B: Rows, B_free: Rows, time: Time, *pulls: Rows
) -> SwitchedSystem:
    rows = tuple(matrix(q) for q in pulls)
    return replace(
        family(contact, time=time),
        contact=Contact((Mode("f", matrix(free)),), rows),
        channels=(Channel("push", "N", Fraction(1), (matrix(B), matrix(B_free))),),
        outputs=(Output("force", "N", (matrix([[0, 1]]),)),),
    )


HALF, SMALL = [["1/2", 0], [0, "1/2"]], [["1/10"], ["1/10"]]
CALM = [["1/2", 0], [0, 1]]
ROUND = ((16, 0), (0, 16))
ESCAPES: dict[str, tuple[SwitchedSystem, Rows]] = {
    # delta+ = delta/2 + 9/10 d: it goes to 9/5.
    "in mode m0": (moved(HALF, CALM, [[0], ["9/10"]], [[0], ["1/8"]], Time.DISCRETE), ROUND),
    # Found by a random search; all other conditions hold.
    "in free motion, mode f": (
        moved(
            [[0, "-2/8"], ["-2/8", 0]],
            [["5/8", 0], ["-2/8", 1]],
            [["3/8"], ["-5/8"]],
            [["-3/8"], ["7/8"]],
            Time.DISCRETE,
        ),
        ((26, 14), (14, 12)),
    ),
    # From the surface, the disturbance throws it into depth 3/2.
    "where contact is made, mode f": (
        moved(HALF, CALM, SMALL, [[0], ["3/2"]], Time.DISCRETE),
        ROUND,
    ),
    "where contact is lost in mode m0": (
        moved(
            [["-5/8", "-4/8"], [1, "7/8"]],
            [["2/8", 0], ["-6/8", 1]],
            [["5/8"], ["-6/8"]],
            [["-2/8"], ["1/8"]],
            Time.DISCRETE,
        ),
        ((30, 24), (24, 20)),
    ),
}

SHARES = {"in free motion, mode f": "11/16"}


@pytest.mark.parametrize("where", ESCAPES)
def test_each_condition_in_steps_bars_a_set_that_is_left(where):
    system, Q = ESCAPES[where]
    faults = set()
    for multiplier in (0, 1, 2, 4, 8, 16, 32, 64):
        candidate = pushing(Q, 4, SHARES.get(where, "1/2"), 10, multiplier)
        broken = {
            failure.removeprefix("the ellipsoid can be left ")
            for failure, form in candidate.forms(system)
            if not is_definite(form)
        }
        assert where in broken
        assert candidate.find_fault(system) is not None
        faults.add(frozenset(broken))
    # With some multiplier nothing else is broken.
    assert min(map(len, faults)) == 1
    assert _largest(system, Q) > 16


def _largest(system: SwitchedSystem, Q: Rows) -> Fraction:
    """Return the largest 16 V from rest, of all runs of six steps with the largest disturbance."""
    best, states = Fraction(0), [[Fraction(0), Fraction(0)]]
    for _ in range(6):
        states = [_moved(system, x, d) for x in states for d in (-1, 0, 1)]
        for y, delta in states:
            w = (y, max(delta, Fraction(0)))
            best = max(best, sum(w[i] * Q[i][j] * w[j] for i in (0, 1) for j in (0, 1)))
    return best


def _moved(system: SwitchedSystem, x: list[Fraction], d: int) -> list[Fraction]:
    touches = x[-1] > 0
    mode = system.modes[0] if touches else system.contact.free[0]
    B = system.channels[0].columns[0 if touches else 1].fractions()
    rows = zip(mode.A.fractions(), B, strict=True)
    return [sum(a * b for a, b in zip(row, x, strict=True)) + d * b[0] for row, b in rows]


def test_each_condition_in_continuous_time_bars_a_set_that_is_left():
    """Where the condition fails, V rises on the border V = 1 for a disturbance of its bound."""
    contact, B = [[-2, 0], [0, -2]], [["1/2"], ["1/2"]]
    calm = [[-2, 0], [1, 0]]
    flying = moved(contact, calm, B, [[4], [0]], Time.CONTINUOUS)
    lagging = moved(contact, [[-2, 0], [8, 0]], B, B, Time.CONTINUOUS, [[-9, 1]])
    candidate = pushing(ROUND, 4, 1, 2)
    good = moved(contact, calm, B, B, Time.CONTINUOUS)
    assert candidate.find_fault(good) is None
    assert candidate.find_fault(flying).endswith("in free motion, mode f")
    # At y = 1 in the air, V' = 2 y (-2 y + 4 d) = 4.
    for multiplier in (0, 1, 16, 64, 256):
        fault = replace(candidate, multipliers=(multiplier,)).find_fault(lagging)
        assert fault.endswith("while the environment lags, mode f")
    # At (y, delta) = (3/5, 4/5) the force -9 y + delta is negative, and V' = 2 x'(F x + B d).
    y, delta = Fraction(3, 5), Fraction(4, 5)
    assert -9 * y + delta < 0 < 2 * y * (-2 * y + Fraction(1, 2)) + 2 * delta * (8 * y)


def test_multipliers_for_an_environment_that_could_pull_decide_in_steps():
    system = pushed(bouncing_in_steps())
    pulled = replace(system, contact=replace(system.contact, pulls=(matrix([[1, 1]]),)))
    covered = replace(STEPS, multipliers=(*STEPS.multipliers, 500, 500, 500))
    assert (covered.find_fault(pulled) is None) == holds(pulled, covered)


@pytest.mark.parametrize("where", LAGGING)
def test_what_lags_in_steps_can_leave_the_set(where):
    """A state that no disturbance has to push: V rises in one step by more than a twentieth."""
    system, Q, multipliers = LAGGING[where]
    columns = (matrix([["1/100"], [0]]),) * 2
    system = replace(
        system,
        channels=(Channel("push", "N", Fraction(1, 1000), columns),),
        outputs=(Output("force", "N", (matrix([[0, 1]]),)),),
    )
    ellipsoid = pushing(Q, 0, "1/50", 10, *multipliers)
    fault = ellipsoid.find_fault(system)
    assert fault == f"the ellipsoid can be left {where}"
    assert not holds(system, ellipsoid)
    sprung = replace(system, contact=replace(system.contact, pulls=()))
    assert replace(ellipsoid, multipliers=multipliers[:1]).find_fault(sprung) is None


@settings(deadline=None)
@given(
    st.lists(st.integers(-8, 8), min_size=4, max_size=4),
    st.lists(st.integers(-8, 8), min_size=2, max_size=2),
    st.lists(st.integers(-4, 4), min_size=4, max_size=4),
    st.lists(st.integers(-6, 6), min_size=3, max_size=3),
    st.integers(0, 6),
    st.fractions("1/10", 2),
    st.fractions("1/2", 4),
    st.sampled_from(list(Time)),
)
def test_against_the_definition(contact, free, columns, Q, multiplier, share, level, time):
    """The definition in fractions, decided by another elimination."""
    a, b, c, d = (Fraction(entry, 8) for entry in contact)
    moves = Fraction(int(time is Time.DISCRETE))
    B, B_free = ([[Fraction(columns[k], 8)], [Fraction(columns[k + 1], 8)]] for k in (0, 2))
    pulls = ([[1, 2]],) if time is Time.CONTINUOUS else ()
    flight = [[Fraction(free[0], 8), 0], [Fraction(free[1], 8), moves]]
    system = moved([[a, b], [c, d]], flight, B, B_free, time, *pulls)
    p, q, r = Q
    candidate = pushing(((p, q), (q, r)), 1, share, level, multiplier)
    assert (candidate.find_fault(system) is None) == holds(system, candidate)


# Of three states, with denominators that differ, and nothing symmetric but Q.
Q3 = ((9, 2, -1), (2, 7, 3), (-1, 3, 8))
SHARES3, LEVEL = (Fraction(2, 7), Fraction(1, 5)), Fraction(4, 9)
# One of three disturbances is not named, and the others are in another order.
EVIDENCE3 = InvariantEllipsoid(("jerk", "push"), "force", Q3, 3, SHARES3, LEVEL, ())
WEIGHTS3 = [SHARES3[0] / Fraction(5, 2) ** 2, SHARES3[1] * 9]


FACTS3 = ("pull 1 f0", "pull 2 f0", "pull 1 f1", "pull 2 f1")


@pytest.mark.parametrize(
    ("time", "facts", "multipliers", "roundings"),
    [
        (Time.CONTINUOUS, (), (), ()),
        (Time.CONTINUOUS, FACTS3, (3, 5, 7, 11), ()),
        *(
            (Time.DISCRETE, ("lost",) * len(multipliers), multipliers, roundings)
            for multipliers in ((), (5,))
            for roundings in ((), (4, 9))
        ),
    ],
)
def test_every_form_by_hand(time, facts, multipliers, roundings):
    """In kept contact, and while contact comes and goes and the environment lags."""
    flows = time is Time.CONTINUOUS
    system = crowded(time, lost=bool(multipliers), pulled=flows)
    evidence = replace(EVIDENCE3, multipliers=multipliers, roundings=roundings)
    assert find_contradiction(system) is None
    assert evidence.find_misfit(system) is None
    eighths = combine((Fraction(1, 8), Q3))
    known = {fact: Fraction(m, 8) for fact, m in zip(facts, multipliers, strict=True)}
    known |= {f"rounding {k}": Fraction(m, 8) for k, m in enumerate(roundings, 1)}
    keeps = sum(SHARES3) if flows else 1 - sum(SHARES3)
    wanted = [
        (move.where, inequality(move, eighths, eighths, keeps, known.__getitem__, WEIGHTS3))
        for move in moves(system, lost=True, channels=(2, 0), rounding=bool(roundings))
        if move.strict and "surface" not in move.where
    ]
    for output in system.outputs[1].rows:
        (row,) = output.fractions()
        rows = [[*above, x] for above, x in zip(eighths, row, strict=True)]
        wanted.append(("", [*rows, [*row, LEVEL**2]]))
    (_, first), *forms = evidence.forms(system)
    assert first == Q3
    for (words, form), (where, true) in zip(forms, wanted, strict=True):
        assert words.endswith(where)
        assert (is_positive_multiple if flows else is_in_other_units)(form, true)


def test_a_disturbance_is_read_by_its_name():
    system, fields = pushed(bouncing()), BOUNCE.to_fields()
    assert InvariantEllipsoid.from_fields(fields, system) == BOUNCE
    with pytest.raises(ValueError, match="no disturbance of that name"):
        InvariantEllipsoid.from_fields({**fields, "channels": ["wind"]}, system)
    # Its forms are those of its own, whatever else disturbs.
    gust = replace(system.channels[0], name="gust", bound=Fraction(9))
    for channels in ((gust, *system.channels), (*system.channels, gust)):
        both = replace(system, channels=channels)
        assert list(BOUNCE.forms(both)) == list(BOUNCE.forms(system))


def test_rounding_is_covered_where_there_are_multipliers_for_it():
    assert not STEPS.covers_rounding
    assert replace(STEPS, roundings=(1,)).covers_rounding
    covered = replace(STEPS, roundings=(1,))
    assert type(covered).from_fields(covered.to_fields(), pushed(bouncing_in_steps())) == covered
