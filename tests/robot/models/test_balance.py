"""Counter-masses and springs (thesis 4.4)."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.errors import DesignError
from nrs_design.robot.models.balance import design_balance, residual_torque, spring_torque
from nrs_design.robot.models.body import MASSLESS, point_mass, rigid_body
from nrs_design.robot.models.dynamics import gravity_torque
from nrs_design.robot.models.geometry import posture
from nrs_design.robot.models.kinematics import jacobian
from nrs_design.robot.models.workspace import workspace_grid

GRID_DEPTHS = 4


@pytest.fixture(scope="module")
def balance(spec, robot):
    return design_balance(spec, robot)


def grid(robot):
    return 0.95 * (workspace_grid(robot, 5, GRID_DEPTHS).reshape(-1, 3) - robot.home) + robot.home


def ideal(robot, spec, balance):
    """The robot as the balance sees it: payloads on the side arms, and no middle leg."""

    def loaded(leg, choice):
        center = (choice.arm_center_of_mass.si, 0, 0)
        arm = rigid_body(leg.arm.mass, center, leg.arm.inertia)
        return replace(leg, arm=arm.plus(point_mass(spec.balance.payload.si, (leg.l3, 0, 0))))

    left, right, middle = robot.legs
    bare = replace(middle, crank=MASSLESS, coupler=MASSLESS, arm=MASSLESS)
    legs = (loaded(left, spec.balance.left), loaded(right, spec.balance.right), bare)
    return replace(robot, legs=legs, platform=MASSLESS, base_tilt=balance.tilt)


def test_what_the_balance_knows_of_is_balanced_everywhere(robot, spec, balance):
    known = ideal(robot, spec, balance)
    assert np.abs(gravity_torque(known, grid(robot))).max() > 3
    assert np.abs(residual_torque(known, balance, grid(robot))).max() < 1e-12


def test_another_tilt_is_not_balanced(robot, spec, balance):
    level = ideal(robot, spec, balance).tilted(0.0)
    assert np.abs(residual_torque(level, balance, grid(robot))).max() > 0.5


def test_spring_torque_is_the_slope_of_its_energy(robot, balance):
    pose, h = np.array([0.1, -0.2, 0.21]), 1e-6
    up = np.array([-np.sin(balance.tilt), 0, np.cos(balance.tilt)])

    def energy(x):
        closed, total = posture(robot, x), 0.0
        for leg, spring in zip(closed.legs, (balance.left_leg, balance.right_leg), strict=False):
            a = np.array(leg.leg.axis)
            b = np.cross(leg.normal, a)
            crank = spring.spring_on_crank * (leg.cos_beta * a + leg.sin_beta * b)
            total += spring.stiffness * np.sum((crank - spring.spring_on_base * up) ** 2) / 2
        return total

    slopes = [
        (energy(pose + h * column) - energy(pose - h * column)) / (2 * h)
        for column in jacobian(robot, pose).T
    ]
    assert spring_torque(robot, balance, pose) == pytest.approx(slopes, abs=1e-6)


def test_a_spec_without_balance(robot, spec):
    with pytest.raises(DesignError, match="no `balance`"):
        design_balance(spec.model_copy(update={"balance": None}), robot)
