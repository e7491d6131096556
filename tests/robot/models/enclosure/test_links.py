"""The closed forms against virtual work, and their enclosures against poses within."""

from dataclasses import replace

import numpy as np
import pytest
from flint import arb, arb_mat, ctx

from benchmarks.pinocchio_tree import Tree
from nrs_design.robot.models import (
    coriolis_matrix,
    direct_kinematics,
    gravity_torque,
    inverse_kinematics,
    mass_matrix,
)
from nrs_design.robot.models.body import Body, point_mass
from nrs_design.robot.models.enclosure.links import Links, moments
from tests.robot.models.crooked import crooked

POSE = np.array([0.1, -0.2, 0.2])


@pytest.fixture(params=["neuroboscope", "crooked"])
def either(request, robot):
    return robot if request.param == "neuroboscope" else crooked(robot)


def point(pose):
    phi, psi, d = np.moveaxis(np.asarray(pose), -1, 0)
    return [np.atleast_1d(v) for v in (np.sin(psi), -np.sin(phi), d)]


def at(robot, pose, order=0):
    middle = point(pose)
    return Links(robot, middle, [np.zeros_like(m) for m in middle], order)


def mids(matrix):
    return np.array([[float(np.ravel(e.value.mid)[0]) for e in row] for row in matrix])


def test_inertia_is_that_of_virtual_work(either):
    assert mids(at(either, POSE).inertia()) == pytest.approx(mass_matrix(either, POSE), abs=1e-13)


def test_inertia_is_that_of_pinocchio(either):
    tree = Tree(either)
    still = np.zeros(3)
    weight = tree.torque(POSE, still, still)
    columns = [tree.torque(POSE, still, unit) - weight for unit in np.eye(3)]
    assert mids(at(either, POSE).inertia()) == pytest.approx(np.array(columns).T, abs=1e-9)


def test_mobility_is_the_inverse(either):
    both = mids(at(either, POSE).mobility()) @ mass_matrix(either, POSE)
    assert both == pytest.approx(np.eye(3), abs=1e-10)


def test_velocity_torques_are_those_of_virtual_work(either):
    forms = np.array([mids(F) for F in at(either, POSE).velocity_torques()])
    for v in np.random.default_rng(1).normal(size=(5, 3)):
        ours = np.einsum("cij,i,j->c", forms, v, v)
        assert ours == pytest.approx(coriolis_matrix(either, POSE, v) @ v, abs=1e-12)


def test_gravity_gradient_is_the_derivative_of_the_torques(either):
    q, h = inverse_kinematics(either, POSE), 1e-6
    columns = [
        gravity_torque(either, direct_kinematics(either, q + h * unit))
        - gravity_torque(either, direct_kinematics(either, q - h * unit))
        for unit in np.eye(3)
    ]
    wanted = np.array(columns).T / (2 * h)
    assert mids(at(either, POSE).gravity_gradient()) == pytest.approx(wanted, abs=1e-7)


@pytest.mark.parametrize(
    "either", [pytest.param("neuroboscope", marks=pytest.mark.slow), "crooked"], indirect=True
)
@pytest.mark.parametrize("order", [1, pytest.param(2, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ["inertia", "mobility", "gravity_gradient", "velocity_torques"])
def test_every_pose_of_a_box_is_enclosed(either, order, name):
    """Random poses and corners of boxes: whatever is there is in the balls of the box."""
    rng = np.random.default_rng(8)
    low, high = np.array([-0.2, -0.28, 0.165]), np.array([0.2, 0.28, 0.225])
    middle = rng.uniform(low, high, (6, 3)).T
    half = np.array([0.006, 0.006, 0.0015])[:, None] * np.ones((1, 6))
    signs = np.vstack(
        [np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T, rng.uniform(-1, 1, (12, 3))]
    )
    # Of each box, all points beside each other.
    points = (middle[:, :, None] + signs.T[:, None, :] * half[:, :, None]).reshape(3, -1)
    over = getattr(Links(either, list(middle), list(half), order), name)()
    there = getattr(Links(either, list(points), list(0 * points), 0), name)()
    if name != "velocity_torques":
        over, there = [over], [there]
    for wide, exact in zip(over, there, strict=True):
        for i in range(3):
            for j in range(3):
                ball, number = wide[i][j].value, exact[i][j].value
                mid, rad = (
                    np.repeat(part + np.zeros(6), len(signs)) for part in (ball.mid, ball.rad)
                )
                assert np.all(np.abs(mid - number.mid) <= rad + number.rad)
                assert np.all(rad < 10 * (1 + np.abs(mid)))


def test_what_cancels_is_off_by_what_it_was_before():
    """A mass 1/3 in 0.2 - 0.2 m: exact zeros, of which floats leave some 1e-17."""
    moved = point_mass(1 / 3, (0.1 + 0.1, 0.0, 0.0)).placed(-np.eye(3), (0.3 - 0.1, 0.0, 0.0))
    assert moved.first[0] != 0
    _, first, second = moments(moved, 0.2)
    assert abs(first[0].mid) <= first[0].rad < 1e-11
    assert abs(second[0][0].mid) <= second[0][0].rad < 1e-11
    assert moments(Body(0.0, (0.0,) * 3, ((0.0,) * 3,) * 3), 0.2)[0].mid == 0


class Exact:
    """The kinetic energy of the links from where they are, by differences of 400 bits.

    Nothing is shared with the closed forms: links are placed in space, and twice the energy is
    the trace of ``T' J T'`` with the transforms T' and the moments J in homogeneous coordinates.
    """

    STEP = arb(2) ** -150

    def __init__(self, robot):
        self.robot = robot

    def placed(self, p):
        """Return the transforms of all links, one after the other, and the joint angles."""
        x, y, d = p
        W = [x, y, (1 - x * x - y * y).sqrt()]
        transforms, angles = [], []
        for leg in self.robot.legs:
            ax, ay = arb(leg.axis[0]), arb(leg.axis[1])
            l0, l1, l2, l3 = map(arb, (leg.l0, leg.l1, leg.l2, leg.l3))
            cos = W[0] * ax + W[1] * ay
            sin = (1 - cos * cos).sqrt()
            a = [ax, ay, arb(0)]
            v = [(w - cos * e) / sin for w, e in zip(W, a, strict=True)]
            end = (d * cos + l3 * sin, d * sin - l3 * cos)
            away = (end[0] - l0, end[1])
            distance = (away[0] ** 2 + away[1] ** 2).sqrt()
            wide = ((distance**2 + l1**2 - l2**2) / (2 * l1 * distance)).acos()
            beta = arb.atan2(away[1], away[0]) + leg.elbow_sign * wide
            elbow = (l0 + l1 * beta.cos(), l1 * beta.sin())
            kappa = arb.atan2(end[1] - elbow[1], end[0] - elbow[0])
            gamma = arb.atan2(cos, -sin)
            for origin, angle in (((l0, arb(0)), beta), (elbow, kappa), (end, gamma)):
                transforms.append(self._transform(a, v, origin, angle))
            angles.append((beta, arb.atan2((W[0] * ay - W[1] * ax) / sin, W[2] / sin)))
        return transforms, [angles[0][1], angles[1][1], angles[2][0]]

    @staticmethod
    def _transform(a, v, origin, angle):
        c, s = angle.cos(), angle.sin()
        n = [a[1] * v[2], -a[0] * v[2], a[0] * v[1] - a[1] * v[0]]
        return arb_mat(
            [
                [c * e + s * f, c * f - s * e, g, origin[0] * e + origin[1] * f]
                for e, f, g in zip(a, v, n, strict=True)
            ]
        )

    def inertia(self, p):
        """Return M at a point."""
        ends = []
        for k in range(3):
            both = [
                self.placed([x + side * self.STEP * int(i == k) for i, x in enumerate(p)])
                for side in (1, -1)
            ]
            scale = 1 / (2 * self.STEP)
            transforms = [(t - u) * scale for t, u in zip(both[0][0], both[1][0], strict=True)]
            ends.append(
                (transforms, [(t - u) * scale for t, u in zip(*(b[1] for b in both), strict=True)])
            )
        bodies = [body for loads in self.robot.loads for body in loads]
        A = arb_mat(3, 3)
        for i in range(3):
            for j in range(3):
                A[i, j] = sum(
                    (t * self._homogeneous(body) * u.transpose()).trace()
                    for t, u, body in zip(ends[i][0], ends[j][0], bodies, strict=True)
                )
        K = arb_mat([[ends[c][1][m] for c in range(3)] for m in range(3)]).inv()
        return K.transpose() * A * K

    @staticmethod
    def _homogeneous(body):
        rows = [[*map(arb, row), arb(h)] for row, h in zip(body.second, body.first, strict=True)]
        return arb_mat([*rows, [*map(arb, body.first), arb(body.mass)]])


def test_inertia_of_flint_is_in_the_balls(either, monkeypatch):
    """At points the balls are narrow, and over boxes every corner and point is in them."""
    monkeypatch.setattr(ctx, "prec", 400)
    robot = replace(either, legs=tuple(replace(leg, axis_inertia=0.0) for leg in either.legs))
    exact, rng = Exact(robot), np.random.default_rng(3)
    middle = rng.uniform([-0.2, -0.28, 0.165], [0.2, 0.28, 0.225])
    for size, narrow in ((0.0, 1e-9), (1e-3, 1.0)):
        half = size * np.array([1, 1, 0.3])
        M = Links(robot, [m[None] for m in middle], [h[None] for h in half], 1).inertia()
        for signs in ((1, 1, 1), (1, -1, 1), (-1, -1, -1), rng.uniform(-1, 1, 3)):
            p = [
                arb(float(m)) + arb(float(s)) * arb(float(h))
                for m, s, h in zip(middle, signs, half, strict=True)
            ]
            there = exact.inertia(p)
            for i in range(3):
                for j in range(3):
                    mid, rad = (
                        float(np.ravel(v)[0]) for v in (M[i][j].value.mid, M[i][j].value.rad)
                    )
                    assert abs(there[i, j] - arb(mid)) <= arb(rad)
                    assert rad < narrow
