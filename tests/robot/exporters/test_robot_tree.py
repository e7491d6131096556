"""What robots have in common, whatever the format."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

from nrs_design.errors import PoseError
from nrs_design.exporters import ROBOT_FORMATS
from nrs_design.robot.exporters.robot_tree import RobotExport, home_joints, xml_comment
from nrs_design.robot.models import inverse_kinematics, joint_names, links_of, tree_angles
from tests.robot.exporters.robots import POSES


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["crooked"], indirect=True)
@pytest.mark.parametrize("name", ROBOT_FORMATS)
def test_every_format_begins_as_the_table_says(name, robot, loaded):
    format_ = ROBOT_FORMATS[name]
    render = import_module(f"nrs_design.robot.exporters.{name}").render
    files = render(RobotExport(loaded, robot, "a.nrs.yaml"))
    assert set(files) == set(format_.files)
    for ending, content in files.items():
        assert content.startswith(format_.files[ending])
    assert render(RobotExport(loaded, robot, "a.nrs.yaml")) == files


def test_driven_joints_are_those_of_the_kinematics(robot):
    for pose in POSES:
        angles = dict(zip(joint_names(robot), tree_angles(robot, pose), strict=True))
        driven = [angles[name] for name in ("left_plane", "right_plane", "middle_crank")]
        assert driven == pytest.approx(inverse_kinematics(robot, pose), abs=1e-12)
    assert home_joints(robot) == pytest.approx(inverse_kinematics(robot, robot.home))


def test_all_mass_is_there(robot):
    links = [link for leg in robot.legs for link in links_of(robot, leg)]
    assert sum(link.mass for link in links) == pytest.approx(robot.moving_mass)
    assert min(np.linalg.eigvalsh(link.inertia)[0] for link in links) > -1e-12


def test_a_pose_out_of_reach_has_no_angles(robot):
    with pytest.raises(PoseError, match="not reachable"):
        tree_angles(robot, (0.0, 0.0, 0.9))


def test_a_name_does_not_end_the_comment(loaded, robot):
    spec = loaded.spec.model_copy(update={"name": "a--b"})
    text = xml_comment(
        RobotExport(replace(loaded, spec=spec), robot, "a.nrs.yaml"), "mjcf", ["x --> y"]
    )
    assert text.count("--") == 2
    assert text.startswith("<!-- nrs-design mjcf of a- -b")
