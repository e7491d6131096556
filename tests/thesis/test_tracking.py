import math
from dataclasses import replace

import pytest

from nrs_design.robot.models import build_robot
from nrs_design.robot.simulation.tracking import thesis_experiments
from nrs_design.robot.simulation.tracking.measured import measured_rmse
from nrs_design.spec import parse_spec
from nrs_design.spec.templates import TEMPLATES
from nrs_design.thesis.tracking import rows

TEXT = TEMPLATES["robot"]
# Tables 4.2 to 4.10: phi and psi in deg, d in mm, where d, phi and psi moves.
TABLES = {
    "computed-torque": [
        (0.0515, 0.1080, 0.2417),
        (0.8216, 0.0626, 0.1783),
        (0.0511, 0.7248, 0.8359),
    ],
    "independent-joint": [
        (0.0124, 0.0555, 0.5122),
        (0.0624, 0.0279, 0.1261),
        (0.0157, 0.0488, 0.2224),
    ],
    "balanced": [(0.0449, 0.0680, 0.6263), (0.2139, 0.0782, 0.5086), (0.0690, 0.2347, 0.5827)],
}


@pytest.fixture(scope="module")
def spec():
    return parse_spec(TEXT)


@pytest.fixture(scope="module")
def robot(spec):
    return build_robot(spec).tilted(spec.balance.tilt.si)


@pytest.mark.parametrize("controller", TABLES)
def test_printed_beside_simulated(spec, robot, controller):
    experiments = thesis_experiments(robot, controller)
    found = [measured_rmse(spec, robot, controller, one) for one in experiments]
    assert found == TABLES[controller]


def test_measurements_stay_hardware_only():
    assert [row.verdict for row in rows()] == ["derived"] + ["not reproducible"] * 9


def test_a_name_of_ones_own_is_still_the_same_robot(robot):
    ours = parse_spec(TEXT.replace("name: neuroboscope", "name: mine"))
    depth = thesis_experiments(robot, "balanced")[0]
    assert measured_rmse(ours, robot, "balanced", depth) == TABLES["balanced"][0]


def test_no_measurement_of_another_robot_tilt_or_motion(spec, robot):
    depth = thesis_experiments(robot, "balanced")[0]
    other = parse_spec(TEXT.replace("mass: 73.3 g", "mass: 73.4 g"))
    assert measured_rmse(other, robot, "balanced", depth) is None
    assert measured_rmse(spec, robot.tilted(math.radians(-20)), "balanced", depth) is None
    assert measured_rmse(spec, robot, "balanced", replace(depth, rate=1.0)) is None
    assert measured_rmse(spec, robot, "computed-torque", depth) is None
