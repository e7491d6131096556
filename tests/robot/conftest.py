"""The robot of the thesis, on a level base and on that of its experiments."""

from dataclasses import replace

import pytest

from nrs_design.robot.design.motion_control import design_load_model
from nrs_design.robot.models.drive import build_drive
from nrs_design.robot.models.robot import build_robot
from nrs_design.robot.simulation.track import experiment_tilt
from nrs_design.spec import parse_spec
from nrs_design.spec.templates import TEMPLATES


@pytest.fixture(scope="session")
def spec():
    return parse_spec(TEMPLATES["robot"])


@pytest.fixture(scope="session")
def robot(spec):
    return build_robot(spec)


@pytest.fixture(scope="session")
def tilted(spec, robot):
    return robot.tilted(experiment_tilt(spec))


@pytest.fixture(scope="session")
def load(spec, tilted):
    return design_load_model(spec, tilted)


@pytest.fixture(scope="session")
def drive(spec):
    return build_drive(spec.drive)


@pytest.fixture(scope="session")
def smooth(drive):
    return replace(drive, friction=0.0)
