"""Designs that are certified once for all tests of exports."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.exporters.export import Execution, export_design
from nrs_design.models.robot import build_robot
from nrs_design.models.robot.body import rigid_body
from nrs_design.spec import read_spec
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


def crooked(robot):
    rng = np.random.default_rng(5)

    def body(mass):
        root = rng.normal(0, 0.02, (3, 3))
        second = root @ root.T
        return rigid_body(mass, rng.normal(0, 0.05, 3), np.trace(second) * np.eye(3) - second)

    changes = [
        {"azimuth": -0.9, "l0": 0.21, "l1": 0.14, "l2": 0.2},
        {"azimuth": 0.7, "l0": 0.19, "l3": 0.19},
        {"azimuth": 0.1, "l1": 0.13, "l3": 0.205},
    ]
    legs = tuple(
        replace(leg, crank=body(0.1), coupler=body(0.2), arm=body(0.3), axis_inertia=1e-3, **change)
        for leg, change in zip(robot.legs, changes, strict=True)
    )
    return replace(robot, legs=legs, platform=body(0.8), base_tilt=-0.5)
