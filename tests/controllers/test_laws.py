from fractions import Fraction
from typing import get_args

import pytest

from nrs_design.controllers.laws import (
    LAWS,
    Admittance,
    IntegralForce,
    PositionControl,
    ProportionalForce,
)
from nrs_design.controllers.step_law import StepFrame, build_law
from nrs_design.design.laws import LAW_DESIGNS
from nrs_design.models.linear_form import combine, coordinates, zero
from nrs_design.spec import ControllerSpec
from tests.controllers.roundings import linear_forms

ONE = Fraction(1)


def test_every_type_of_controller_has_a_law_and_a_design():
    union = get_args(ControllerSpec)[0]
    types = {get_args(given.model_fields["type"].annotation)[0] for given in get_args(union)}
    assert set(LAWS) == set(LAW_DESIGNS) == types


def test_a_spring_is_a_gain_only_where_there_is_one():
    sprung = Admittance(Fraction(1), Fraction(2), Fraction(3))
    assert sprung.gains == {"Mt": 1, "Bt": 2, "Kt": 3}
    for law in (sprung, Admittance(Fraction(1), Fraction(2))):
        assert Admittance.create(law.gains) == law


@pytest.mark.parametrize(
    "law",
    [
        Admittance(ONE, ONE),
        Admittance(Fraction(0), ONE),
        ProportionalForce(ONE),
        IntegralForce(ONE, ONE),
        PositionControl(),
    ],
)
def test_the_operations_of_a_law_approach_what_it_responds(law):
    """Of a law alone, over 1 ms: rates by differences, on force, states and reference."""
    period = Fraction(1, 1000)
    program = build_law(StepFrame(ONE, ONE), {"one": law.discretize(period, "exact")})
    unit = coordinates(len(program.values))
    given = {value.name: form for value, form in zip(program.values, unit, strict=True)}
    made = linear_forms(program, 0, given | dict.fromkeys(("wanted_torque",), zero(len(unit))))
    own = [v.name for v in program.states if v.name not in ("reference", "error_before")]
    command, rates = law.respond(given["torque"], [given[name] for name in own])
    pairs = [
        (combine((1 / period, made[program.following[n]]), (-1 / period, given[n])), rate)
        for n, rate in zip(own, rates, strict=True)
    ]
    moved = {"velocity": ("next_reference", "reference", 1 / period)}
    after, before, per = moved.get(law.commands, ("reference", "position", ONE))
    change = combine((per, made[after]), (-per, given[before]))
    if law.commands == "velocity":
        change = combine((ONE, change), (-ONE, given["velocity_command"]))
    for found, wanted in [*pairs, (change, command)]:
        assert [*map(float, found)] == pytest.approx([*map(float, wanted)], abs=1e-3)
