"""The mobility of an arm over boxes: shown where no pose is beyond it, and nowhere else."""

import numpy as np
import pytest

from nrs_design.robot.models.arm import jacobian_and_mass, mobility
from nrs_design.robot.models.enclosure.arm import (
    BallMatrix,
    cover_mobility,
    enclosed_over,
    shown_between,
)
from nrs_design.robot.models.urdf import read_arm
from nrs_design.work import Allowance
from tests.robot.models.arms import EXAMPLE, random_tree

ALL = list(range(6))


@pytest.fixture
def tree(tmp_path):
    def read(seed):
        path = tmp_path / "tree.urdf"
        path.write_text(random_tree(seed), encoding="utf-8")
        return read_arm(path, "tool")

    return read


def test_products_of_balls_hold_those_of_their_numbers():
    from fractions import Fraction

    rng = np.random.default_rng(0)
    for _ in range(20):
        A, B = (rng.normal(size=(3, 3)) * 10.0 ** rng.integers(-8, 8) for _ in range(2))
        a, b = (np.abs(M) * rng.uniform(0, 1e-9) for M in (A, B))
        found = BallMatrix(A, a) @ BallMatrix(B, b)
        for signs in (1, -1):
            left = [[Fraction(x) + signs * Fraction(r) for x, r in zip(*row, strict=True)]
                    for row in zip(A, a, strict=True)]  # fmt: skip
            right = [[Fraction(x) - signs * Fraction(r) for x, r in zip(*row, strict=True)]
                     for row in zip(B, b, strict=True)]  # fmt: skip
            for i in range(3):
                for j in range(3):
                    exact = sum(left[i][k] * right[k][j] for k in range(3))
                    mid, rad = Fraction(found.mid[i, j]), Fraction(found.rad[i, j])
                    assert abs(exact - mid) <= rad


@pytest.mark.parametrize("seed", range(4))
def test_jacobian_and_mass_stay_in_what_encloses_them(tree, seed):
    """At any pose of a box, and the slopes between any two."""
    arm = tree(seed)
    rng = np.random.default_rng(seed)
    middle = rng.uniform(-1, 1, (arm.order, 3))
    half = rng.uniform(0.01, 0.3, (arm.order, 3))
    J, M = enclosed_over(arm, ALL, middle, half)
    for b in range(3):
        for _ in range(20):
            q = middle[:, b] + half[:, b] * rng.uniform(-1, 1, arm.order)
            jacobian, mass = jacobian_and_mass(arm, q)
            for value, found in ((jacobian, J), (mass, M)):
                assert (np.abs(value - found.whole.mid[b]) <= found.whole.rad[b] + 1e-12).all()
            for k in range(arm.order):
                moved = q.copy()
                moved[k] = middle[k, b] + half[k, b] * rng.uniform(-1, 1)
                step = moved[k] - q[k]
                if abs(step) < 1e-3:
                    continue
                later, heavier = jacobian_and_mass(arm, moved)
                for slope, found in (((later - jacobian) / step, J), ((heavier - mass) / step, M)):
                    off = np.abs(slope - found.slopes.mid[k, b]) - found.slopes.rad[k, b]
                    assert off.max() <= 1e-9


@pytest.mark.parametrize(("seed", "axes"), [(0, ALL), (3, [0, 1, 2]), (5, [2, 4])])
def test_what_a_pose_is_beyond_is_never_shown(tree, seed, axes):
    """A range that ends a little inside what a pose has, and one a little outside."""
    arm = tree(seed)
    q = np.random.default_rng(seed).uniform(-1, 1, arm.order)
    inertias = 1 / np.diag(mobility(arm, q, np.ones(len(axes)), axes))
    values = np.linalg.eigvalsh(mobility(arm, q, inertias, axes))
    low, high = values[0], values[-1]
    if low < 1e-9:
        pytest.skip("the tip cannot move so")
    point = q[:, None], q[:, None]
    near = 1e-6
    for goal, shown in (
        ((low * (1 - near), high * (1 + near)), True),
        ((low * (1 + near), high * (1 + near)), False),
        ((low * (1 - near), high * (1 - near)), False),
    ):
        found, _ = shown_between(arm, inertias, axes, *goal, point)
        assert bool(found[0]) is shown


def test_a_box_is_covered():
    arm = read_arm(EXAMPLE, "tip")
    q = np.radians([0, -75, 75, 0, 90, 0])
    half = np.radians([90, 5, 5, 5, 5, 5])
    inertias = np.array([4.1, 4.5, 8.0, 0.0044, 0.017, 0.035])
    box = q - half, q + half
    assert cover_mobility(arm, inertias, ALL, (0.75, 1.3), box, Allowance(20))
    # A pose is beyond it: all work is used up, and nothing shown.
    assert not cover_mobility(arm, inertias, ALL, (0.9, 1.1), box, Allowance(0.3))
