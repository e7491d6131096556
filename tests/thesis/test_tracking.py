"""Tables 4.2 to 4.10: measured on the robot of the thesis, and on no other."""

import math
from dataclasses import replace

import pytest

from nrs_design.robot.models.neuroboscope import robot, robot_spec
from nrs_design.robot.simulation.tracking.experiment import thesis_experiments
from nrs_design.robot.simulation.tracking.measured import measured_rmse
from nrs_design.spec import parse_spec
from nrs_design.spec.templates import TEMPLATES

TEXT = TEMPLATES["robot"]
TILTED = robot().tilted(robot_spec().balance.tilt.si)
DEPTH = thesis_experiments(TILTED, "balanced")[0]


@pytest.mark.parametrize(
    ("controller", "moved", "print"),
    [
        ("computed-torque", 1, (0.8216, 0.0626, 0.1783)),
        ("independent-joint", 2, (0.0157, 0.0488, 0.2224)),
        ("balanced", 0, (0.0449, 0.0680, 0.6263)),
    ],
)
def test_printed_beside_simulated(controller, moved, print):
    """Phi and psi in deg, d in mm; a name of one's own is still the same robot."""
    one = thesis_experiments(TILTED, controller)[moved]
    ours = parse_spec(TEXT.replace("name: neuroboscope", "name: mine"))
    assert measured_rmse(ours, TILTED, controller, one) == print


@pytest.mark.parametrize(
    ("text", "tilt", "controller", "rate"),
    [
        (TEXT.replace("mass: 73.3 g", "mass: 73.4 g"), -28.5, "balanced", DEPTH.rate),
        (TEXT, -20, "balanced", DEPTH.rate),
        (TEXT, -28.5, "balanced", 1.0),
        (TEXT, -28.5, "computed-torque", DEPTH.rate),
    ],
    ids=["robot", "tilt", "motion", "controller"],
)
def test_no_measurement_of_another(text, tilt, controller, rate):
    base, other = robot().tilted(math.radians(tilt)), replace(DEPTH, rate=rate)
    assert measured_rmse(parse_spec(text), base, controller, other) is None
