from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import pytest

from nrs_design.proof.channels import Channel, Output, Rounding
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.saturation import Start
from nrs_design.proof.switching import Clock, FixedParameter, Reset, Stay, Switching
from tests.proof.systems import (
    bouncing,
    bouncing_in_steps,
    bouncing_in_turns,
    doubled_in_turns,
    family,
    juggling,
    juggling_among_modes,
    kept,
    matrix,
    pushed,
    saturating,
    saturating_in_steps,
)

HALF = Fraction(1, 2)

PUSHED = pushed(bouncing(1))

(PUSH,), (FORCE,), ONE = PUSHED.channels, PUSHED.outputs, matrix([[1]])


@pytest.mark.parametrize(
    ("rules", "reason"),
    [
        ({"dwell_time": Fraction(-1)}, "a dwell time is negative"),
        ({"dwell_time": -HALF}, "a dwell time is negative"),
        ({"stays": (("m0", Stay(Fraction(-1))),)}, "a dwell time is negative"),
        ({"stays": (("m0", Stay(Fraction(1))), ("m1", Stay(-HALF)))}, "a dwell time is negative"),
        ({"stays": (("m9", Stay()),)}, "not those of modes"),
        ({"stays": (("m0", Stay()), ("m0", Stay()))}, "not those of modes"),
        ({"stays": (("m1", Stay(Fraction(1), HALF)),)}, "mode m1 must be left before it may be"),
        ({"transitions": (("m0", "m0"),)}, "a transition does not lead"),
        ({"transitions": (("m0", "m9"),)}, "a transition does not lead"),
        ({"transitions": (("m9", "m0"),)}, "a transition does not lead"),
        ({"transitions": (("m0", "m1"), ("m8", "m9"))}, "a transition does not lead"),
        ({"resets": (Reset("m0", "m0", ONE),)}, "a reset does not lead"),
        ({"resets": (Reset("m0", "m9", ONE),)}, "a reset does not lead"),
        ({"resets": (Reset("m9", "m0", ONE),)}, "a reset does not lead"),
        ({"resets": (Reset("m0", "m1", ONE), Reset("m8", "m9", ONE))}, "a reset does not lead"),
        ({"resets": (Reset("m0", "m1", RationalMatrix(((1,),), 0)),)}, "not a matrix over"),
        ({"resets": (Reset("m0", "m1", RationalMatrix(((1,),), -1)),)}, "not a matrix over"),
        ({"resets": (Reset("m0", "m1", RationalMatrix(((1,), (1, 2)))),)}, "not a matrix over"),
        ({"fixed_ends": (("m0", "m0"),)}, "not the ends of constant"),
        ({"fixed_ends": (("m0", "m9"),)}, "not the ends of constant"),
        ({"fixed_ends": (("m0", "m1"), ("m0", "m1"))}, "not the ends of constant"),
        ({"fixed_ends": (("m0",), ("m1",))}, "not the ends of constant"),
        ({"fixed_ends": (("m0", "m1"), ("m2",))}, "not the ends of constant"),
    ],
)
def test_rules_that_make_no_sense(rules, reason):
    modes = [[[-1]]] * (2 + ("m2" in str(rules)))
    found = find_contradiction(family(*modes, switching=Switching(**rules)))
    assert reason in str(found)


@pytest.mark.parametrize(
    "rules",
    [
        Switching(Fraction(1), (("m0", "m1"),), fixed_ends=(("m0", "m1"),)),
        Switching(transitions=()),
        Switching(HALF, stays=(("m0", Stay()), ("m1", Stay(HALF, HALF)))),
        Switching(resets=(Reset("m1", "m0", ONE), Reset("m1", "m0", ONE))),
    ],
)
def test_rules_that_make_sense(rules):
    assert find_contradiction(family([[-1]], [[-1]], switching=rules)) is None


@pytest.mark.parametrize(("longest", "is_odd"), [(HALF, True), (Fraction(1), False)])
def test_no_stay_is_shorter_than_a_step(longest, is_odd):
    rules = Switching(stays=(("m0", Stay(Fraction(0), longest)),))
    found = find_contradiction(family([["1/2"]], time=Time.DISCRETE, switching=rules))
    assert (found == "mode m0 must be left before it may be") is is_odd


def test_a_time_of_a_step_needs_steps():
    system = bouncing_in_steps()
    assert find_contradiction(system) is None
    assert find_contradiction(replace(system, sample_time=None)) is None
    zero, negative = (replace(system, sample_time=time) for time in (Fraction(0), -HALF))
    for odd in (zero, negative, replace(family([[1]]), sample_time=Fraction(1))):
        assert "the time of a step is not positive" in find_contradiction(odd)


def free(*matrices, names=("f0", "f1", "f2")):
    return Contact(tuple(Mode(name, matrix(A)) for name, A in zip(names, matrices, strict=False)))


THREE = family([[0, 0, 0], [0, 0, 0], [0, 0, 0]])

MOVING, AT_REST = [[-2, 0], [1, 0]], [[-1, 0], [0, 0]]

STEP = [["4/5", 0], ["1/10", 1]]


def test_contact_needs_a_state_beside_the_deflection():
    for system in (
        replace(family([[-1]]), contact=free([[0]])),
        replace(family([[-1]], [[-1, 0], [0, -1]]), contact=free(MOVING)),
        replace(family([[-1, 0], [0, -1]], [[-1]]), contact=free(MOVING)),
    ):
        assert "do not share a deflection" in find_contradiction(system)


@pytest.mark.parametrize(
    ("contact", "reason"),
    [
        (free(), "no free mode"),
        (free(MOVING, names=("m0",)), "two modes have one name"),
        (free(MOVING, AT_REST, names=("f", "f")), "two modes have one name"),
        (free(MOVING, AT_REST, names=("f", "m1")), "two modes have one name"),
        (free([[-2, 1], [1, 0]]), "acts on the other states"),
        (free(MOVING, [[-2, 1], [1, 0]]), "acts on the other states"),
        (free([[-2, 0], [1, 1]]), "acts on the other states"),
        (free([[-2, 0], [1, -1]]), "acts on the other states"),
        (free([[0]]), "acts on the other states"),
        (free([[-2, 0, 0], [0, -2, 0], [0, 1, 0]]), "acts on the other states"),
        (Contact((Mode("f", RationalMatrix(((-2, 0), (1, 0)), 0)),)), "acts on the other states"),
    ],
)
def test_free_modes_that_make_no_sense(contact, reason):
    assert reason in find_contradiction(replace(bouncing(), contact=contact))


@pytest.mark.parametrize(
    ("system", "contact"),
    [
        (bouncing(), free(MOVING)),
        (bouncing(), free(MOVING, AT_REST)),
        (bouncing_in_steps(), free(STEP)),
        (THREE, free([[-2, 1, 0], [0, -2, 0], [0, 1, 0]])),
    ],
)
def test_free_modes_that_make_sense(system, contact):
    assert find_contradiction(replace(system, contact=contact)) is None


@pytest.mark.parametrize("push", [[1, 0], [0, 1]])
def test_no_state_is_pushed_in_free_motion(push):
    rows = [[-2, 1, push[0]], [0, -2, push[1]], [0, 1, 0]]
    system = replace(THREE, contact=free(rows))
    assert "acts on the other states" in find_contradiction(system)


@pytest.mark.parametrize("last", ["9/10", 0, 2])
def test_a_free_deflection_stays_from_step_to_step(last):
    system = replace(bouncing_in_steps(), contact=free([["4/5", 0], ["1/10", last]]))
    assert "acts on the other states" in find_contradiction(system)


@pytest.mark.parametrize(
    ("row", "is_odd"),
    [
        (RationalMatrix(((0, 1),)), False),
        (RationalMatrix(((0, 1),), 0), True),
        (RationalMatrix(((0, 1), (0, 1))), True),
        (RationalMatrix(((1,),)), True),
        (RationalMatrix(((0, 0, 1),)), True),
    ],
)
def test_a_pull_is_one_row(row, is_odd):
    system = bouncing()
    contact = replace(system.contact, pulls=(RationalMatrix(((1, 1),)), row))
    found = find_contradiction(replace(system, contact=contact))
    assert (found == "a force is not one row over a positive denominator") is is_odd
    assert (found is None) is not is_odd


COLUMN, WRONG = PUSH.columns[0], "push does not have the size of the state"


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"columns": (RationalMatrix(((1,), (0,)), 0),) * 3}, WRONG),
        ({"columns": (COLUMN, COLUMN, ONE)}, WRONG),
        ({"columns": (matrix([[1, 0]]),) * 3}, WRONG),
        ({"columns": (matrix([[1], [0], [0]]),) * 3}, WRONG),
        ({"columns": (COLUMN,) * 2}, "not one column for every mode"),
        ({"columns": (COLUMN,) * 4}, "not one column for every mode"),
        ({"bound": Fraction(0)}, "no positive bound"),
        ({"bound": -HALF}, "no positive bound"),
        ({"name": "force"}, "two disturbances or outputs have one name"),
    ],
)
def test_disturbances_that_make_no_sense(changes, reason):
    odd = replace(PUSH, **changes)
    for channels in ((odd,), (replace(PUSH, name="other"), odd)):
        assert reason in find_contradiction(replace(PUSHED, channels=channels))


ROW = FORCE.rows[0]


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"rows": (ROW, RationalMatrix(((0, 1),), 0))}, "force does not have the size"),
        ({"rows": (ROW, ONE)}, "force does not have the size"),
        ({"rows": (matrix([[0], [1]]),)}, "force does not have the size"),
        ({"rows": ()}, "an output has no rows"),
        ({"limit": Fraction(0)}, "the limit of an output is not positive"),
        ({"limit": -HALF}, "the limit of an output is not positive"),
        ({"name": "other"}, "two disturbances or outputs have one name"),
    ],
)
def test_outputs_that_make_no_sense(changes, reason):
    outputs = replace(FORCE, name="other"), replace(FORCE, **changes)
    assert reason in find_contradiction(replace(PUSHED, outputs=outputs))


def test_disturbances_and_outputs_that_make_sense():
    slight = Channel("slight", "N", Fraction(1, 9), PUSH.columns)
    sum_of_both = Output("sum", "N", (matrix([[1, 1]]),), Fraction(1, 9))
    system = replace(
        PUSHED, channels=(PUSH, slight), outputs=(FORCE, replace(sum_of_both, limit=None))
    )
    assert find_contradiction(system) is None
    assert find_contradiction(replace(system, outputs=(sum_of_both,))) is None
    kept = family([[-1, 0], [0, -1]])
    one_mode = replace(kept, channels=(replace(PUSH, columns=(COLUMN,)),))
    assert find_contradiction(one_mode) is None


ROUNDS = replace(pushed(bouncing_in_steps()), sample_time=None)

ERROR = Rounding(
    "F", (COLUMN,) * 3, (matrix([[1, 2, 3]]), matrix([[4, 5, 6]]), matrix([[7, 0, 8]]))
)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({}, None),
        ({"columns": (COLUMN, COLUMN, ONE)}, "the rounding of F does not have the size"),
        (
            {"columns": (COLUMN, COLUMN, matrix([[1, 0]]))},
            "the rounding of F does not have the size",
        ),
        (
            {"columns": (COLUMN, COLUMN, RationalMatrix(((1,), (0,)), 0))},
            "the rounding of F does not have the size",
        ),
        ({"rows": (*ERROR.rows[:2], matrix([[7, 0]]))}, "the rounding of F does not have the size"),
        (
            {"rows": (*ERROR.rows[:2], matrix([[7, 0, 8, 9]]))},
            "the rounding of F does not have the size",
        ),
        ({"columns": (COLUMN,) * 2}, "the rounding of F has not one column and row"),
        ({"columns": (COLUMN,) * 4}, "the rounding of F has not one column and row"),
        ({"rows": ERROR.rows[:2]}, "the rounding of F has not one column and row"),
        ({"rows": (*ERROR.rows, ERROR.rows[2])}, "the rounding of F has not one column and row"),
        (
            {"rows": (*ERROR.rows[:2], matrix([[7, 1, 8]]))},
            "the rounding of F depends on the deflection in free motion",
        ),
    ],
)
def test_roundings_that_make_sense_and_others(changes, reason):
    other = replace(ERROR, name="other")
    for roundings in ((replace(ERROR, **changes),), (other, replace(ERROR, **changes))):
        found = find_contradiction(replace(ROUNDS, roundings=roundings))
        assert found == reason if reason is None else found.startswith(reason)


def test_roundings_need_steps_of_one_size_and_names():
    twice = replace(ROUNDS, roundings=(ERROR, ERROR))
    assert find_contradiction(twice) == f"the rounding of {ERROR.name} is said twice"
    first = Rounding("F", (matrix([[1]]),), (ONE,))
    in_time = replace(family([[-1]]), roundings=(first,))
    assert find_contradiction(in_time) == "the arithmetic rounds, but there are no steps"
    assert find_contradiction(replace(in_time, time=Time.DISCRETE)) is None
    unequal = family([["1/2"]], [["1/2", 0], [0, "1/2"]], time=Time.DISCRETE)
    found = find_contradiction(replace(unequal, roundings=(first,)))
    assert found == "the rounding of F is of modes that are not of one size"
    assert find_contradiction(unequal) is None


CONTRADICTIONS = [
    ({"clock": Clock(1, ("m0",))}, "take turns without steps"),
    ({"clock": Clock(3, ())}, "has no mode"),
    ({"clock": Clock(3, ("m0", "m1"))}, "has no mode"),
    ({"clock": Clock(3, ("m0", "m2"))}, "does not exist"),
    ({"clock": Clock(3, ("m0",), ((0, 1), (0, -1)))}, "not said of every state"),
    ({"clock": Clock(2, ("m0",), ((0, 1), (0,)))}, "not said of every state"),
    ({"clock": Clock(2, ("m0",), ((0, 2), (0, -1)))}, "does not have"),
    ({"clock": Clock(2, ("m0",), ((0, 1), (-2, 0)))}, "does not have"),
    ({"clock": Clock(2, ("m0",), ((0, 1), (-1, -1)))}, "no mode may be in force"),
    ({"switching": Switching(Fraction(2))}, "rules of switching besides"),
]


@pytest.mark.parametrize(("changes", "reason"), CONTRADICTIONS)
def test_turns_that_make_no_sense(changes, reason):
    system = doubled_in_turns(3)
    assert find_contradiction(system) is None
    assert reason in find_contradiction(replace(system, **changes))


def test_a_rule_for_misses_makes_sense():
    rule = Clock(2, ("m0",), ((0, 1), (0, -1)))
    assert find_contradiction(replace(doubled_in_turns(3), clock=rule)) is None


def test_turns_need_steps_of_one_size_and_free_modes_of_their_own():
    clock = Clock(2, ("m0",))
    assert "without steps" in find_contradiction(replace(family([[-1]], [[-2]]), clock=clock))
    two = doubled_in_turns(2)
    unlike = replace(two, modes=(two.modes[0], family([[1, 0], [0, 1]]).modes[0]))
    unlike = replace(unlike, modes=(unlike.modes[0], replace(unlike.modes[1], name="m1")))
    assert "unlike size" in find_contradiction(unlike)
    bounce = bouncing_in_turns()
    assert find_contradiction(bounce) is None
    for first in (("push 1", "push 2"), ("push 1", "push 2", "fall", "fall on")):
        found = find_contradiction(replace(bounce, clock=Clock(2, first)))
        assert found == "a step of a round has no mode, in contact or free"
    for a, b in pairwise(bounce.contact.free):
        alone = replace(bounce, contact=Contact((a,)), clock=Clock(2, ("push 1", "fall")))
        assert "has no mode" in find_contradiction(alone)
        assert a != b


def test_signals_that_saturate_fit_every_mode_of_one_size():
    system = saturating()
    one_less = replace(system, modes=system.modes[:1])
    assert find_contradiction(one_less) == "s1 has not one column and row for every mode"
    unlike = family([[-1]], [[-1, 0], [0, -1]])
    found = find_contradiction(replace(unlike, saturation=system.saturation))
    assert found == "s1 is of modes that are not of one size"


SIGNALS = saturating().saturation.signals
RAGGED = RationalMatrix(((1,), (1, 2)))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"signals": ()}, "no signal saturates"),
        ({"signals": (SIGNALS[0],) * 5}, "or more than 4 do"),
        ({"signals": (SIGNALS[0],) * 4}, "s1 does not have the size of the state"),
        ({"signals": (SIGNALS[0], replace(SIGNALS[1], name="s1"))}, "s1 is said twice"),
        ({"signals": SIGNALS[1:]}, "s2 does not have the size of the state"),
        ({"signals": (replace(SIGNALS[0], limit=Fraction(0)),)}, "the limit of s1 is not positive"),
        (
            {"signals": (replace(SIGNALS[0], rows=(matrix([[-1, 1]]),) * 3),)},
            "s1 depends on the deflection in free motion",
        ),
        ({"start": Start("force", "N", ())}, "force does not have the size of the state"),
        ({"start": Start("force", "N", (ONE,))}, "force does not have the size of the state"),
        *(
            ({"start": Start("force", "N", (matrix([[0], [1]]), state))}, reason)
            for state, reason in (
                (RAGGED, "force does not have the size of the state"),
                (matrix([[0], [0]]), "force stands for a state that is zero"),
                (matrix([[1], [-1]]), "force stands for a state without contact"),
                (matrix([["1", 0]]), "force does not have the size of the state"),
                (matrix([[-1], [0]]), "None"),
            )
        ),
    ],
)
def test_signals_that_make_no_sense(changes, reason):
    system = saturating()
    odd = replace(system, saturation=replace(system.saturation, **changes))
    assert reason in str(find_contradiction(odd))


def test_where_contact_is_kept_a_motion_may_begin_anywhere():
    system = kept(saturating())
    start = replace(system.saturation.start, states=(matrix([[1], [-1]]),))
    assert (
        find_contradiction(replace(system, saturation=replace(system.saturation, start=start)))
        is None
    )


@pytest.mark.parametrize(
    ("errors", "reason"),
    [
        ((ONE,) * 3, "None"),
        ((ONE,) * 2, "has not one row of what acts on it for every mode"),
        ((ONE,) * 4, "has not one row of what acts on it for every mode"),
        ((ONE, ONE, matrix([[1, 1]])), "does not know what the arithmetic rounds"),
        ((ONE, ONE, RationalMatrix(((1,),), 0)), "does not know what the arithmetic rounds"),
        ((), "None"),
    ],
)
def test_what_is_rounded_of_a_signal_is_said_for_every_mode(errors, reason):
    system = saturating_in_steps()
    (signal,) = system.saturation.signals
    odd = replace(system.saturation, signals=(replace(signal, errors=errors),))
    assert reason in str(find_contradiction(replace(system, saturation=odd)))


@pytest.mark.parametrize(
    ("flights", "reason"),
    [
        (Flights(("m0",), ("m0",)), "no mode, or is both"),
        (Flights(("m0",), ("fre",)), "no mode, or is both"),
        (Flights(("m0",), ("free",), (matrix([[1, 1]]),)), "a force is not one row"),
    ],
)
def test_free_motion_among_the_modes_that_makes_no_sense(flights, reason):
    system = juggling_among_modes()
    assert find_contradiction(system) is None
    assert reason in find_contradiction(replace(system, flights=flights))


def test_free_motion_is_among_the_modes_or_beside_them():
    words = "among the modes and beside them"
    both = replace(juggling(), flights=Flights(("m0",), ()))
    unequal = replace(family([[-1]], [[-1, 0], [0, -1]]), flights=Flights((), ()))
    assert words in find_contradiction(both)
    assert words in find_contradiction(unequal)


@pytest.mark.parametrize(
    ("low", "high", "inverse", "odd"),
    [
        (2, 1, False, True),
        (0, 1, True, True),
        (1, 2, True, False),
        (1, 1, False, False),
        (0, 1, False, False),
    ],
)
def test_constant_parameters_have_a_range(low, high, inverse, odd):
    known = FixedParameter("k", Fraction(low), Fraction(high), inverse=inverse)
    switching = Switching(fixed_ends=(("m0", "m1"),), fixed_parameters=(known,))
    system = replace(family([[-1]], [[-2]]), switching=switching)
    found = find_contradiction(system)
    assert found == ("constant parameter k has no range, or no modes" if odd else None)
    alone = replace(switching, fixed_ends=())
    assert find_contradiction(replace(system, switching=alone)).endswith("or no modes")


@pytest.mark.parametrize(
    ("sets", "reason"),
    [
        ((("m0", "m1"),), None),
        ((("m0", "m9"),), "not one of modes"),
        ((("m0", "m1"), ("m1", "m2")), "in two of them"),
        (((),), "is empty"),
        ((("m0", "small"),), "not of one size"),
    ],
)
def test_enclosures_are_sets_of_modes(sets, reason):
    two = [[0, 1], [-1, -1]]
    system = family(two, two, two, [[-1]], names=("m0", "m1", "m2", "small"))
    found = find_contradiction(replace(system, enclosures=sets))
    assert found is None if reason is None else reason in found
