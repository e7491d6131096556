import numpy as np
import pytest

from nrs_design.controllers.float32 import is_float32
from nrs_design.errors import DesignError
from nrs_design.robot.models.drive import build_drive
from nrs_design.robot.models.dynamics import mass_matrix
from nrs_design.robot.models.kinematics import inverse_kinematics
from nrs_design.robot.motion_control import design_computed_torque, design_independent_joint
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
