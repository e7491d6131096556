import numpy as np
import pytest

from nrs_design.controllers.float32 import is_float32
from nrs_design.errors import DesignError
from nrs_design.robot.design.motion_control import (
    LawState,
    LoadModel,
    design_computed_torque,
    design_independent_joint,
)
from nrs_design.robot.models.correction import simplified_dynamics
from nrs_design.robot.models.drive import build_drive
from nrs_design.robot.models.dynamics import mass_matrix
from nrs_design.robot.models.kinematics import JointMotion, inverse_kinematics
from nrs_design.spec import parse_spec
from nrs_design.spec.templates import TEMPLATES

TEXT = TEMPLATES["robot"]
CHOSEN = "    derivative_gain: 2060 rpm*s/rad\n    zero: 56.9706 1/s\n"


def test_computed_torque_of_4_14_and_4_15(spec, tilted, load):
    law = design_computed_torque(spec, load)
    assert law.Kp**0.5 == pytest.approx(40.297, rel=1e-4)
    assert law.Kp == pytest.approx(1623.85, rel=1e-4)
    assert law.Kd == pytest.approx(56.980, rel=1e-4)
    assert law.period == 0.002


def test_independent_joint_of_4_30_in_single_precision(spec):
    motion = design_independent_joint(spec, None).motion
    assert float(motion.Kp) == pytest.approx(117359.43, rel=1e-5)
    assert motion.Kd == 2060
    assert is_float32(motion.Kp)


def test_correction_for_the_tilt_of_the_experiments(spec, tilted, load):
    # 4.19 prints 1.848, 1.845, 2.152; recomputed by the errata.
    assert load.correction == pytest.approx([1.845, 1.842, 2.188], rel=1e-3)
    assert load.encoder_ratio == 5


def test_why_independent_joints_are_stiffer(spec, tilted, load):
    # What docs/robot/motion-control.md states: stiffness of both at d = 200 mm in N m/rad, and the
    # slowest pole of computed torque on the rotors, which its law does not know.
    drive = build_drive(spec.drive)
    torque, joint = design_computed_torque(spec, load), design_independent_joint(spec, None)
    known = load.terms(5 * inverse_kinematics(tilted, tilted.home)[None]).inertia[0]
    stiffness = np.sort(np.linalg.eigvals(torque.Kp * known))
    assert stiffness == pytest.approx([21.4, 117.7, 436.8], rel=3e-3)
    stiff = float(joint.motion.Kp) * drive.encoder_ratio * drive.torque_per_command
    assert stiff == pytest.approx(1964, rel=1e-3)
    M = mass_matrix(tilted, tilted.home)
    assert drive.inertia / np.linalg.eigvalsh(M) == pytest.approx([76, 15, 5], rel=2e-2)
    total = M + drive.inertia * np.eye(3)
    damping = torque.Kd * known + drive.damping * np.eye(3)
    parts = np.linalg.solve(total, np.hstack([torque.Kp * known, damping]))
    poles = np.linalg.eigvals(np.vstack([np.eye(6)[3:], -parts]))
    assert poles.real.max() == pytest.approx(-0.62, abs=0.01)


def test_no_control():
    start = TEXT.index("# Thesis 4.2 and 4.3: the settling")
    bare = TEXT[:start] + TEXT[TEXT.index("# Thesis 4.4 and its") :]
    with pytest.raises(DesignError, match="no `control`"):
        design_independent_joint(parse_spec(bare), None)


def test_a_closed_loop_is_no_controller():
    given = (
        "    transfer_function: {numerator: [0.99, 56.82], denominator: [0.0351, 1.99, 56.82]}\n"
    )
    with pytest.raises(DesignError, match="not a closed loop"):
        design_independent_joint(parse_spec(TEXT.replace(CHOSEN, given)), None)


POSE = np.array([[0.05, -0.1, 0.2]])


@pytest.fixture(scope="module")
def angle(tilted):
    return 5 * inverse_kinematics(tilted, POSE)


def reference(angle, ahead):
    return JointMotion((angle + ahead) / 5, np.zeros((1, 3)), np.zeros((1, 3)))


def test_pd_in_encoder_coordinates_is_in_rpm_already(spec, angle):
    # Thesis 4.30 and 4.31 with Kp = 117359.43, Kd = 2060: no gradient before them (errata 4.36).
    law = design_independent_joint(spec, None)
    first, memory = law.step(LawState(), reference(angle, 0.01), angle)
    assert first == pytest.approx(np.full((1, 3), 1173.5943), rel=1e-6)
    second, _ = law.step(memory, reference(angle, 0.012), angle)
    expected = 117359.43 * 0.012 + 2060 * 0.002 / 0.002
    assert second == pytest.approx(np.full((1, 3), expected), rel=1e-6)


def test_weight_is_fed_forward_through_gradient_and_gears(spec, tilted, load, angle):
    law = design_independent_joint(spec, load)
    command, memory = law.step(LawState(), reference(angle, 0.0), angle)
    K = np.array(load.correction)
    expected = 2.7044e5 / 905 * K * simplified_dynamics(tilted, POSE).Gs
    assert command == pytest.approx(expected, rel=1e-9)
    assert memory.load is not None


def test_one_tick_of_many_robots_is_that_of_each(spec, load, angle):
    law = design_independent_joint(spec, load)
    both = np.concatenate([angle, angle + 0.3])
    ahead = np.array([[0.01, 0.0, -0.02], [0.0, 0.03, 0.0]])
    wanted = JointMotion((both + ahead) / 5, np.zeros((2, 3)), np.zeros((2, 3)))
    together, _ = law.step(LawState(), wanted, both)
    for row in (0, 1):
        alone, _ = law.step(LawState(), wanted.select([row]), both[[row]])
        assert together[[row]] == pytest.approx(alone, rel=1e-12)


POSES = np.array([[0.0, 0.0, 0.2], [0.1, -0.2, 0.2], [-0.2, 0.1, 0.16]])


def test_corrected_simplified_dynamics(tilted):
    # Thesis 4.17 with the coefficients printed in 4.19.
    K = np.array([1.848, 1.845, 2.152])
    terms = LoadModel(tilted, 5.0, tuple(K)).terms(5 * inverse_kinematics(tilted, POSES))
    simplified = simplified_dynamics(tilted, POSES)
    assert terms.inertia == pytest.approx(np.diag(K) @ simplified.Ms, abs=1e-12)
    assert terms.gravity == pytest.approx(K * simplified.Gs, abs=1e-12)


def test_follows_the_encoders_that_move(tilted, load):
    angle = 5 * inverse_kinematics(tilted, POSES)
    known = load.follow(angle, None)
    assert load.follow(angle.copy(), known) is known
    moved = angle.copy()
    moved[1, 2] += 0.01
    found, right = load.follow(moved, known), load.terms(moved)
    assert found.inertia == pytest.approx(right.inertia, abs=1e-15)
    assert found.gravity == pytest.approx(right.gravity, abs=1e-15)
    assert np.array_equal(found.angle, moved)
    assert np.array_equal(found.gravity[[0, 2]], known.gravity[[0, 2]])
    assert not np.array_equal(found.gravity[1], known.gravity[1])


ACCELERATION = np.array([[0.3, -0.1, 0.2]])
VELOCITY = np.array([[0.2, 0.1, -0.3]])


def test_equation_4_18_with_acceleration_and_error_of_the_encoders(spec, load, angle):
    law = design_computed_torque(spec, load)
    error = np.array([[0.01, -0.02, 0.005]])
    reference = JointMotion((angle + error) / 5, VELOCITY, ACCELERATION)
    memory = LawState(error - 0.001)
    command, _ = law.step(memory, reference, angle)
    wanted = 5 * ACCELERATION + 56.9801 * 0.001 / 0.002 + 1623.85 * error
    terms = load.terms(angle)
    expected = 2.7044e5 * (terms.inertia[0] @ wanted[0] / (905 * 5) + terms.gravity[0] / 905)
    assert command[0] == pytest.approx(expected, rel=1e-5)
