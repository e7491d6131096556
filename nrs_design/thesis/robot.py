"""Chapters 3 and 4 about the robot: kinematics, dynamics, correction, balance, tracking."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from math import pi

import numpy as np

from nrs_design.robot.models.balance import LegBalance, design_balance
from nrs_design.robot.models.body import slender_rod
from nrs_design.robot.models.correction import (
    DEPTH_SINES,
    TABLE_3_5,
    WHOLE_WORKSPACE,
    Correction,
    correction_coefficients,
    simplified_dynamics,
)
from nrs_design.robot.models.dynamics import mass_matrix, torque_shares
from nrs_design.robot.models.geometry import direction
from nrs_design.robot.models.kinematics import (
    inverse_jacobian,
    inverse_kinematics,
    orientation,
    orientation_jacobian,
)
from nrs_design.robot.models.robot import Robot, robot, robot_spec
from nrs_design.robot.models.vectors import Array
from nrs_design.robot.models.workspace import joint_peaks, pose_grid, thesis_grid
from nrs_design.spec import RobotSpec
from nrs_design.spec.kinds import LENGTH
from nrs_design.spec.quantity import parse_quantity
from nrs_design.thesis.comparison import Recomputed, Result, printed_rows_of
from nrs_design.thesis.motor import MOTOR

POSE = (0.1, -0.2, 0.2)
_ROUNDING = 1e-12
# In 1/s: both accelerations of the task that 3.3 prints over their speeds.
ACCELERATION_PER_SPEED = 3.7


def robot_kinematics() -> Iterator[Result]:
    """Recompute the crank angle, the orientation and the joint speeds."""
    model = robot()
    yield float(inverse_kinematics(model, POSE)[2])
    space = model.workspace
    poses = pose_grid([0.0], (-space.psi, 0.0, space.psi), np.linspace(*space.d, 101))
    crank = np.degrees(inverse_kinematics(model, poses)[..., 2])
    yield float(crank.min()), float(crank.max())
    yield from _orientation()
    yield from _speeds(model)


def _orientation() -> Iterator[Recomputed]:
    pose, (phi, psi, _) = np.array(POSE), POSE
    W = np.array(direction(pose))
    printed = _pointing(phi, float(np.arcsin(np.sin(psi) / np.cos(phi))))
    x, y, _ = orientation(pose)
    error, misprint = (float(np.abs(z - W).max()) for z in (_pointing(float(x), float(y)), printed))
    yield Recomputed(None, error < _ROUNDING < misprint, (f"{misprint:.2g}",))
    h = 1e-6 * np.eye(3)
    slopes = np.transpose([(orientation(pose + s) - orientation(pose - s)) / 2e-6 for s in h])
    J = orientation_jacobian(pose)
    exchanged = np.abs(J[[1, 0, 2]] - slopes).max()
    yield Recomputed(is_confirmed=bool(np.abs(J - slopes).max() < 1e-8 < exchanged))


def _pointing(x: float, y: float) -> Array:
    """Third column of Rx(x) Ry(y)."""
    return np.array([np.sin(y), -np.sin(x) * np.cos(y), np.cos(x) * np.cos(y)])


def _speeds(model: Robot) -> Iterator[Result]:
    limits, per_speed = model.task_limits, ACCELERATION_PER_SPEED
    yield float(np.degrees(limits.angular_velocity))
    yield per_speed * limits.angular_velocity, 1e3 * per_speed * limits.linear_velocity
    v = np.array([limits.angular_velocity] * 2 + [limits.linear_velocity])
    depths = np.linspace(*model.workspace.d, 1001)
    upright = np.stack([0 * depths, 0 * depths, depths], axis=-1)
    crank = np.abs(inverse_jacobian(model, upright) @ v)[:, 2]
    yield Recomputed(float(crank.min()), facts=(f"{1e3 * depths[crank.argmin()]:.0f}",))
    velocity, acceleration = joint_peaks(model, thesis_grid())
    yield tuple(map(float, velocity))
    largest = ", ".join(f"{value:.2f}" for value in acceleration)
    yield Recomputed(per_speed * 2.0094, facts=(largest,))


def robot_dynamics() -> Iterator[Result]:
    """Recompute torque shares and inertia ratios, and what the place of the platform does."""
    model = robot()
    poses = thesis_grid()
    yield tuple(100 * share for share in torque_shares(model, poses).means)
    # The 36.7 mm of table 3.1, read both ways.
    lateral, axial = (
        float(
            correction_coefficients(
                replace(model, platform=slender_rod(model.platform.mass, place, 0.25, 2)),
                TABLE_3_5[0],
            ).mean_ratio[0]
        )
        for place in ((0.0367, 0.0, 0.010), (0.0, 0.0, 0.0367))
    )
    yield Recomputed((lateral, axial), abs(lateral - 1.8318) < 0.1 * abs(axial - 1.8318))
    right = simplified_dynamics(model, poses).Ms
    printed = simplified_dynamics(model, poses, printed=True).Ms
    scale = np.abs(right).max(axis=(-1, -2), keepdims=True)
    worst = float((np.abs(printed - right) / scale).max())
    yield Recomputed(None, 1e-4 < worst < 1e-2, (f"{100 * worst:.2g}",))
    reflected = 1 / (905**2 * MOTOR.inertia)
    full = float(mass_matrix(model, model.home)[0, 0])
    facts = (f"{full:.4f}", f"{100 * full * reflected:.1f}")
    yield Recomputed(100 * 0.055 * reflected, facts=facts)


# theta4 in deg of tables 3.7 and of 4.19.
TILTS = (-10.0, -28.5, -40.0, -70.0)


def correction() -> Iterator[Recomputed]:
    """Recompute tables 3.5 and 3.7 along slow sines in phase."""
    for sine in TABLE_3_5:
        yield Recomputed(_ratios(correction_coefficients(robot(), sine)))
    found = correction_coefficients(robot(), WHOLE_WORKSPACE)
    yield Recomputed(facts=(_text(found.mean_ratio), _text(found.least_squares)))
    table = [row.printed for row in printed_rows_of("correction") if row.section == "table 3.5"]
    texts = (row.split(", ") if isinstance(row, str) else row for row in table)
    yield Recomputed(tuple(map(float, np.array([*texts], float).mean(axis=0))))
    for degrees in TILTS:
        tilted = robot().tilted(float(np.radians(degrees)))
        depth, angles = (
            _ratios(correction_coefficients(tilted, sines)) for sines in (DEPTH_SINES, TABLE_3_5)
        )
        yield Recomputed(depth[:2])
        yield Recomputed(facts=tuple(f"{found[2]:.3f}" for found in (depth, angles)))


def _ratios(coefficients: Correction) -> tuple[float, ...]:
    return tuple(map(float, coefficients.mean_ratio))


def _text(numbers: object) -> str:
    return ", ".join(f"{number:.4f}" for number in np.ravel(np.asarray(numbers, dtype=float)))


def tracking() -> tuple[float]:
    """Recompute the period of half of the measurements."""
    return (2 * pi / 0.0571,)


# Thesis 4.4: M_c and M_b in g, k in N/mm, of the left and the right leg.
LEFT_LEG, RIGHT_LEG = (843.5, 1301.1, 1.8041), (844.1, 1302.4, 1.5919)
PAYLOAD = 0.4428  # Printed payload of a leg in kg


def passive_balance() -> Iterable[Result]:
    """Recompute counter-masses, springs and the misprinted lengths."""
    spec = robot_spec()
    exact, approximate = (design_balance(one, robot()) for one in (spec, _use_printed_arms(spec)))
    left, right, arm = exact.left_leg, exact.right_leg, robot().legs[0]
    moment = 1e-3 * LEFT_LEG[0] * left.arm_distance - PAYLOAD * arm.l3
    return (
        *_leg(left, approximate.left_leg),
        *_leg(right, approximate.right_leg),
        1e6 * left.arm_mass * left.arm_distance / LEFT_LEG[0],
        1e6 * left.coupler_mass * left.coupler_distance / LEFT_LEG[1],
        left.stiffness * left.spring_on_crank / LEFT_LEG[2],
        right.stiffness * right.spring_on_crank / RIGHT_LEG[2],
        1e3 * moment / arm.arm.mass,
    )


def _leg(exact: LegBalance, approximate: LegBalance) -> Iterator[Recomputed]:
    """Yield masses, distance and spring of a leg, with those for the printed arms as facts."""
    for mass in ("arm_mass", "coupler_mass", "total_mass"):
        approximate_text = f"{1e3 * getattr(approximate, mass):.1f}"
        yield Recomputed(1e3 * getattr(exact, mass), facts=(approximate_text,))
    yield Recomputed(1e3 * exact.total_distance)
    yield Recomputed(1e-3 * exact.stiffness, facts=(f"{1e-3 * approximate.stiffness:.4f}",))


def _use_printed_arms(spec: RobotSpec) -> RobotSpec:
    """Return the spec with the printed 115 and 220 mm in place of the fitted arms."""
    assert spec.balance is not None
    texts = {"arm_counter_arm": "115 mm", "coupler_counter_arm": "220 mm"}
    arms = {name: parse_quantity(text, LENGTH) for name, text in texts.items()}
    left, right = (leg.model_copy(update=arms) for leg in (spec.balance.left, spec.balance.right))
    balance = spec.balance.model_copy(update={"left": left, "right": right})
    return spec.model_copy(update={"balance": balance})
