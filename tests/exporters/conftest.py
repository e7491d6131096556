"""Designs that are certified once for all tests of exports."""

import pytest

from nrs_design.exporters.export import Execution, export_design
from nrs_design.robot.models import build_robot
from nrs_design.robot.pipeline import run_robot_laws
from nrs_design.spec import read_spec
from tests.robot.models.crooked import crooked
from tests.support import ROOT

CONTINUOUS = ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml"


@pytest.fixture(scope="session")
def continuous():
    """Insertion and withdrawal in continuous time."""
    return read_spec(CONTINUOUS)


@pytest.fixture(scope="session")
def sampled(tmp_path_factory):
    """Insertion alone, every 2 ms, with a force sample of any of two ages."""
    head, _, _ = CONTINUOUS.read_text().partition("  withdrawal:")
    file = tmp_path_factory.mktemp("specs") / "sampled.nrs.yaml"
    file.write_text(f"{head}switching: arbitrary\nsampling: {{period: 2 ms, delay: [0, 1]}}\n")
    return read_spec(file)


@pytest.fixture(scope="session")
def continuous_export(continuous):
    return export_design(continuous)


@pytest.fixture
def record(continuous_export):
    return continuous_export.record


@pytest.fixture(scope="session")
def sampled_export(sampled):
    return export_design(sampled, execution=Execution())


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
