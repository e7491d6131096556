"""``nrs-design robot bounds`` and ``verify --bounds`` as typed."""

import shutil

import pytest

from tests.support import ROOT
from tests.support import run as run_in

ROBOT = ROOT / "specs/robots/neuroboscope.nrs.yaml"
SPEC = ROOT / "specs/neuroboscope/soft-tissue-axes.nrs.yaml"
CERTIFICATE = ROOT / "reports/soft-tissue-axes.cert.json"


def run(*words):
    return run_in(*words, cwd=ROOT)


@pytest.mark.parametrize("depth", ["150", "240,150", "a,b", "0,1"])
def test_depths_that_are_none(depth):
    result = run("robot", "bounds", ROBOT, "--depth", depth)
    assert result.returncode == 2
    assert "two depths in mm" in result.stderr


def test_an_angle_that_is_none():
    assert run("robot", "bounds", ROBOT, "--phi", "-3").returncode == 2


def test_the_declared_workspace_is_not_reachable():
    result = run("robot", "bounds", ROBOT)
    assert result.returncode not in (0, 1)
    assert "overstretched" in result.stderr


def test_check_refuses_bounds_of_another_robot(tmp_path):
    robot = tmp_path / ROBOT.name
    robot.write_text(ROBOT.read_text().replace("mass: 797.2 g", "mass: 897.2 g"))
    shutil.copy(ROBOT.with_name("neuroboscope.bounds.json"), tmp_path)
    result = run("robot", "bounds", robot, "--check")
    assert result.returncode == 1
    assert "the robot has changed" in result.stdout


def test_verify_says_what_it_takes_for_granted():
    result = run("verify", CERTIFICATE, SPEC)
    assert result.returncode == 0
    assert "taken for granted: the bounds of" in result.stdout


def test_bounds_need_a_spec_with_a_robot():
    result = run("verify", CERTIFICATE, "--bounds")
    assert result.returncode == 2
    assert "needs a SPEC that names a robot" in result.stderr
