"""Which law ships: no limit is above what is written, and what has no program is refused."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.controllers.float32 import is_float32
from nrs_design.controllers.gains import idle_share
from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.parts import DEFAULT_LIMIT
from nrs_design.controllers.shipped import shipped_law, step_limits
from nrs_design.controllers.step_logic import StepLogic
from nrs_design.errors import DesignError
from nrs_design.models.linear_form import coordinates, zero
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.controllers.roundings import linear_forms
from tests.support import ROOT, SOFT_TISSUE, replaced, spec_in

PERIOD = Fraction(1, 500)
BY_SIGN = ROOT / "docs/examples/insertion-by-sign.nrs.yaml"
MIXED = ROOT / "docs/examples/mixed-controllers.nrs.yaml"


def designed(path, text, *changes):
    return run_design(read_spec(spec_in(path, replaced(text, *changes))))


def law_of(found, period=PERIOD):
    return shipped_law(found.spec, found.design, period)


def test_limits_come_from_the_spec_and_are_not_above_it(tmp_path):
    found = designed(
        tmp_path,
        SOFT_TISSUE.read_text() + "sampling: {period: 2 ms, delay: 0}\n"
        "disturbances: {largest_angle: 20 deg}\n",
        ("bandwidth: 2 Hz", "bandwidth: 2 Hz\n  command: 3333.3 rpm"),
    )
    limits = step_limits(found.spec)
    pi_below = Fraction(314159265, 10**8)
    # One step of single precision is a part in 2^23 at most.
    for value, written in (
        (limits.command, Fraction("3333.3")),
        (limits.velocity, 8 * pi_below / 180),
        (limits.angle, 20 * pi_below / 180),
    ):
        assert is_float32(value)
        assert written * (1 - Fraction(2, 10**7)) < value <= written * (1 + Fraction(1, 10**7))
    assert limits.command <= Fraction("3333.3")
    law = law_of(found)
    assert law.outputs == {"command": "limited_command"}
    kept = {value.name: value.limit for value in law.values}
    assert (kept["angle"], kept["reference"], kept["torque"]) == (
        limits.angle,
        limits.angle,
        DEFAULT_LIMIT,
    )


def test_without_limits_inputs_are_held_against_nonsense_only(tmp_path):
    found = run_design(read_spec(SOFT_TISSUE))
    limits = step_limits(found.spec)
    assert (limits.angle, limits.command) == (DEFAULT_LIMIT, None)
    assert law_of(found).outputs == {"command": "command"}


def test_coefficients_are_those_of_the_sampled_design():
    found = run_design(read_spec(SOFT_TISSUE))
    law = law_of(found)
    assert law.modes == ("insertion", "withdrawal")
    for k, controller in enumerate(found.design.controllers):
        wanted = controller.law.discretize(PERIOD, "exact").numbers
        assert {name: law.coefficient[name].number(k) for name in wanted} == wanted
    assert law_of(found, 2 * PERIOD) != law


def test_all_kinds_of_controllers_in_one_law():
    found = run_design(read_spec(MIXED))
    law = law_of(found)
    assert law.modes == tuple(found.spec.controllers)
    idle = idle_share(found.spec.idle_states, PERIOD)
    moves = [controller.law.commands == "velocity" for controller in found.design.controllers]
    assert law.coefficient["d"].values == tuple(Fraction(1) if m else idle for m in moves)
    assert law.coefficient["takes_offset"].values == tuple(map(Fraction, map(int, moves)))
    gains = [controller.law.gains.get("Kp", 0) for controller in found.design.controllers]
    assert list(law.coefficient["Kf"].values) == gains
    assert any(gains)
    assert {*moves} == {True, False}


def test_a_reset_is_a_step_that_leaves_nothing_of_idle_states(tmp_path):
    """From zero on, the law with a reset does what that without does: the proof has both steps."""
    change = ("idle_states: {decay: 20 1/s}", "idle_states: {decay: 20 1/s, reset: true}")
    decaying, law = (
        law_of(run_design(read_spec(MIXED))),
        law_of(designed(tmp_path, MIXED.read_text(), change)),
    )
    kinds = [name == "insertion" for name in law.modes]
    assert law.coefficient["d"].values == tuple(map(Fraction, map(int, kinds)))
    given = {v.name: form for v, form in zip(law.values, coordinates(len(law.values)), strict=True)}
    emptied = given | {name: zero(len(given)) for name in ("offset", "velocity")}
    for mode, moves in enumerate(kinds):
        forms, others = (linear_forms(one, mode, given) for one in (law, decaying))
        if moves:
            assert forms == others
            continue
        assert not any(forms["next_offset"])
        assert not any(forms["next_velocity"])
        after, wanted = (linear_forms(one, mode, emptied) for one in (law, decaying))
        assert after == wanted


def test_thresholds_ship_as_a_mode_logic():
    found = run_design(read_spec(BY_SIGN))
    law = law_of(found)
    assert law.logic is not None
    assert law.logic.start == law.modes.index("insertion")
    assert (
        law.logic.hold_samples
        == StepLogic.create(found.spec.mode_logic, law.modes, PERIOD).hold_samples
    )
    assert law_of(run_design(read_spec(SOFT_TISSUE))).logic is None


def test_a_spring_beside_other_controllers_draws_to_the_commanded_position():
    """By what its admittance has moved the reference, as the sampled loop of the proof has it."""
    found = run_design(read_spec(MIXED))
    controllers = tuple(
        replace(c, law=replace(c.law, Kt=Fraction(1))) if isinstance(c.law, Admittance) else c
        for c in found.design.controllers
    )
    law = shipped_law(found.spec, replace(found.design, controllers=controllers), PERIOD)
    unit = coordinates(len(law.values))
    given = dict(zip((value.name for value in law.values), unit, strict=True))
    place, numbers = [*given].index("offset"), law.coefficient
    for mode, controller in enumerate(controllers):
        moves = isinstance(controller.law, Admittance)
        forms = linear_forms(law, mode, given)
        assert numbers["Kt"].number(mode) == moves
        assert forms["pushed"][place] == numbers["b"].number(mode) * moves


def test_inertia_of_some_controllers_is_refused(tmp_path):
    text = SOFT_TISSUE.read_text()
    head, middle, last = text.partition("  withdrawal:")
    old, new = "Mt: {min: 0.01 kg*m^2, max: 1 kg*m^2}", "Mt: {min: 0 kg*m^2, max: 0 kg*m^2}"
    found = designed(tmp_path, head + middle + last.replace(old, new))
    with pytest.raises(DesignError, match="different states of their own"):
        law_of(found)
