"""Bounds on an output: known answers, attacks, and what each condition bars.

The limits of its numbers are rows of test_invariant_ellipsoid.yaml.
"""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.certificates.second_opinion import agrees
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.evidence import InvariantEllipsoid, Shows
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from tests.proof.graphs import common_quadratic
from tests.proof.systems import Entry, bouncing, bouncing_in_steps, crowded, family, matrix, pushed
from tests.proof.truth import combine, inequality, is_in_other_units, is_positive_multiple, moves


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
