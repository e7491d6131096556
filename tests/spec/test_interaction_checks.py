"""What the parts of an interaction design must be for each other."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import doubt_spec, parse_spec
from tests.support import ROOT

SATURATING = (ROOT / "docs/examples/saturating.nrs.yaml").read_text("utf-8")


def test_the_examples_ask_for_what_is_shown():
    assert parse_spec(SATURATING).goals.initial_force.text == "0.5 N*m"
    largest = SATURATING.replace("initial_force: 0.5 N*m", "initial_force: largest")
    assert parse_spec(largest).goals.initial_force == "largest"
    assert parse_spec(SATURATING.replace("contact: losable\n", "")).contact is None


def test_decay_of_damped_contact_that_is_kept_is_modelled():
    text = SATURATING.replace("model: elastic", "model: kelvin-voigt\n    damping: 1 N*s/m")
    assert parse_spec(text.replace("contact: losable", "contact: kept")).goals is not None


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


def test_a_spec_says_how_its_robot_moves():
    text = STREAMED.replace("velocity_interface:\n", "").replace("  time_constant: {n", "x: {n")
    text = "\n".join(
        line for line in text.splitlines() if not line.startswith(("x:", "  dead_time"))
    )
    with pytest.raises(SpecError, match="`actuator` is missing") as caught:
        parse_spec(text)
    assert "velocity_interface" in str(caught.value.faults[0].remedy)
