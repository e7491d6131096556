import numpy as np
import pytest
from hypothesis import given

from nrs_design.robot.models.geometry import PoseError, is_reachable, posture, reach, reach_margin
from tests.tables import rows

from .strategies import poses

FAR_CORNER = (*np.radians([15, -20]), 0.25)


def test_stretched_side_legs_end_the_workspace(robot):
    # At 15, -20 deg the side legs reach 244.5 mm.
    corner = [[*FAR_CORNER[:2], d] for d in (0.2440, 0.2450)]
    assert is_reachable(robot, corner).tolist() == [True, False]
    assert is_reachable(robot, [[-x, y, d] for x, y, d in corner]).tolist() == [True, False]


def test_unreachable_pose_names_leg_and_excess(robot):
    with pytest.raises(
        PoseError, match=r"psi -20 deg, .* right leg is overstretched by 5\.507 mm .* limit 330 mm"
    ):
        posture(robot, FAR_CORNER)
    assert reach(robot, FAR_CORNER)[1] == pytest.approx(0.335507, abs=1e-6)


def test_folded_leg(robot):
    with pytest.raises(PoseError, match=r"left leg is folded too far by .* limit 60 mm"):
        posture(robot, (0.0, 1.0, 0.1))


def test_the_worst_pose_of_a_batch_is_named(robot):
    with pytest.raises(PoseError, match="phi 0 deg, psi 0 deg, d 900 mm is not reachable"):
        posture(robot, [[0, 0, 0.2], [0, 0, 0.9], [0, 0, 0.35]])


@pytest.mark.parametrize(("pose", "said"), rows(__file__, "test_what_is_no_pose"))
def test_what_is_no_pose(robot, pose, said):
    with pytest.raises(PoseError, match=said):
        posture(robot, pose)


def test_three_numbers_make_a_pose(robot):
    with pytest.raises(ValueError, match=r"shape \(\.\.\., 3\)"):
        posture(robot, (0, 0.2))


@given(pose=poses)
def test_links_keep_their_lengths(robot, pose):
    closed = posture(robot, pose)
    for leg in closed.legs:
        joint = np.array([leg.leg.l0, 0.0])
        elbow = joint + leg.leg.l1 * np.array([leg.cos_beta, leg.sin_beta])
        end = np.array(leg.end)
        assert np.hypot(leg.cos_beta, leg.sin_beta) == pytest.approx(1, abs=1e-13)
        assert np.hypot(*(end - elbow)) == pytest.approx(leg.leg.l2, abs=1e-14)
        # The arm is at a right angle to the endoscope and as long as l3.
        W = np.array([leg.cos_gamma, leg.sin_gamma])
        assert np.hypot(*(end - closed.d * W)) == pytest.approx(leg.leg.l3, abs=1e-14)
        assert (end - closed.d * W) @ W == pytest.approx(0, abs=1e-14)


@given(pose=poses)
def test_plane_holds_base_axis_and_endoscope(robot, pose):
    closed = posture(robot, pose)
    for leg in closed.legs:
        for inside in (leg.leg.axis, closed.W):
            assert np.dot(leg.normal, inside) == pytest.approx(0, abs=1e-14)
        assert np.linalg.norm(leg.normal) == pytest.approx(1)


@given(pose=poses)
def test_margin_says_what_is_reachable(robot, pose):
    assert is_reachable(robot, pose)
    assert np.all(reach_margin(robot, pose) > 0)
    beyond = (*pose[:2], 0.6)
    assert not is_reachable(robot, beyond)
    assert reach_margin(robot, beyond).min() < 0
