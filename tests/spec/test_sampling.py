"""The processor in a spec: period, delay, and what has no room in the sampled loop."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from tests.support import SOFT_TISSUE

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("drive", "written", "unit"),
    [
        ("velocity_interface: {time_constant: 0.02 s}", "0.02 rad/s", "rad/s"),
        ("position_interface: {time_constant: 0.02 s}", "1 mrad", "rad"),
    ],
)
def test_friction_is_in_the_unit_of_the_command(drive, written, unit):
    """Of each drive, whatever it takes; the rpm of a driver are no velocity."""
    start = TEXT.index("actuator:")
    text = TEXT[:start] + drive + TEXT[TEXT.index("\nlimits:") :]
    more = "sampling: {period: 2 ms, delay: 0}\ncontact: kept\ndisturbances: {friction: %s}\n"
    spec = parse_spec(f"{text}\n{more % written}")
    assert spec.disturbances.bounds()["friction"][1] == unit == spec.command
    with pytest.raises(SpecError, match=f"and the motor takes {unit}"):
        parse_spec(f"{text}\n{more % '2 rpm'}")
