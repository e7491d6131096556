"""Ellipsoids off the origin: what is refused, and why each number must be as it is."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.certificates.second_opinion import agrees
from nrs_design.proof.evidence import OffsetEllipsoid
from nrs_design.proof.mode import Time
from tests.proof.systems import crowded, genuine
from tests.proof.truth import holds, is_in_other_units, offset_forms
from tests.tables import by_rows

EXAMPLES = (
    "offset-ellipsoid",
    "offset-ellipsoid, pulling",
    "offset-ellipsoid, in steps",
    "offset-ellipsoid, pulling in steps",
)


def with_entry(Q, i, j, value):
    rows = [list(row) for row in Q]
    rows[i][j] = rows[j][i] = value
    return tuple(tuple(row) for row in rows)


@pytest.mark.parametrize("example", EXAMPLES)
def test_what_the_search_finds_holds_by_the_definition(example):
    system, item = genuine(example)
    assert item.find_fault(system) is None
    assert holds(system, item)
    assert agrees(system, item)
    assert OffsetEllipsoid.from_fields(item.to_fields(), system) == item
    assert item.Q[0][0] < 0
    assert any(item.multipliers)


def supposed(system):
    """Numbers that prove nothing, of the right shape and with the right signs."""
    item = OffsetEllipsoid(
        channels=("jerk", "push"),
        output="force",
        Q=((-3, 1, 2, -5), (1, 7, -2, 3), (2, -2, 11, 4), (-5, 3, 4, 13)),
        denominator_log2=3,
        shares=(Fraction(2, 9),),
        level=Fraction(7, 3),
        roundings=(5, 17) if system.roundings else (),
    )
    return replace(item, multipliers=tuple(range(2, len(item.facts(system)) + 2)))


@pytest.mark.parametrize("time", Time)
def test_forms_are_those_of_the_definition(time):
    system = crowded(time)
    item = supposed(system)
    assert item.find_unfit(system) is None
    forms = [form for _, form in item.forms(system)]
    pairs = zip(forms, offset_forms(system, item), strict=True)
    assert all(is_in_other_units(form, wanted) for form, wanted in pairs)


@by_rows("roundings", "fault")
def test_all_roundings_or_none(roundings, fault):
    system = crowded(Time.DISCRETE)
    item = replace(supposed(system), roundings=roundings)
    assert item.find_unfit(system) == fault


@pytest.mark.parametrize("example", EXAMPLES)
@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda e: {"multipliers": (-1, *e.multipliers[1:])}, "a multiplier is negative"),
        (lambda e: {"multipliers": (*e.multipliers[:-1], -1)}, "a multiplier is negative"),
        (lambda e: {"multipliers": e.multipliers[1:]}, "one multiplier for each product"),
        (lambda e: {"multipliers": (*e.multipliers, 0)}, "one multiplier for each product"),
        (lambda e: {"roundings": (1,)}, "one multiplier for each rounding"),
        (lambda e: {"Q": with_entry(e.Q, 0, 0, 1)}, "rest is not within it"),
        (lambda e: {"Q": with_entry(e.Q, 1, 1, -e.Q[1][1])}, "the block of w in Q is not positive"),
        (lambda e: {"Q": with_entry(e.Q, 2, 2, 0)}, "the block of w in Q is not positive"),
        (lambda e: {"Q": [[*e.Q[0][:-1], e.Q[0][-1] + 1], *e.Q[1:]]}, "Q is not symmetric"),
        (lambda e: {"Q": tuple(row[1:] for row in e.Q[1:])}, "Q is not a 3 x 3 matrix"),
        (lambda e: {"shares": ()}, "there is not one share"),
        (lambda e: {"shares": e.shares * 2}, "there is not one share"),
        (lambda e: {"shares": (Fraction(0),)}, "the share is not that"),
        (lambda e: {"shares": (Fraction(50),)}, ("the share is not that", "can be left")),
        (lambda e: {"level": Fraction(0)}, "the level is not positive"),
        (lambda e: {"level": e.level * 19 / 20}, "force can be beyond the level"),
        (lambda e: {"channels": ("gust",)}, "no disturbance of that name"),
        (lambda e: {"output": "speed"}, "no output of that name"),
    ],
)
def test_wrong_numbers_are_refused(example, change, fault):
    system, item = genuine(example)
    found = replace(item, **change(item)).find_fault(system)
    assert any(words in found for words in (fault if isinstance(fault, tuple) else (fault,)))


@pytest.mark.parametrize("example", EXAMPLES)
def test_borders_of_rest_and_share(example):
    """Rest may lie on the border; a share of one leaves nothing of a map, but of a flow."""
    system, item = genuine(example)
    assert replace(item, Q=with_entry(item.Q, 0, 0, 0)).find_misfit(system) is None
    for share in (Fraction(1), Fraction(3, 2)):
        found = replace(item, shares=(share,)).find_misfit(system)
        assert (found is None) == (system.time is Time.CONTINUOUS)


def test_it_says_what_it_bounds():
    system, item = genuine("offset-ellipsoid, in steps")
    claim = item.claim(system)
    assert "at any time (the surface stays in its place, or follows the axis): from rest" in claim
    assert "|force| at a step never exceeds" in claim
    assert item.bound(system).share == item.shares[0]
