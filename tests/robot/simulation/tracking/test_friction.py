import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from nrs_design.robot.simulation.tracking.friction import DryFriction

ZERO = np.zeros((1, 3))


def solve(inertia, impulse, limit, start=ZERO):
    problem = DryFriction.of(np.array([inertia]))
    return problem.slide_or_stick(np.array([impulse]), np.array([limit]), start)[0]


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
