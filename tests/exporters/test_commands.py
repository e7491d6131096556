"""The unit that a motor takes, in the code that commands it."""

from fractions import Fraction
from pathlib import Path

import pytest

from nrs_design.controllers.shipped import shipped_law
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import LoadedSpec, parse_spec
from tests.support import SOFT_TISSUE

VOLTS = (
    SOFT_TISSUE.read_text()
    .replace("gain: 4.8417e-4 rad/s/rpm", "gain: 0.145 rad/s/V\n  command: V")
    .replace("2060 rpm*s/rad", "6.9 V*s/rad")
    .replace("bandwidth: 2 Hz", "bandwidth: 2 Hz\n  command: 12 V")
)


@pytest.mark.parametrize(("text", "unit"), [(SOFT_TISSUE.read_text(), "rpm"), (VOLTS, "V")])
def test_the_unit_of_commands_is_named(text, unit):
    loaded = LoadedSpec(
        path=Path("volts.nrs.yaml"), sha256=64 * "0", text=text, spec=parse_spec(text)
    )
    designed = run_design(loaded)
    law = shipped_law(designed.spec, designed.design, Fraction(1, 500))
    assert law.units == {"command": unit}
    assert {law.coefficient[name].unit for name in ("Kp", "Kd_over_T")} == {f"{unit}/rad"}
    assert law.coefficient["b"].unit == "rad/(s*N*m)"
    if unit == "V":
        limit = law.coefficient["command_limit"]
        assert (limit.unit, limit.values) == ("V", (12,))
