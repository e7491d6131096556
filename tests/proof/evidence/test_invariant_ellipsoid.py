"""Bounds on an output: known answers, attacks, and what each condition bars."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.proof.evidence import InvariantEllipsoid, Shows
from nrs_design.proof.evidence.fields import MAX_INTEGER_BITS
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.system import (
    Channel,
    Contact,
    Mode,
    Output,
    SwitchedSystem,
    Time,
)
from tests.proof.systems import Entry, Rows, bouncing, bouncing_in_steps, family, matrix, pushed
from tests.proof.truth import holds
from tests.support import is_definite_by_ldl

# By hand, for pushes of 1/4: V = 13 v^2 + 10 v delta + 14 delta^2, about.
BOUNCE = InvariantEllipsoid(
    ("push",), "force", ((55, 22), (22, 56)), 2, (Fraction(1, 2),), Fraction(3, 5), ()
)
STEPS = InvariantEllipsoid(
    ("push",),
    "force",
    ((3059, 1375), (1375, 3495)),
    8,
    (Fraction(457, 10_000),),
    Fraction(61, 100),
    (2598,),
)
PULLED = replace(BOUNCE, Q=((60, 17), (17, 55)), shares=(Fraction(1, 3),), multipliers=(80, 80))
KEPT = replace(bouncing(), contact=None)
GENUINE = (
    (pushed(bouncing()), BOUNCE),
    (pushed(bouncing(1)), PULLED),
    (pushed(KEPT), BOUNCE),
    (pushed(bouncing_in_steps()), STEPS),
)


@pytest.mark.parametrize(("system", "evidence"), GENUINE)
def test_a_pushed_mass_is_bounded(system, evidence):
    assert evidence.find_fault(system) is None
    assert agrees(system, evidence)
    assert holds(system, evidence)
    assert evidence.shows is Shows.BOUND
    assert evidence.proved_rate(system) is None
    claim = evidence.claim(system)
    assert claim.startswith("While |push| <= 0.25 N and nothing else disturbs")
    assert ("contact lost and made again" in claim) == (system.contact is not None)
    assert ("|force| at a step never" in claim) == (system.time is Time.DISCRETE)
    assert claim.endswith("The limit of 1 N is kept.")


def scalar(A: Entry, B: Entry, bound: Entry = 1, time: Time = Time.CONTINUOUS) -> SwitchedSystem:
    """One state, moved by one disturbance."""
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


def test_a_larger_disturbance_is_not_covered():
    system = pushed(bouncing(), "1/2")
    assert "can be left" in BOUNCE.find_fault(system)


def test_the_claim_says_the_weaker_number():
    """A level is rounded up, and the size of a disturbance down."""
    system = pushed(bouncing(), Fraction(1, 7))
    level = replace(BOUNCE, level=Fraction(2, 3))
    claim = level.claim(system)
    assert level.find_fault(system) is None
    assert "|push| <= 0.142857 N (rounded down)" in claim
    assert "never exceeds 0.666667 N (rounded up)" in claim


def test_a_limit_that_is_not_kept_is_not_said_to_be():
    system = pushed(bouncing())
    tight = replace(system, outputs=(replace(system.outputs[0], limit=Fraction(59, 100)),))
    assert "That the limit of 0.59 N is kept is not shown;" in BOUNCE.claim(tight)
    none = replace(system, outputs=(replace(system.outputs[0], limit=None),))
    assert "limit" not in BOUNCE.claim(none)


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

SHARES = {"in free motion, mode f": Fraction(11, 16)}


@pytest.mark.parametrize("where", ESCAPES)
def test_each_condition_in_steps_bars_a_set_that_is_left(where):
    system, Q = ESCAPES[where]
    faults = set()
    for multiplier in (0, 1, 2, 4, 8, 16, 32, 64):
        candidate = InvariantEllipsoid(
            ("push",),
            "force",
            Q,
            4,
            (SHARES.get(where, Fraction(1, 2)),),
            Fraction(10),
            (multiplier,),
        )
        broken = {
            failure.removeprefix("the ellipsoid can be left ")
            for failure, form in candidate.forms(system)
            if not is_definite_by_ldl(form)
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
    """Return the state after a step."""
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
    candidate = InvariantEllipsoid(("push",), "force", ROUND, 4, (Fraction(1),), Fraction(2))
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


def test_each_row_of_the_output_counts():
    system = pushed(bouncing())
    low, high = system.outputs[0].rows
    for rows in ((low, high), (high, low)):
        output = replace(system.outputs[0], rows=rows)
        tight = replace(BOUNCE, level=Fraction(1, 3))
        assert tight.find_fault(replace(system, outputs=(output,))) == (
            "force can be beyond the level"
        )
    only = replace(system, outputs=(replace(system.outputs[0], rows=(low,)),))
    assert tight.find_fault(only) is None


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"channels": ("pull",)}, "no disturbance of that name"),
        ({"output": "torque"}, "no output of that name"),
        ({"Q": ((1,),)}, "2 x 2"),
        ({"Q": ((3059, 1375), (1374, 3495))}, "not symmetric"),
        ({"Q": ((-3059, 1375), (1375, 3495))}, "not symmetric and positive"),
        ({"multipliers": ()}, "one multiplier"),
        ({"multipliers": (2598, 2598)}, "one multiplier"),
        ({"multipliers": (-1,)}, "negative"),
        ({"shares": (Fraction(0),)}, "not left"),
        ({"shares": (Fraction(1),)}, "not left"),
        ({"level": Fraction(0)}, "the level is not positive"),
        ({"denominator_log2": -1}, "the denominator of Q"),
        ({"denominator_log2": MAX_INTEGER_BITS + 1}, "the denominator of Q"),
        ({"denominator_log2": 10**400}, "the denominator of Q"),
    ],
)
def test_misfits_in_steps(changes, fault):
    assert fault in replace(STEPS, **changes).find_fault(pushed(bouncing_in_steps()))


def test_a_share_in_continuous_time_may_be_large():
    assert "left in mode" in replace(BOUNCE, shares=(Fraction(50),)).find_fault(pushed(bouncing()))


def test_an_environment_that_could_pull_is_refused_in_steps():
    system = pushed(bouncing_in_steps())
    pulled = replace(system, contact=replace(system.contact, pulls=(matrix([[1, 1]]),)))
    assert "could pull" in STEPS.find_fault(pulled)


def changed_channel(**changes: object) -> Callable[[SwitchedSystem], SwitchedSystem]:
    return lambda s: replace(s, channels=(replace(s.channels[0], **changes),))


def changed_output(**changes: object) -> Callable[[SwitchedSystem], SwitchedSystem]:
    return lambda s: replace(s, outputs=(replace(s.outputs[0], **changes),))


COLUMN = matrix([[1], [0]])


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (changed_channel(bound=Fraction(0)), "no positive bound"),
        (changed_channel(columns=(COLUMN,) * 2), "not one column for every mode"),
        (changed_channel(columns=(matrix([[1]]),) * 3), "the size of the state"),
        (changed_output(rows=()), "has no rows"),
        (changed_output(rows=(matrix([[1, 0, 0]]),)), "the size of the state"),
        (changed_output(limit=Fraction(0)), "limit of an output is not positive"),
        (changed_output(name="push"), "one name"),
        (lambda s: replace(s, channels=s.channels * 2), "one name"),
    ],
)
def test_disturbances_and_outputs_that_make_no_sense(change, fault):
    assert fault in BOUNCE.find_fault(change(pushed(bouncing())))


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
    candidate = InvariantEllipsoid(
        ("push",), "force", ((p, q), (q, r)), 1, (share,), level, (multiplier,)
    )
    assert (candidate.find_fault(system) is None) == holds(system, candidate)
