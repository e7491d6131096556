"""What several commands for the robot read: three numbers, and poses in rad and m."""

import pytest
import typer

from nrs_design.robot.cli.options import read_pose, three_numbers
from nrs_design.robot.models.geometry import PoseError
from tests.tables import rows


def test_three_numbers():
    assert three_numbers("0.1,-2e-1, 3", "--pose") == (0.1, -0.2, 3.0)


@pytest.mark.parametrize("text", ["", "1,2", "1,2,3,4", "1;2;3", "1,2,x", "1,2,nan", "inf,0,0"])
def test_what_is_not_three_numbers(text):
    with pytest.raises(typer.BadParameter, match="not three numbers") as caught:
        three_numbers(text, "--velocity")
    assert caught.value.param_hint == "--velocity"


def test_a_pose_up_to_a_right_angle(robot):
    assert read_pose("1.57,-1.57,0.2", robot) == (1.57, -1.57, 0.2)


@pytest.mark.parametrize(
    ("text", "said", "remedy"),
    rows(__file__, "test_other_units_are_doubted_with_the_number_that_is_meant"),
)
def test_other_units_are_doubted_with_the_number_that_is_meant(robot, text, said, remedy):
    with pytest.raises(PoseError, match=said) as caught:
        read_pose(text, robot)
    assert remedy in caught.value.remedy
