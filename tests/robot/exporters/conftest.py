"""Robots that are exported."""

import pytest

from nrs_design.robot.models import build_robot
from nrs_design.robot.pipeline import run_robot_laws
from nrs_design.spec import read_spec
from tests.robot.models.crooked import crooked
from tests.support import ROOT


@pytest.fixture(scope="session")
def loaded():
    """The spec of the thesis robot."""
    return read_spec(ROOT / "specs/robots/neuroboscope.nrs.yaml")


@pytest.fixture(params=["as it is", "tilted", "crooked"])
def robot(request, loaded):
    """The thesis robot, on a tilted base, and one of its family without any symmetry."""
    robot = build_robot(loaded.spec)
    return {"as it is": robot, "tilted": robot.tilted(-0.5), "crooked": crooked(robot)}[
        request.param
    ]


@pytest.fixture(scope="session")
def control_laws(loaded):
    """The laws of motion control of the thesis robot."""
    return run_robot_laws(loaded.spec, build_robot(loaded.spec))
