from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.integrate import solve_ivp

from nrs_design.robot.design.motion_control import (
    LawState,
    LoadModel,
    LoadTerms,
    design_independent_joint,
)
from nrs_design.robot.models.balance import balanced_robot, design_balance, residual_torque
from nrs_design.robot.models.body import MASSLESS
from nrs_design.robot.models.dynamics import gravity_torque, mass_and_bias, mass_matrix
from nrs_design.robot.models.kinematics import JointMotion, direct_kinematics, inverse_kinematics
from nrs_design.robot.simulation.plant import (
    JointState,
    Mechanism,
    Stepper,
    batch_of,
    slide_or_stick,
)

HOME = np.array([[0.02, -0.05, 0.2]])


def at_rest(tilted, pose=HOME):
    position = inverse_kinematics(tilted, pose)
    return JointState(position, np.zeros_like(position), np.zeros_like(position))


class Weightless:
    """Three rotors that nothing loads."""

    def mass_and_bias(self, position, velocity):
        return np.zeros((*position.shape, 3)), np.zeros_like(position)


def test_step_response_of_the_linear_loop(spec, smooth):
    # Thesis 6.1 with all digits, G = (0.9974 s + 56.822)/(0.0351 s^2 + 1.9974 s + 56.822), poles
    # -28.453 +- 28.448j: the answer to a step of the reference, by partial fractions.
    period = 5e-5
    law = replace(design_independent_joint(spec, None), period=period)
    held = JointMotion(*np.zeros((3, 1, 3)))
    memory = law.step(LawState(), held, np.zeros((1, 3)))[1]
    state = JointState(*np.zeros((3, 1, 3)))
    reference = JointMotion(np.ones((1, 3)), *np.zeros((2, 1, 3)))
    stepper = Stepper.create(
        batch_of([smooth]), period, *Weightless().mass_and_bias(state.position, None)
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


class ExactLoad(LoadModel):
    """The plant's own mass and weight in the place of the simplified ones."""

    def terms(self, angle):
        pose = direct_kinematics(self.robot, angle / self.encoder_ratio)
        return LoadTerms(angle, *mass_and_bias(self.robot, pose, np.zeros_like(pose)))


@pytest.mark.slow
@pytest.mark.parametrize("fed", [False, True], ids=["without", "exact"])
def test_the_weight_deflects_the_joints_unless_it_is_fed_forward(spec, tilted, smooth, fed):
    known = ExactLoad(tilted, smooth.encoder_ratio, (1.0, 1.0, 1.0)) if fed else None
    law, mechanism = design_independent_joint(spec, known), Mechanism(tilted)
    state, memory = at_rest(tilted), LawState()
    wanted = state.position + 0.01
    reference = JointMotion(wanted, *np.zeros((2, 1, 3)))
    for _ in range(500):
        command, memory = law.step(memory, reference, law.encoder_ratio * state.position)
        matrices = mechanism.mass_and_bias(state.position, state.velocity)
        state = Stepper.create(batch_of([smooth]), law.period, *matrices).step(state, command)
    weight = gravity_torque(tilted, direct_kinematics(tilted, state.position))
    per_rad = smooth.torque_per_command * float(law.motion.Kp) * smooth.encoder_ratio
    left = 0 * weight if fed else weight / per_rad
    assert wanted - state.position == pytest.approx(left, rel=1e-4, abs=1e-9)
    assert np.abs(weight / per_rad).max() > 1e-3


def test_friction_holds_what_is_within_its_limit(tilted, drive):
    # The weight less the torque of the drive is within the friction for the first robot only.
    poses = np.repeat(HOME, 2, axis=0)
    weight = gravity_torque(tilted, poses)
    missing = np.array([[0.99], [1.01]]) * drive.friction
    command = (weight - missing) / drive.torque_per_command
    state = at_rest(tilted, poses)
    stepper = Stepper.create(
        batch_of([drive, drive]),
        1e-3,
        *Mechanism(tilted).mass_and_bias(state.position, state.velocity),
    )
    for _ in range(20):
        state = stepper.step(state, command)
    assert np.all(state.velocity[0] == 0)
    assert state.friction[0] == pytest.approx(-missing[0] * np.ones(3), rel=1e-9)
    assert np.all(state.velocity[1] < 0)


def test_a_joint_that_stops_stays_without_chatter(drive):
    # Thrown at 0.1 rad/s without a command, the rotor comes to rest as J w' = -damping w - F says.
    stop = drive.inertia / drive.damping * np.log1p(0.1 * drive.damping / drive.friction)
    state = JointState(np.zeros((1, 3)), np.full((1, 3), 0.1), np.zeros((1, 3)))
    h = 1e-3
    stepper = Stepper.create(batch_of([drive]), h, np.zeros((1, 3, 3)), np.zeros((1, 3)))
    speeds = []
    for _ in range(200):
        state = stepper.step(state, np.zeros((1, 3)))
        speeds.append(state.velocity[0, 0])
    moving = np.count_nonzero(speeds)
    assert moving * h == pytest.approx(stop, abs=1.5 * h)
    assert min(speeds) == 0.0
    assert not np.any(speeds[moving:])


@pytest.mark.slow
def test_agrees_with_an_independent_integrator(tilted, smooth):
    # DOP853 on the same equation, without friction; the weight is held by half of its command.
    mechanism, start = Mechanism(tilted), at_rest(tilted)
    command = gravity_torque(tilted, HOME) / smooth.torque_per_command / 2 + [[400.0, 0.0, -300.0]]

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
            state = Stepper.create(batch_of([smooth]), h, *matrices).step(state, command)
        errors.append(np.abs(state.position[0] - exact).max())
    assert errors[0] < 1e-3 * moved
    assert errors[1] < 0.6 * errors[0]


def test_energy_is_exact_while_the_matrices_hold(drive):
    drives, h = batch_of([drive]), 2e-3
    mass = np.array([[[0.2, 0.05, 0.01], [0.05, 0.15, 0.02], [0.01, 0.02, 0.1]]])
    bias = np.array([[1.0, -0.5, 0.3]])
    state = JointState(np.zeros((1, 3)), np.array([[0.1, -0.2, 0.05]]), np.zeros((1, 3)))
    after = Stepper.create(drives, h, mass, bias).step(state, np.array([[900.0, 100.0, -800.0]]))
    inertia = mass[0] + drive.inertia * np.eye(3)
    kinetic = [s.velocity[0] @ inertia @ s.velocity[0] / 2 for s in (state, after)]
    mean = (state.velocity + after.velocity)[0] / 2
    torque = drive.torque_per_command * np.array([900.0, 100.0, -800.0]) - bias[0]
    power = mean @ (torque - drive.damping * mean - after.friction[0])
    assert kinetic[1] - kinetic[0] == pytest.approx(h * power, rel=1e-9)


def test_balanced_mechanism_has_counter_masses_and_springs(spec, tilted):
    balance = design_balance(spec, tilted)
    mechanism = Mechanism(balanced_robot(tilted, balance), balance)
    position = inverse_kinematics(tilted, HOME)
    mass, bias = mechanism.mass_and_bias(position, np.zeros((1, 3)))
    assert bias == pytest.approx(residual_torque(tilted, balance, HOME), abs=1e-12)
    assert np.all(np.linalg.eigvalsh(mass - mass_matrix(tilted, HOME)) > 0)


def test_massless_robot_is_the_motor(tilted, drive):
    bare = replace(tilted.remove_links(), platform=MASSLESS)
    mass, bias = Mechanism(bare).mass_and_bias(inverse_kinematics(bare, HOME), np.ones((1, 3)))
    assert not np.any(mass)
    assert not np.any(bias)
    stepper = Stepper.create(batch_of([drive]), 1e-3, mass, bias)
    assert stepper.mass[0] == pytest.approx(905**2 * 14.81e-7 * np.eye(3), rel=1e-12)


ZERO = np.zeros((1, 3))


def solve(inertia, impulse, limit, start=ZERO):
    return slide_or_stick(*map(np.array, ([inertia], [impulse], [limit])), start)[0]


def test_uncoupled_joints_slide_or_stick():
    # v = (impulse -+ limit)/inertia outside of the limit, 0 within.
    found = solve(np.diag([2.0, 1.0, 4.0]), [3.0, 0.4, -2.0], [1.0, 0.5, 1.0])
    assert found == pytest.approx([1.0, 0.0, -0.25], abs=1e-10)
    assert found[1] == 0.0


def test_without_friction_it_is_a_linear_equation():
    inertia = np.array([[2.0, 0.5, 0.1], [0.5, 1.0, -0.2], [0.1, -0.2, 3.0]])
    wanted = [0.3, -0.7, 1.1]
    found = solve(inertia, inertia @ wanted, [0.0])
    assert found == pytest.approx(wanted, abs=1e-9)


matrices = arrays(float, (3, 3), elements=st.floats(-1, 1)).map(
    lambda root: root @ root.T + 0.05 * np.eye(3)
)
vectors = arrays(float, 3, elements=st.floats(-3, 3))


@given(inertia=matrices, impulse=vectors, limit=st.floats(0, 2), start=vectors)
def test_law_of_dry_friction(inertia, impulse, limit, start):
    v = solve(inertia, impulse, [limit], start[None])
    friction = impulse - inertia @ v
    assert np.all(np.abs(friction) <= limit + 1e-7)
    for speed, push in zip(v, friction, strict=True):
        if abs(speed) > 1e-7:
            assert push == pytest.approx(np.copysign(limit, speed), abs=1e-7)


@given(inertia=matrices, impulse=vectors, limit=st.floats(0, 2))
def test_the_guess_does_not_matter(inertia, impulse, limit):
    near = solve(inertia, impulse, [limit], np.linalg.solve(inertia, impulse)[None])
    assert near == pytest.approx(solve(inertia, impulse, [limit]), abs=1e-7)


def test_no_answer_for_what_is_not_finite():
    with pytest.raises(ArithmeticError, match="do not converge"):
        solve(np.eye(3), [np.nan, 0.0, 0.0], [1.0])
