import numpy as np
import pytest

from nrs_design.robot.models.correction import simplified_dynamics
from nrs_design.robot.models.kinematics import JointMotion, inverse_kinematics
from nrs_design.robot.motion_control import LawState, LoadModel, design_independent_joint

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
        alone, _ = law.step(LawState(), wanted.at([row]), both[[row]])
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
