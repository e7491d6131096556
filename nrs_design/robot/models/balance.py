"""Passive balance of the side legs by counter-masses and a spring (thesis 4.4).

Each side leg carries its share of the platform at the end of its arm. One counter-mass brings the
common center of mass of share and arm to the coupler's end, a second one that of all beyond the
elbow to the elbow. The whole leg then weighs as a single mass on the crank, and a spring without
free length between crank and base, anchored vertically above the base joint, holds that mass in
every position.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from numpy.typing import ArrayLike

from nrs_design.errors import DesignError
from nrs_design.robot.models.body import MASSLESS, point_mass
from nrs_design.robot.models.dynamics import gravity_torque
from nrs_design.robot.models.robot import Leg, Robot
from nrs_design.robot.models.vectors import Array
from nrs_design.robot.models.workspace import reachable_poses, workspace_grid
from nrs_design.spec import RobotSpec
from nrs_design.spec.robot import BalancedLegSpec


@dataclass(frozen=True, slots=True)
class LegBalance:
    """Counter-masses and spring of one side leg."""

    # arm_mass, coupler_mass: counter-masses M_c and M_b in kg.
    arm_mass: float
    coupler_mass: float
    # arm_distance, coupler_distance: lever arms of the counter-masses, B_c from the coupler's end
    # and B_b from the elbow, in m.
    arm_distance: float
    coupler_distance: float
    total_mass: float  # M_a, everything that the spring holds, in kg. It is no counter-mass.
    total_distance: float  # B_a, its center of mass on the crank from the base joint, in m
    stiffness: float  # Stiffness of the spring in N/m
    # spring_on_crank, spring_on_base: its ends from the base joint, A0C_A and A0D0, in m.
    spring_on_crank: float
    spring_on_base: float


@dataclass(frozen=True, slots=True)
class Balance:
    """The balance of both side legs, and the tilt of the base that it is made for, in rad."""

    left_leg: LegBalance
    right_leg: LegBalance
    tilt: float


def design_balance(spec: RobotSpec, robot: Robot) -> Balance:
    """Compute the counter-masses and springs of both side legs from the `balance` of the spec."""
    requirement = spec.balance
    if requirement is None:
        raise DesignError("this robot spec has no `balance`", remedy="add it, as `init robot` does")
    left, right = (
        _leg_balance(leg, choice, requirement.payload.si, robot.gravity)
        for leg, choice in ((robot.legs[0], requirement.left), (robot.legs[1], requirement.right))
    )
    return Balance(left, right, requirement.tilt.si)


def _leg_balance(leg: Leg, spec: BalancedLegSpec, payload: float, gravity: float) -> LegBalance:
    m_a, m_b, m_c = leg.crank.mass, leg.coupler.mass, leg.arm.mass
    arm_distance, coupler_distance = spec.arm_counter_arm.si, spec.coupler_counter_arm.si
    M_c = (payload * leg.l3 + m_c * spec.arm_center_of_mass.si) / arm_distance
    carried_mass = payload + m_c + M_c
    M_b = (carried_mass * leg.l2 + leg.coupler.first[0]) / coupler_distance
    M_a = carried_mass + m_b + M_b + m_a
    B_a = ((M_a - m_a) * leg.l1 + leg.crank.first[0]) / M_a
    crank_end, base_end = spec.spring_on_crank.si, spec.spring_on_base.si
    return LegBalance(
        arm_mass=M_c,
        coupler_mass=M_b,
        arm_distance=arm_distance,
        coupler_distance=coupler_distance,
        total_mass=M_a,
        total_distance=B_a,
        stiffness=M_a * gravity * B_a / (crank_end * base_end),
        spring_on_crank=crank_end,
        spring_on_base=base_end,
    )


def balanced_robot(robot: Robot, balance: Balance) -> Robot:
    """Return the robot with its counter-masses, for its full dynamics; without the springs."""
    left, right, middle = robot.legs
    return replace(
        robot, legs=(_weighted(left, balance.left_leg), _weighted(right, balance.right_leg), middle)
    )


def _weighted(leg: Leg, balance: LegBalance) -> Leg:
    coupler_weight = point_mass(balance.coupler_mass, (-balance.coupler_distance, 0.0, 0.0))
    arm_weight = point_mass(balance.arm_mass, (-balance.arm_distance, 0.0, 0.0))
    return replace(leg, coupler=leg.coupler.plus(coupler_weight), arm=leg.arm.plus(arm_weight))


def spring_torque(robot: Robot, balance: Balance, pose: ArrayLike) -> Array:
    """Return the joint torques that it takes to hold the springs, without any weight, in N m.

    A spring acts as a weight does that has its first moment on the crank, and falls upwards. It is
    upright where the base has the tilt that it is made for.
    """
    bare = replace(robot.remove_links(), platform=MASSLESS, gravity=-1.0, base_tilt=balance.tilt)
    left, right, middle = bare.legs
    legs = (_sprung(left, balance.left_leg), _sprung(right, balance.right_leg), middle)
    return gravity_torque(replace(bare, legs=legs), pose)


def _sprung(leg: Leg, spring: LegBalance) -> Leg:
    pull = spring.stiffness * spring.spring_on_crank * spring.spring_on_base
    return replace(leg, crank=replace(MASSLESS, first=(pull, 0.0, 0.0)))


def residual_torque(robot: Robot, balance: Balance, pose: ArrayLike) -> Array:
    """Return the residual static torques of a balanced robot, shape (..., 3), in N m.

    The robot is the one without counter-masses. Weights that the balance does not know of remain:
    the middle leg, the offset of the platform, and its mass less the two payloads.
    """
    weights = gravity_torque(balanced_robot(robot, balance), pose)
    return weights + spring_torque(robot, balance, pose)


def examine_balance(robot: Robot, balance: Balance) -> tuple[Array, Array]:
    """Return the static torques over the reachable workspace without and with balance, in N m.

    Shapes are (n, 3); the base has the tilt that the balance is for.
    """
    tilted_robot = robot.tilted(balance.tilt)
    poses = reachable_poses(robot, workspace_grid(robot, 21, 11))
    return gravity_torque(tilted_robot, poses), residual_torque(tilted_robot, balance, poses)
