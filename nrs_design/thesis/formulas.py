"""Prints without a number: formulas that are wrong or missing, and some that are right."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction

import numpy as np

from nrs_design.design.root_locus import motion_loop_response
from nrs_design.design.transfer import TransferFunction
from nrs_design.loop.modes import Rows
from nrs_design.models.motion_loop import close_motion_loop
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable
from nrs_design.robot.models.dynamics import gravity_torque, potential_energy
from nrs_design.robot.models.geometry import direction
from nrs_design.robot.models.kinematics import inverse_kinematics
from nrs_design.robot.models.robot import robot, robot_spec
from nrs_design.robot.models.vectors import Array
from nrs_design.search.balance import own_norms
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Result
from nrs_design.thesis.motor import MOTOR, armature_resistance, speed_torque_gradient, voltage_gain
from nrs_design.thesis.switching import family, impedance_rows, printed_rows

# A pose in rad and m, and rates of it in 1/s and m/s; any would do.
_POSE, _RATE = np.array((0.1, -0.2, 0.2)), np.array((0.3, -0.2, 0.05))
_STEP = 1e-5


def formulas() -> Iterable[Result]:
    """Check formulas that are wrong or missing, and some of chapters 2.3 and 5 that are right."""
    return (check() for check in CHECKS.values())


def _safe_speed() -> bool:
    varpi, v = 3.0, 0.5
    share = varpi * v**2.5 / varpi
    return math.isclose(share ** (1 / 2.5), v) and not math.isclose(share, v, rel_tol=0.1)


def _normals() -> bool:
    theta1, theta2, _ = inverse_kinematics(robot(), _POSE)
    half = math.sqrt(0.5)
    n1 = (half * math.cos(theta1), half * math.cos(theta1), math.sin(theta1))
    n2 = (-half * math.cos(theta2), half * math.cos(theta2), math.sin(theta2))
    W = np.cross(n1, n2)
    return bool(np.allclose(W / np.linalg.norm(W), direction(_POSE), atol=1e-12))


def _generalized_coordinates() -> bool:
    ahead, previous = _POSE + _STEP * _RATE, _POSE - _STEP * _RATE
    energies = (float(potential_energy(robot(), pose)) for pose in (ahead, previous))
    power = (next(energies) - next(energies)) / (2 * _STEP)
    rates = (inverse_kinematics(robot(), ahead) - inverse_kinematics(robot(), previous)) / 2 / _STEP
    # With the printed q_a the power would be zero at constant rates.
    return abs(power) > 0.1 and math.isclose(
        float(gravity_torque(robot(), _POSE) @ rates), power, rel_tol=1e-6
    )


def _centripetal() -> bool:
    rate, arm = np.array((0.0, 0.0, 2.0)), np.array((0.1, 0.0, 0.0))

    def place(t: float) -> Array:
        return 0.1 * np.array((math.cos(2 * t), math.sin(2 * t), 0.0))

    h = 1e-4
    found = (place(h) - 2 * place(0.0) + place(-h)) / h**2
    right, printed = np.cross(rate, np.cross(rate, arm)), np.cross(rate, arm)
    return bool(np.abs(found - right).max() < 1e-5 < np.abs(found - printed).max())


def _armature() -> bool:
    motor = MOTOR
    K_T, K_B = motor.torque_constant, motor.back_emf_constant
    R = armature_resistance(thesis.ACTUATOR, motor)
    friction = K_T / voltage_gain(thesis.ACTUATOR, motor) - K_T * K_B
    right, printed = (R * motor.inertia / (friction + sign * K_T * K_B) for sign in (1, -1))
    target = float(thesis.ACTUATOR.time_constant)
    return math.isclose(right, target, rel_tol=1e-3) and printed < 0 < friction


def _wanted_acceleration() -> bool:
    wn = 4 / thesis.SETTLING_TIME / thesis.DAMPING_RATIO
    Kp, Kd = wn**2, 2 * thesis.DAMPING_RATIO * wn
    right, printed = np.roots((1.0, Kd, Kp)), np.roots((Kd, Kp))
    ratios = -right.real / np.abs(right)
    return bool(np.allclose(ratios, thesis.DAMPING_RATIO) and len(printed) < len(right))


def _reflected_inertia() -> bool:
    drive = robot_spec().drive
    assert drive is not None
    return drive.gearhead_ratio * drive.capstan_ratio == 905 and drive.capstan_ratio == 5


def _speed_command() -> bool:
    gradient = speed_torque_gradient(armature_resistance(thesis.ACTUATOR, MOTOR), MOTOR)
    # rad/s per rpm is in the gain of the actuator: the gradient alone makes the difference.
    right, printed = _damping(Fraction(1)), _damping(Fraction(gradient))
    return abs(right - thesis.DAMPING_RATIO) < 1e-3 and printed > 2 * thesis.DAMPING_RATIO


def _damping(factor: Fraction) -> float:
    Kd = factor * thesis.DERIVATIVE_GAIN
    loop = close_motion_loop(thesis.ACTUATOR, Kp=Kd * thesis.ZERO, Kd=Kd)
    numerator, denominator = tuple(map(float, loop.numerator)), tuple(map(float, loop.denominator))
    return motion_loop_response(TransferFunction(numerator, denominator)).damping_ratio


def _integrator() -> bool:
    tau = float(thesis.ACTUATOR.time_constant)
    target = 4 / thesis.SETTLING_TIME * complex(-1, math.tan(math.acos(thesis.DAMPING_RATIO)))
    lag = np.angle(target + 1 / tau)
    right, printed = (np.degrees(lag + angle - np.pi) for angle in (np.angle(target), 0.0))
    return bool(abs(right - 44.9914) < 5e-3 < abs(printed - 44.9914))


def _decay() -> bool:
    mode = printed_rows("-215", ("70183.13", "1231.97"))
    A = np.array(mode, dtype=float)
    eta = float(np.linalg.eigvalsh(A.T + A)[-1])
    return eta > 0 and not _is_stable(mode)


def _update() -> bool:
    A = np.array(impedance_rows(thesis.SOFT, "0.01", "2.15", "force"), dtype=float)
    # Half of the Q of 5.21: the printed rule makes no update here, though 5.21 does not hold.
    Q = own_norms(A[None], Time.CONTINUOUS)[0] / 2
    v = float(np.linalg.eigvalsh(A.T @ Q + Q @ A + np.eye(4))[-1])
    return 0 < v < 1


def _input_of_admittance() -> bool:
    right = impedance_rows(thesis.SOFT, "0.01", "2.15", "force")
    printed = [*right[:2], [*right[2][:3], -right[2][3]], right[3]]
    return _is_stable(right) and not _is_stable(printed)


def _is_stable(mode: Rows) -> bool:
    system = family("mode", mode)
    return is_stable(system.modes[0].A, system.time)


def _collision() -> bool:
    M, m, k, v = 3.0, 5.0, 2e4, 0.7
    omega = math.sqrt(k * (M + m) / (M * m))
    t = np.linspace(0, math.pi / omega, 20_001)
    acceleration = v * omega * M / (M + m) * np.sin(omega * t)
    mean = float(np.trapezoid(acceleration, t)) / t[-1]
    printed = 2 * (2 / math.pi) ** 1.5 * (k / m) ** 0.75 * (M / (M + m)) ** 1.75 * v**2.5
    return math.isclose(t[-1] * mean**2.5, printed, rel_tol=1e-6)


def _gradient() -> bool:
    A = np.array(impedance_rows(thesis.SOFT, "0.01", "2.15", "force"), dtype=float) / 100
    Q = np.diag((1.0, 2.0, 3.0, 4.0))

    def v(Q: Array) -> float:
        return float(np.linalg.eigvalsh(A.T @ Q + Q @ A + np.eye(4))[-1])

    x = np.linalg.eigh(A.T @ Q + Q @ A + np.eye(4))[1][:, -1]
    printed = A @ np.outer(x, x) + np.outer(x, x) @ A.T
    unit = np.eye(4)
    # Symmetric unit changes of two opposite entries, or of a diagonal entry.
    changes = [np.maximum(e := np.outer(a, b), e.T) for a in unit for b in unit]
    slopes = [(v(Q + 1e-6 * change) - v(Q - 1e-6 * change)) / 2e-6 for change in changes]
    return bool(np.allclose(slopes, [(printed * change).sum() for change in changes], atol=1e-3))


def _order() -> bool:
    return [i - 3 * (i // 3) + 1 for i in range(6)] == [1, 2, 3, 1, 2, 3]


# By equation, in the order of the rows.
CHECKS: Mapping[str, Callable[[], bool]] = {
    "2.17": _safe_speed,
    "3.1": _normals,
    "3.18": _generalized_coordinates,
    "3.26": _centripetal,
    "4.1": _armature,
    "4.16": _wanted_acceleration,
    "4.18": _reflected_inertia,
    "4.24": _speed_command,
    "4.25": _integrator,
    "5.18": _decay,
    "5.24": _update,
    "6.21": _input_of_admittance,
    "2.15": _collision,
    "5.26": _order,
    "5.28": _gradient,
}
