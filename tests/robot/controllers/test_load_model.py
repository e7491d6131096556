from dataclasses import replace

import numpy as np
import pytest

from nrs_design.robot.controllers.motion_laws import LoadModel
from nrs_design.robot.models.dynamics import gravity_torque, mass_matrix
from nrs_design.robot.models.kinematics import inverse_kinematics
from nrs_design.robot.models.simplified import simplified_dynamics

POSES = np.array([[0.0, 0.0, 0.2], [0.1, -0.2, 0.2], [-0.2, 0.1, 0.16]])


def test_corrected_simplified_dynamics(tilted):
    # Thesis 4.17 with the coefficients printed in 4.19.
    K = np.array([1.848, 1.845, 2.152])
    terms = LoadModel(tilted, 5.0, tuple(K)).terms(5 * inverse_kinematics(tilted, POSES))
    simplified = simplified_dynamics(tilted, POSES)
    assert terms.inertia == pytest.approx(np.diag(K) @ simplified.Ms, abs=1e-12)
    assert terms.gravity == pytest.approx(K * simplified.Gs, abs=1e-12)


def test_full_dynamics(tilted, load):
    terms = replace(load, correction=None).terms(5 * inverse_kinematics(tilted, POSES))
    assert terms.inertia == pytest.approx(mass_matrix(tilted, POSES), abs=1e-12)
    assert terms.gravity == pytest.approx(gravity_torque(tilted, POSES), abs=1e-12)


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
