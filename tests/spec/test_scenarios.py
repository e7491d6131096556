"""Scenarios as a spec says them, and what is wrong with bad ones."""

from nrs_design.spec import parse_spec
from tests.simulation.interactions import PLACED, text_of

RUN = "command: {constant: 4 deg/s}, duration: 1 s"


def test_position_and_force_controllers_may_be_named():
    control = "{threshold: {position: position, force: force, torque: 0.27 N*m}}"
    spec = parse_spec(text_of(PLACED, scenario=f"{RUN}, control: {control}"))
    assert spec.scenarios["run"].control.threshold.force == "force"
