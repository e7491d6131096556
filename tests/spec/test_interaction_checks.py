"""What the parts of an interaction design must be for each other."""

import re

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import doubt_spec, parse_spec
from tests.support import ROOT, replaced

SATURATING = (ROOT / "docs/examples/saturating.nrs.yaml").read_text("utf-8")


def test_the_examples_ask_for_what_is_shown():
    assert parse_spec(SATURATING).goals.initial_force.text == "0.5 N*m"
    largest = SATURATING.replace("initial_force: 0.5 N*m", "initial_force: largest")
    assert parse_spec(largest).goals.initial_force == "largest"
    assert parse_spec(SATURATING.replace("contact: losable\n", "")).contact is None


def test_decay_of_damped_contact_that_is_kept_is_modelled():
    text = SATURATING.replace("model: elastic", "model: kelvin-voigt\n    damping: 1 N*s/m")
    assert parse_spec(text.replace("contact: losable", "contact: kept")).goals is not None


@pytest.mark.parametrize(
    ("text", "old", "new", "what"),
    [
        (SATURATING, "  command: 2000 rpm\n", "", "add `command` to the limits, in rpm"),
        (SATURATING, "force: 0.5 N*m", "force: most", "write '0.5 N*m', or 'largest'"),
        (SATURATING, "force: 0.5 N*m", "force: 0.5 N", "multiply it by its lever arm"),
        (SATURATING, "Bt: 1.04", "goals: {initial_force: largest}, Bt: 1.04", "together"),
    ],
)
def test_goals_of_the_certificate_are_for_what_it_shows(text, old, new, what):
    with pytest.raises(SpecError, match=re.escape(what)):
        parse_spec(replaced(text, (old, new)))


def test_an_environment_that_is_not_there_is_a_fault_of_its_own():
    with pytest.raises(SpecError, match="there is no environment 'soft'") as caught:
        parse_spec(SATURATING.replace("  soft:\n", "  other:\n"))
    assert "which has damping" not in str(caught.value)


@pytest.mark.parametrize(
    ("force", "doubted"), [("3 N*m", False), ("3.01 N*m", True), ("largest", False)]
)
def test_a_force_far_above_the_torque_limit_is_doubted(force, doubted):
    """The example wants more than the limit of 0.3 N m: there signals saturate."""
    doubts = list(doubt_spec(parse_spec(SATURATING.replace("0.5 N*m", force))))
    assert len(doubts) == doubted
    for doubt in doubts:
        assert doubt.at == ("goals", "initial_force")
        assert "more than 10 times limits.torque of 0.3 N*m: is that its unit?" in str(doubt)


STREAMED = (ROOT / "docs/examples/ur-like.nrs.yaml").read_text("utf-8")
LOOP = "motion_loop: {damping_ratio: 0.7, settling_time: 0.1 s}\n"
MOTOR = "actuator: {gain: 1 rad/s/V, time_constant: 0.1 s, command: V}\n"


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("limits:\n", f"{LOOP}limits:\n", "motion_loop stands beside velocity_interface"),
        ("limits:\n", f"{MOTOR}limits:\n", "actuator stands beside velocity_interface"),
        ("velocity_interface:\n", "velocity_interfaces:\n", "velocity_interface"),
        ("[3 ms, 4 ms]", "20 ms", "more than 10 periods"),
        ("[0.027 s, 0.033 s]}", "[0.033 s, 0.027 s]}", "below its start"),
        ("nominal: 0.03 s", "nominal: -0.03 s", "must be positive"),
        ("  bandwidth", "  command: 100 rpm\n  bandwidth", "a motor beside a velocity_interface"),
        ("sampling: {period: 2 ms, delay: 1, latency: 1 ms}\n", "", "beside continuous time"),
        ("contact: losable\n", "disturbances: {friction: 100 rpm}\n", "the motor takes rad/s"),
    ],
)
def test_a_robot_that_takes_velocities_has_no_other_drive(old, new, what):
    with pytest.raises(SpecError) as caught:
        parse_spec(replaced(STREAMED, (old, new)))
    said = [f"{fault.message} {fault.remedy}" for fault in caught.value.faults]
    assert any(what in text for text in said or [str(caught.value)])


def test_a_spec_says_how_its_robot_moves():
    text = STREAMED.replace("velocity_interface:\n", "").replace("  time_constant: {n", "x: {n")
    text = "\n".join(
        line for line in text.splitlines() if not line.startswith(("x:", "  dead_time"))
    )
    with pytest.raises(SpecError, match="`actuator` is missing") as caught:
        parse_spec(text)
    assert "velocity_interface" in str(caught.value.faults[0].remedy)
