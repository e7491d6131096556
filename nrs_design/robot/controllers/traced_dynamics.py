"""The full inverse dynamics from few operations, for links whose mass is in the plane of their leg.

In the plane of a leg vectors have components along the endoscope W and along X, across it and away
from the pivot: the end of the coupler is there at (d, l3), and it moves with depth and gamma by
(1, 0) and (l3, -d). What crank and coupler take is a force on that end. Derivations are those of
`nrs_design.robot.models.dynamics`, which tests compare this with.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nrs_design.controllers.trace import Traced
from nrs_design.robot.controllers.traced_endoscope import Endoscope
from nrs_design.robot.controllers.traced_trigonometry import sine_and_cosine
from nrs_design.robot.models.body import Body
from nrs_design.robot.models.kinematics import coupler_sign
from nrs_design.robot.models.robot import Leg, Robot
from nrs_design.robot.models.vectors import Scalar, Vector, add, dot, scale

# Two components: along the endoscope and across it.
Pair = tuple[Scalar, Scalar]


@dataclass(frozen=True, slots=True)
class _Frame:
    """The plane of a leg: how it and the endoscope in it turn, and gravity along W, X and k."""

    cos: Scalar
    sin: Scalar
    alpha_1: Scalar
    alpha_2: Scalar
    gamma_1: Scalar
    gamma_2: Scalar
    gravity: Vector


@dataclass(frozen=True, slots=True)
class _Loop:
    """Crank l1 c and coupler l2 kappa of a leg."""

    # crank, coupler: the two vectors.
    crank: Pair
    coupler: Pair
    across: Scalar  # One over the product of the coupler with the crank turned by a right angle
    along: Scalar  # The product of the coupler with the crank
    # beta_1, beta_2, kappa_1, kappa_2: rates and accelerations of the angles of crank and coupler.
    beta_1: Scalar
    beta_2: Scalar
    kappa_1: Scalar
    kappa_2: Scalar
    end_2: Pair  # Acceleration of the coupler's end


@dataclass(frozen=True, slots=True)
class _Depth:
    """Depth and its rates."""

    d: Scalar
    d_1: Scalar
    d_2: Scalar


@dataclass(frozen=True, slots=True)
class _Forces:
    """What a leg takes: on alpha, gamma, the depth, and the crank where it is driven."""

    alpha: Scalar
    gamma: Scalar
    depth: Scalar
    crank: Scalar


def is_flat(robot: Robot) -> bool:
    """Tell whether all mass is in the planes of the legs, and crank and coupler are thin."""
    rods = [body for loads in robot.loads for body in loads[:2]]
    arms = [loads[2] for loads in robot.loads]
    lumped = all(loads[1].mass == loads[1].first[0] == 0 for loads in robot.loads)
    thin = all(_is_zero(b.first[1:], b.second[0][1:], b.second[1][1:]) for b in rods)
    return (
        lumped
        and thin
        and all(_is_zero(b.first[2:], (b.second[0][2], b.second[1][2])) for b in arms)
    )


def _is_zero(*numbers: Sequence[float]) -> bool:
    return not any(any(part) for part in numbers)


def dynamics(
    robot: Robot,
    encoders: Sequence[Traced],
    ratio: float,
    motion: tuple[Vector, Vector],
    gravity: Vector,
) -> Vector:
    """Return the joint torques of a motion in N m.

    Parameters
    ----------
    robot : Robot
        As `lumped` returns it, and flat.
    encoders : sequence of Traced
        Their angles in rad.
    ratio : float
        Turns of an encoder per turn of its joint.
    motion : tuple of tuple
        Velocities and accelerations of the joints, in rad/s and rad/s^2.
    gravity : tuple
        In the base frame, in m/s^2.
    """
    scope = Endoscope.at(robot, encoders, ratio)
    v, a = motion
    axes, (t1, t2) = scope.axes, scope.tangents
    W = (scope.cos_gamma, scope.b[0] * scope.sin_gamma, scope.b[1] * scope.sin_gamma)
    g = scope.gravity(robot, gravity)
    g_b = scope.b[0] * g[1] + scope.b[1] * g[2]
    g_W = W[0] * g[0] + scope.sin_gamma * g_b
    squares = (1.0 + t1 * t1, 1.0 + t2 * t2)
    planes = [
        _Side.of(axes.size, A, W, q, t)
        for A, q, t in zip((axes.first, axes.second), squares, (t1, t2), strict=True)
    ]
    # Along the base axis of the middle leg, across it, and along the normal of its plane.
    by = (
        scale(
            -(squares[0] * scope.per_whole), _across(axes.second, planes[1].along, W, scope.b[1])
        ),
        scale(squares[1] * scope.per_whole, _across(axes.first, planes[0].along, W, scope.b[1])),
    )
    W_1 = add(scale(v[0], by[0]), scale(v[1], by[1]))
    rates = [side.gamma_1(W_1) for side in planes]
    pushes = [
        a[i] + 2 * (side.cos * side.per_sin * rates[i] * v[i]) for i, side in enumerate(planes)
    ]
    turned = add(scale(pushes[0], by[0]), scale(pushes[1], by[1]))
    # Of the square of the speed, what is across the plane of the middle leg and along it.
    per_sin = 1.0 / scope.sin_gamma
    inward = W_1[0] * per_sin
    speed = inward * inward + W_1[2] * W_1[2]
    frames = [
        side.frame(turned, speed, v[i], a[i], rates[i], g, g_W) for i, side in enumerate(planes)
    ]
    middle = _middle(scope, W_1, turned, g, g_b, g_W)
    leg = robot.legs[2]
    depth, loop, by_crank, by_gamma = _driven(robot, leg, middle, encoders[2], ratio, v[2], a[2])
    taken = [
        _forces(one, loads, frame, depth, _closed(one, frame, depth), driven=False)
        for one, loads, frame in zip(robot.legs[:2], robot.loads[:2], frames, strict=True)
    ]
    last = _forces(leg, robot.loads[2], middle, depth, loop, driven=True)
    on_d = taken[0].depth + taken[1].depth + last.depth
    pulls = [-(force.gamma * side.per_axis) for force, side in zip(taken, planes, strict=True)]
    first, second = axes.first, axes.second
    on_W = (
        first[0] * pulls[0] + second[0] * pulls[1] - (last.gamma + by_gamma * on_d) * per_sin,
        first[1] * pulls[0] + second[1] * pulls[1],
        last.alpha * per_sin,
    )
    return (
        taken[0].alpha + dot(by[0], on_W),
        taken[1].alpha + dot(by[1], on_W),
        last.crank + by_crank * on_d,
    )


def _across(axis: tuple[float, float], along: Scalar, W: Vector, level: Scalar) -> Vector:
    return axis[0] - along * W[0], axis[1] - along * W[1], -(level * axis[1])


@dataclass(frozen=True, slots=True)
class _Side:
    """The plane of a side leg, without its motion."""

    size: float
    axis: tuple[float, float]
    tangent: Scalar
    along: Scalar
    cos: Scalar
    sin: Scalar
    per_sin: Scalar
    per_axis: Scalar
    upright: Scalar

    @classmethod
    def of(
        cls, size: float, axis: tuple[float, float], W: Vector, square: Scalar, tangent: Scalar
    ) -> _Side:
        along = axis[0] * W[0] + axis[1] * W[1]
        sin = W[2] * np.sqrt(square)
        per_sin = 1.0 / sin
        return cls(
            size,
            axis,
            tangent,
            along,
            size * along,
            sin,
            per_sin,
            size * per_sin,
            W[2] * per_sin,
        )

    def gamma_1(self, W_1: Vector) -> Scalar:
        return -(self._on_axis(W_1) * self.per_axis)

    def _on_axis(self, vector: Vector) -> Scalar:
        return self.axis[0] * vector[0] + self.axis[1] * vector[1]

    def frame(
        self,
        turned: Vector,
        speed: Scalar,
        v: Scalar,
        a: Scalar,
        gamma_1: Scalar,
        g: Vector,
        g_W: Scalar,
    ) -> _Frame:
        """Return it with its motion."""
        pulled = self.along * (speed - gamma_1 * gamma_1)
        gamma_2 = -((self._on_axis(turned) - pulled) * self.per_axis)
        g_X = (self._on_axis(g) - self.along * g_W) * self.per_axis
        level = self.size * (self.axis[1] * g[0] - self.axis[0] * g[1])
        g_k = (level - self.tangent * g[2]) * self.upright
        return _Frame(self.cos, self.sin, v, a, gamma_1, gamma_2, (g_W, g_X, g_k))


def _middle(
    scope: Endoscope, W_1: Vector, turned: Vector, g: Vector, g_b: Scalar, g_W: Scalar
) -> _Frame:
    cos, sin, b = scope.cos_gamma, scope.sin_gamma, scope.b
    per_sin = 1.0 / sin
    gamma_1 = -(W_1[0] * per_sin)
    gamma_2 = -((turned[0] - cos * (W_1[2] * W_1[2])) * per_sin)
    alpha_1 = W_1[2] * per_sin
    alpha_2 = (turned[2] - 2 * (cos * (gamma_1 * alpha_1))) * per_sin
    gravity = g_W, sin * g[0] - cos * g_b, b[0] * g[2] - b[1] * g[1]
    return _Frame(cos, sin, alpha_1, alpha_2, gamma_1, gamma_2, gravity)


def _driven(
    robot: Robot, leg: Leg, frame: _Frame, encoder: Traced, ratio: float, v: Scalar, a: Scalar
) -> tuple[_Depth, _Loop, Scalar, Scalar]:
    """Return what the crank of the middle leg does with the depth, and how it follows."""
    sine, cosine = sine_and_cosine(encoder, ratio, leg.l1)
    C = cosine * frame.cos + sine * frame.sin
    S = cosine * frame.sin - sine * frame.cos
    KX = leg.l3 - (leg.l0 * frame.sin + S)
    KW = coupler_sign(robot) * np.sqrt(leg.l2 * leg.l2 - KX * KX)
    d = leg.l0 * frame.cos + C + KW
    per = 1.0 / KW
    slope = KX * per
    by_crank, by_gamma = S - slope * C, slope * d - leg.l3
    d_1 = by_crank * v + by_gamma * frame.gamma_1
    across, along = KW * S - KX * C, KW * C + KX * S
    end_1 = _end_1(leg, frame, d, d_1)
    per_across = 1.0 / across
    kappa_1 = -((C * end_1[0] + S * end_1[1]) * per_across)
    square, turning = v * v, kappa_1 * kappa_1
    X_2 = _end_2(frame, d, d_1, end_1)
    push = square * along + leg.l2 * leg.l2 * turning
    W_2 = by_crank * a - push * per - slope * X_2
    d_2 = W_2 - leg.l3 * frame.gamma_2 - end_1[1] * frame.gamma_1
    pull = leg.l1 * leg.l1 * square + turning * along
    kappa_2 = -((C * W_2 + S * X_2 + pull) * per_across)
    loop = _Loop((C, S), (KW, KX), per_across, along, v, a, kappa_1, kappa_2, (W_2, X_2))
    return _Depth(d, d_1, d_2), loop, by_crank, by_gamma


def _end_1(leg: Leg, frame: _Frame, d: Scalar, d_1: Scalar) -> Pair:
    """Velocity of the coupler's end in its plane."""
    return d_1 + leg.l3 * frame.gamma_1, -(d * frame.gamma_1)


def _end_2(frame: _Frame, d: Scalar, d_1: Scalar, end_1: Pair) -> Scalar:
    """Acceleration of the coupler's end along X."""
    return -((d_1 + end_1[0]) * frame.gamma_1 + d * frame.gamma_2)


def _closed(leg: Leg, frame: _Frame, depth: _Depth) -> _Loop:
    """Return what crank and coupler of a side leg do where the depth is given."""
    d, l1 = depth.d, leg.l1
    PW, PX = d - leg.l0 * frame.cos, leg.l3 - leg.l0 * frame.sin
    square = PW * PW + PX * PX
    along = (square + (l1 * l1 - leg.l2 * leg.l2)) * 0.5
    across = leg.elbow_sign * np.sqrt(l1 * l1 * square - along * along)
    per = 1.0 / square
    C, S = (PW * along + PX * across) * per, (PX * along - PW * across) * per
    KW, KX = PW - C, PX - S
    per_across, along = -(1.0 / across), along - l1 * l1
    end_1 = _end_1(leg, frame, d, depth.d_1)
    W_2 = depth.d_2 + leg.l3 * frame.gamma_2 + end_1[1] * frame.gamma_1
    X_2 = _end_2(frame, d, depth.d_1, end_1)
    beta_1 = (KW * end_1[0] + KX * end_1[1]) * per_across
    kappa_1 = -((C * end_1[0] + S * end_1[1]) * per_across)
    pull, turning = beta_1 * beta_1, kappa_1 * kappa_1
    beta_2 = (KW * W_2 + KX * X_2 + pull * along + leg.l2 * leg.l2 * turning) * per_across
    kappa_2 = -((C * W_2 + S * X_2 + l1 * l1 * pull + turning * along) * per_across)
    return _Loop((C, S), (KW, KX), per_across, along, beta_1, beta_2, kappa_1, kappa_2, (W_2, X_2))


def _forces(
    leg: Leg,
    loads: tuple[Body, Body, Body],
    frame: _Frame,
    depth: _Depth,
    loop: _Loop,
    *,
    driven: bool,
) -> _Forces:
    """Return generalized forces; where the crank is driven, its own is kept apart."""
    crank, coupler, arm = loads
    (C, S), (KW, KX) = loop.crank, loop.coupler
    cos, sin, turn = frame.cos, frame.sin, frame.alpha_1 * frame.alpha_1
    g_W, g_X, g_k = frame.gravity
    v = C * sin - S * cos
    of_crank = crank.second[0][0] / leg.l1**2 * v
    uv_crank = of_crank * (C * cos + S * sin)
    height = KW * sin - KX * cos
    of_coupler = coupler.second[0][0] / leg.l2**2 * height
    uv_coupler = of_coupler * (KW * cos + KX * sin)
    on_beta = (
        crank.second[0][0] * loop.beta_2
        - crank.first[0] / leg.l1 * (S * g_W - C * g_X)
        - turn * uv_crank
    )
    on_kappa = coupler.second[0][0] * loop.kappa_2 - turn * uv_coupler
    push = -(on_kappa * loop.across)
    FW, FX = push * C, push * S
    if not driven:
        held = on_beta * loop.across
        FW, FX = FW + held * KW, FX + held * KX
    d, l3 = depth.d, leg.l3
    m, (hx, hy, _), ((xx, xy, _), (_, yy, _), _) = arm.mass, arm.first, arm.second
    # Moments about the pivot, along W and X: the first, and what they are after a turn by gamma.
    EW, EX = m * d - hy, m * l3 - hx
    lever = EW * sin - EX * cos
    on_W = d * lever + (yy - hy * d) * sin + (hy * l3 - xy) * cos
    on_X = (xx - l3 * hx) * cos - l3 * lever + (d * hx - xy) * sin
    uv_arm, leaning = cos * on_W - sin * on_X, sin * lever
    # What the arm takes at the coupler's end, and around it.
    pulled, pushed = loop.end_2[0] - g_W, loop.end_2[1] - g_X
    gamma_2, square = frame.gamma_2, frame.gamma_1 * frame.gamma_1
    FW = FW + (m * pulled - hx * gamma_2 + hy * square)
    FX = FX + (m * pushed + hx * square + hy * gamma_2)
    on_d = FW - turn * leaning
    around = (xx + yy) * gamma_2 - hx * pulled + hy * pushed
    on_gamma = l3 * FW - d * FX + around - turn * uv_arm
    zz = sum(body.second[2][2] for body in loads) + leg.axis_inertia
    inertia = of_crank * v + of_coupler * height + sin * on_W + cos * on_X + zz
    grows = (
        uv_crank * loop.beta_1
        + uv_coupler * loop.kappa_1
        + uv_arm * frame.gamma_1
        + leaning * depth.d_1
    )
    on_alpha = (
        inertia * frame.alpha_2
        + 2 * (frame.alpha_1 * grows)
        - g_k * (lever + crank.first[0] / leg.l1 * v)
    )
    return _Forces(on_alpha, on_gamma, on_d, on_beta)
