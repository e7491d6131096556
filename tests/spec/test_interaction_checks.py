"""What the parts of an interaction design must be for each other."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from tests.support import ROOT

STREAMED = (ROOT / "docs/examples/ur-like.nrs.yaml").read_text("utf-8")


def test_a_spec_says_how_its_robot_moves():
    text = STREAMED.replace("velocity_interface:\n", "").replace("  time_constant: {n", "x: {n")
    text = "\n".join(
        line for line in text.splitlines() if not line.startswith(("x:", "  dead_time"))
    )
    with pytest.raises(SpecError, match="`actuator` is missing") as caught:
        parse_spec(text)
    assert "velocity_interface" in str(caught.value.faults[0].remedy)
