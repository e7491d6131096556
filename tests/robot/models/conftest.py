from pathlib import Path

import pytest

from nrs_design.robot.models import build_robot
from nrs_design.spec import RobotSpec, load_spec

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def spec():
    spec = load_spec(ROOT / "specs" / "robots" / "neuroboscope.nrs.yaml")
    assert isinstance(spec, RobotSpec)
    return spec


@pytest.fixture(scope="session")
def robot(spec):
    return build_robot(spec)
