from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from nrs_design.robot.controllers import JointReference, LawState, LoadModel
from nrs_design.robot.design.motion_control import design_independent_joint
from nrs_design.robot.models import (
    design_balance,
    direct_kinematics,
    gravity_torque,
    inverse_kinematics,
    mass_matrix,
    potential_energy,
    residual_torque,
)
from nrs_design.robot.models.body import MASSLESS
from nrs_design.robot.simulation.tracking import DriveArrays, JointState, Mechanism, Stepper

HOME = np.array([[0.02, -0.05, 0.2]])


def at_rest(robot, pose=HOME):
    position = inverse_kinematics(robot, pose)
    return JointState(position, np.zeros_like(position), np.zeros_like(position))


class Weightless:
    """Three rotors that nothing loads."""

    def mass_and_bias(self, position, velocity):
        return np.zeros((*position.shape, 3)), np.zeros_like(position)


def settle(spec, mechanism, drive, law, state, wanted, duration, period=2e-3):
    """Run a law on one robot with a constant reference and perfect encoders."""
    memory = LawState()
    reference = JointReference(wanted, np.zeros_like(wanted), np.zeros_like(wanted))
    for _ in range(round(duration / period)):
        command, memory = law.step(memory, reference, law.encoder_ratio * state.position)
        mass, bias = mechanism.mass_and_bias(state.position, state.velocity)
        state = Stepper.at(DriveArrays.of([drive]), period, mass, bias).step(state, command)
    return state


def test_step_response_of_the_linear_loop(spec, smooth):
    # Thesis 6.1 with all digits, G = (0.9974 s + 56.822)/(0.0351 s^2 + 1.9974 s + 56.822), poles
    # -28.453 +- 28.448j: the answer to a step of the reference, by partial fractions.
    period = 5e-5
    law = replace(design_independent_joint(spec, None), period=period)
    held = JointReference(*np.zeros((3, 1, 3)))
    memory = law.step(LawState(), held, np.zeros((1, 3)))[1]
    state = JointState(*np.zeros((3, 1, 3)))
    reference = JointReference(np.ones((1, 3)), *np.zeros((2, 1, 3)))
    stepper = Stepper.at(
        DriveArrays.of([smooth]), period, *Weightless().mass_and_bias(state.position, None)
    )
    trace = []
    for _ in range(round(0.3 / period)):
        trace.append(state.position[0])
        command, memory = law.step(memory, reference, law.encoder_ratio * state.position)
        state = stepper.step(state, command)
    time = period * np.arange(len(trace))
    poles = np.roots([0.0351, 1.9974202, 56.8219])
    assert poles[0] == pytest.approx(-28.453 + 28.448j, rel=1e-3)
    residues = [
        (0.9974302 * p + 56.8219) / (p * 0.0351 * (p - other)) for p, other in (poles, poles[::-1])
    ]
    exact = 1 + sum(r * np.exp(p * time) for r, p in zip(residues, poles, strict=True)).real
    assert np.array(trace) == pytest.approx(np.tile(exact, (3, 1)).T, abs=3e-3)
    # The overshoot of this loop is 6.8 %, not the 4.3 % of its damping ratio.
    assert np.max(trace) == pytest.approx(1.068, abs=2e-3)


@pytest.mark.slow
def test_without_feed_forward_the_weight_deflects_the_joints(spec, robot, smooth):
    mechanism, law = Mechanism(robot), design_independent_joint(spec, None)
    start = at_rest(robot)
    end = settle(spec, mechanism, smooth, law, start, start.position, 1.0)
    weight = gravity_torque(robot, direct_kinematics(robot, end.position))
    per_rad = smooth.torque_per_command * float(law.motion.Kp) * smooth.encoder_ratio
    assert start.position - end.position == pytest.approx(weight / per_rad, rel=1e-4)
    assert np.abs(end.position - start.position).max() > 1e-3


@pytest.mark.slow
def test_exact_feed_forward_leaves_no_error(spec, robot, smooth):
    mechanism = Mechanism(robot)
    law = design_independent_joint(spec, LoadModel(robot, smooth.encoder_ratio, None))
    start = at_rest(robot)
    wanted = start.position + 0.01
    end = settle(spec, mechanism, smooth, law, start, wanted, 1.0)
    assert end.position == pytest.approx(wanted, abs=1e-9)


def test_friction_holds_what_is_within_its_limit(robot, drive):
    # The weight less the torque of the drive is within the friction for the first robot only.
    poses = np.repeat(HOME, 2, axis=0)
    weight = gravity_torque(robot, poses)
    missing = np.array([[0.99], [1.01]]) * drive.friction_torque
    command = (weight - missing) / drive.torque_per_command
    state = at_rest(robot, poses)
    stepper = Stepper.at(
        DriveArrays.of([drive, drive]),
        1e-3,
        *Mechanism(robot).mass_and_bias(state.position, state.velocity),
    )
    for _ in range(20):
        state = stepper.step(state, command)
    assert np.all(state.velocity[0] == 0)
    assert state.friction[0] == pytest.approx(-missing[0] * np.ones(3), rel=1e-9)
    assert np.all(state.velocity[1] < 0)


def test_a_joint_that_stops_stays_without_chatter(drive):
    # Thrown at 0.1 rad/s without a command, the rotor comes to rest as J w' = -damping w - F says.
    stop = drive.inertia / drive.damping * np.log1p(0.1 * drive.damping / drive.friction_torque)
    state = JointState(np.zeros((1, 3)), np.full((1, 3), 0.1), np.zeros((1, 3)))
    h = 1e-3
    stepper = Stepper.at(DriveArrays.of([drive]), h, np.zeros((1, 3, 3)), np.zeros((1, 3)))
    speeds = []
    for _ in range(200):
        state = stepper.step(state, np.zeros((1, 3)))
        speeds.append(state.velocity[0, 0])
    moving = np.count_nonzero(speeds)
    assert moving * h == pytest.approx(stop, abs=1.5 * h)
    assert min(speeds) == 0.0
    assert not np.any(speeds[moving:])


@pytest.mark.slow
def test_agrees_with_an_independent_integrator(robot, smooth):
    # DOP853 on the same equation, without friction; the weight is held by half of its command.
    mechanism, start = Mechanism(robot), at_rest(robot)
    command = gravity_torque(robot, HOME) / smooth.torque_per_command / 2 + [[400.0, 0.0, -300.0]]

    def slope(time, y):
        mass, bias = mechanism.mass_and_bias(y[None, :3], y[None, 3:])
        torque = smooth.torque_per_command * command - bias - smooth.damping * y[3:]
        total = mass[0] + smooth.inertia * np.eye(3)
        return np.concatenate([y[3:], np.linalg.solve(total, torque[0])])

    exact = solve_ivp(
        slope,
        (0, 0.1),
        np.concatenate([start.position[0], np.zeros(3)]),
        method="DOP853",
        rtol=1e-10,
        atol=1e-12,
    ).y[:3, -1]
    moved = np.abs(exact - start.position[0]).max()
    errors = []
    for h in (2e-3, 1e-3):
        state = start
        for _ in range(round(0.1 / h)):
            matrices = mechanism.mass_and_bias(state.position, state.velocity)
            state = Stepper.at(DriveArrays.of([smooth]), h, *matrices).step(state, command)
        errors.append(np.abs(state.position[0] - exact).max())
    assert errors[0] < 1e-3 * moved
    assert errors[1] < 0.6 * errors[0]


def energy_error(robot, drive, h):
    """Change of energy less work of the drives and losses, and the sum of their magnitudes."""
    mechanism, drives = Mechanism(robot), DriveArrays.of([drive])
    state = at_rest(robot)
    before = energy(mechanism, drive, state)
    work = losses = effort = 0.0
    for index in range(round(0.4 / h)):
        time = h * (index + 0.5)
        command = 2500 * np.sin(9 * time + np.array([[0.0, 0.8, 2.0]]))
        command += gravity_torque(robot, HOME) / drive.torque_per_command
        mass, bias = mechanism.mass_and_bias(state.position, state.velocity)
        after = Stepper.at(drives, h, mass, bias).step(state, command)
        mean = (state.velocity + after.velocity) / 2
        power = drive.torque_per_command * np.sum(command * mean)
        loss = drive.damping * np.sum(mean * mean) + np.sum(after.friction * mean)
        work, losses, effort = work + h * power, losses + h * loss, effort + h * abs(power)
        state = after
    assert np.all(np.abs(state.position - at_rest(robot).position) > 1e-3)
    return abs(energy(mechanism, drive, state) - before - work + losses), effort, losses


def energy(mechanism, drive, state):
    pose, v = direct_kinematics(mechanism.robot, state.position)[0], state.velocity[0]
    inertia = mass_matrix(mechanism.robot, pose) + drive.inertia * np.eye(3)
    return v @ inertia @ v / 2 + potential_energy(mechanism.robot, pose)


@pytest.mark.slow
def test_energy_balance(robot, drive):
    # What the drives put in is motion, height, heat in the motors and heat of the friction.
    errors = []
    for h in (4e-3, 2e-3, 1e-3):
        error, effort, losses = energy_error(robot, drive, h)
        errors.append(error)
        assert losses > 0.1 * effort
    assert errors[-1] < 2e-4 * effort
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.6)
    assert errors[1] / errors[2] == pytest.approx(2, abs=0.4)


def test_energy_is_exact_while_the_matrices_hold(drive):
    drives, h = DriveArrays.of([drive]), 2e-3
    mass = np.array([[[0.2, 0.05, 0.01], [0.05, 0.15, 0.02], [0.01, 0.02, 0.1]]])
    bias = np.array([[1.0, -0.5, 0.3]])
    state = JointState(np.zeros((1, 3)), np.array([[0.1, -0.2, 0.05]]), np.zeros((1, 3)))
    after = Stepper.at(drives, h, mass, bias).step(state, np.array([[900.0, 100.0, -800.0]]))
    inertia = mass[0] + drive.inertia * np.eye(3)
    kinetic = [s.velocity[0] @ inertia @ s.velocity[0] / 2 for s in (state, after)]
    mean = (state.velocity + after.velocity)[0] / 2
    torque = drive.torque_per_command * np.array([900.0, 100.0, -800.0]) - bias[0]
    power = mean @ (torque - drive.damping * mean - after.friction[0])
    assert kinetic[1] - kinetic[0] == pytest.approx(h * power, rel=1e-9)


def test_balanced_mechanism_has_counter_masses_and_springs(spec, robot):
    balance = design_balance(spec, robot)
    mechanism = Mechanism.balanced(robot, balance)
    position = inverse_kinematics(robot, HOME)
    mass, bias = mechanism.mass_and_bias(position, np.zeros((1, 3)))
    assert bias == pytest.approx(residual_torque(robot, balance, HOME), abs=1e-12)
    assert np.all(np.linalg.eigvalsh(mass - mass_matrix(robot, HOME)) > 0)


def test_massless_robot_is_the_motor(robot, drive):
    bare = replace(robot.without_links(), platform=MASSLESS)
    mass, bias = Mechanism(bare).mass_and_bias(inverse_kinematics(bare, HOME), np.ones((1, 3)))
    assert not np.any(mass)
    assert not np.any(bias)
    stepper = Stepper.at(DriveArrays.of([drive]), 1e-3, mass, bias)
    assert stepper.mass[0] == pytest.approx(905**2 * 14.81e-7 * np.eye(3), rel=1e-12)
