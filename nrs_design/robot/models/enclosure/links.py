"""Inertia, velocity torques and weight of the links over a box of poses, enclosed.

The coordinates of a pose are here ``p = (x, y, d)`` with ``x = sin(psi)`` and ``y = -sin(phi)``,
the first two components of the direction W of the endoscope (thesis 3.3): all but the angles of the
joints is algebraic in them. The kinetic energy of the links is written down as such, in other terms
than the virtual work of `nrs_design.robot.models.dynamics`; Lagrange's equations give the rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

from nrs_design.robot.models.body import Body
from nrs_design.robot.models.enclosure.balls import Balls, Floats
from nrs_design.robot.models.enclosure.jet import Jet, coordinate_jets, degree, direction_jets
from nrs_design.robot.models.robot import Leg, Robot

# What a number of the robot is off by when its spec has been read in floating point, against the
# largest of its kind, is below 2^-46: a sum of a few products, each rounded to 53 bits.
ROUNDING = 2.0**-40
Row = list[Jet]
Matrix = list[list[Jet]]


def ball(number: float, scale: float = 0.0) -> Balls:
    """Return a ball that holds the number that a float was rounded from.

    Parameters
    ----------
    number : float
        Of a robot.
    scale : float
        The largest of the numbers it was computed with, if that is larger.
    """
    return Balls(number, ROUNDING * max(abs(number), scale))


@dataclass(frozen=True)
class Links:
    """Closed forms of one robot, at a box or a point."""

    robot: Robot  # The robot
    # middle, half: of the boxes, in the coordinates x, y and d.
    middle: Sequence[Floats]
    half: Sequence[Floats]
    order: int  # Of the derivatives of what is asked for: 0 or 1

    def _frame(self, order: int) -> _Frame:
        return _Frame(self.robot, coordinate_jets(self.middle, self.half, order))

    def inertia(self) -> Matrix:
        """Return M, the matrix of inertia at the joints."""
        frame = self._frame(self.order + 1)
        return _between(frame.K, frame.A)

    def mobility(self) -> Matrix:
        """Return the inverse of M: which acceleration of the joints a torque makes."""
        frame = self._frame(self.order + 1)
        A = frame.A
        cofactors = {
            (i, j): A[(i + 1) % 3][(j + 1) % 3] * A[(i + 2) % 3][(j + 2) % 3]
            - A[(i + 1) % 3][(j + 2) % 3] * A[(i + 2) % 3][(j + 1) % 3]
            for i in range(3)
            for j in range(i, 3)
        }
        minors = [[cofactors[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]
        inverse = _sum(A[0][j] * minors[0][j] for j in range(3)).reciprocal()
        across = [list(column) for column in zip(*frame.slopes, strict=True)]
        return [[entry * inverse for entry in row] for row in _between(across, minors)]

    def velocity_torques(self) -> list[Matrix]:
        """Return the three symmetric matrices of the quadratic forms ``C(q, q') q'``."""
        frame = self._frame(self.order + 2)
        A, K, H = frame.A, frame.K, frame.joint_hessians
        dA = [[entry.gradient() for entry in row] for row in A]
        AK = _times(A, K)
        forms = []
        for k in range(3):
            form = [
                [
                    (dA[j][k][i] + dA[i][k][j] - dA[i][j][k]) * 0.5
                    - _sum(AK[k][m] * H[m][i][j] for m in range(3))
                    for j in range(3)
                ]
                for i in range(3)
            ]
            forms.append(_between(K, form))
        return [_mix([K[k][c] for k in range(3)], forms) for c in range(3)]

    def gravity_gradient(self) -> Matrix:
        """Return the derivative of the torques of gravity with respect to the joints."""
        frame = self._frame(self.order + 2)
        slope = frame.energy.gradient()
        G = [_sum(frame.K[k][c] * slope[k] for k in range(3)) for c in range(3)]
        bend = [entry.gradient() for entry in slope]
        curved = _mix(G, frame.joint_hessians)
        form = [[bend[i][j] - curved[i][j] for j in range(3)] for i in range(3)]
        return _between(frame.K, form)


class _Frame:
    """What the three have in common: all legs, with the loops closed."""

    def __init__(self, robot: Robot, p: Sequence[Jet]) -> None:
        self.robot = robot
        x, y, d = p
        z = (-(x * x + y * y) + 1).sqrt()
        self.W = (x, y, z)
        self.legs = [_Leg(leg, self.W, d) for leg in robot.legs]

    @cached_property
    def A(self) -> Matrix:
        """Twice the kinetic energy is ``p' A p'``."""
        A = [[self.legs[0].turn[0].zero() for _ in range(3)] for _ in range(3)]
        for leg, loads in zip(self.legs, self.robot.loads, strict=True):
            for link, body in zip(leg.links, loads, strict=True):
                _add_energy(A, leg, link, body)
            _add(A, leg.turn, leg.turn, ball(leg.leg.axis_inertia))
        return A

    @cached_property
    def slopes(self) -> Matrix:
        """Derivatives of the joint angles with respect to p, one row for each joint."""
        left, right, middle = self.legs
        return [left.turn, right.turn, middle.links[0].turn]

    @cached_property
    def joint_hessians(self) -> list[Matrix]:
        """Second derivatives of the joint angles with respect to p."""
        return [[entry.gradient() for entry in row] for row in self.slopes]

    @cached_property
    def K(self) -> Matrix:
        """The inverse of the slopes: the side legs do not know of the depth."""
        (a, b, _), (c, e, _), (f, g, s) = self.slopes
        det = (a * e - b * c).reciprocal()
        deep = s.reciprocal()
        inner = [[e * det, -b * det], [-c * det, a * det]]
        last = [-(f * inner[0][k] + g * inner[1][k]) * deep for k in range(2)]
        zero = det.zero()
        return [[*inner[0], zero], [*inner[1], zero], [*last, deep]]

    @cached_property
    def energy(self) -> Jet:
        """Potential energy in the field of gravity."""
        gravity = self.robot.gravity_vector
        g = [ball(entry, self.robot.gravity) for entry in gravity]
        total = self.W[2].zero()
        for leg, loads in zip(self.legs, self.robot.loads, strict=True):
            ax, ay = leg.axis
            along = g[0] * ax + g[1] * ay
            down = self.W[0] * g[0] + self.W[1] * g[1] + self.W[2] * g[2]
            across = (down - leg.cos * along) * leg.inverse_sin
            # The normal of the plane is a x W over the sine of gamma.
            aside = (
                self.W[2] * (ay * g[0] - ax * g[1]) + (self.W[1] * ax - self.W[0] * ay) * g[2]
            ) * leg.inverse_sin
            for link, body in zip(leg.links, loads, strict=True):
                m, h, _ = moments(body, leg.leg.l3)
                hu, hv = link.turned(h)
                total = (
                    total - (link.u * m + hu) * along - (link.v * m + hv) * across - aside * h[2]
                )
        return total


class _Link:
    """Origin u, v and direction of a link in the plane of its leg."""

    def __init__(self, u: Jet, v: Jet, direction: tuple[Jet, Jet], turn: Row) -> None:
        self.u, self.v, self.turn = u, v, turn
        self.cos, self.sin = direction

    def turned(self, h: Sequence[Balls]) -> tuple[Jet, Jet]:
        """Return a vector of the link in the axes of the plane."""
        return self.cos * h[0] - self.sin * h[1], self.sin * h[0] + self.cos * h[1]


class _Leg:
    """One leg with its loop closed; names as in `nrs_design.robot.models.geometry`."""

    def __init__(self, leg: Leg, W: Sequence[Jet], d: Jet) -> None:
        self.leg = leg
        l0, l1, l2, l3 = (ball(length) for length in (leg.l0, leg.l1, leg.l2, leg.l3))
        self.axis = ax, ay = ball(leg.axis[0], 1.0), ball(leg.axis[1], 1.0)
        self.cos = cos = W[0] * ax + W[1] * ay
        self.sin = sin = (-(cos * cos) + 1).sqrt()
        self.inverse_sin = sin.reciprocal()
        end = (d * cos + sin * l3, d * sin - cos * l3)
        square = d * d - end[0] * (2 * l0) + (l3 * l3 + l0 * l0)
        along = (square + (l1 * l1 - l2 * l2)) * (2 * l1).reciprocal()
        across = (square - along * along).sqrt() * leg.elbow_sign
        inverse = square.reciprocal()
        # How the line from base joint to coupler's end turns, and how crank and coupler turn
        # against it while it grows: with the law of cosines.
        opened = inverse * across.reciprocal() * (4 * l1).reciprocal()
        line = (
            (d * d - end[0] * l0 + l3 * l3) * inverse,
            (-(sin * l0) + l3) * inverse,
        )
        grown = (end[1] * (2 * l0), (d - cos * l0) * 2)
        difference = l1 * l1 - l2 * l2
        by_crank, by_coupler = opened * (square - difference), -(opened * (square + difference))
        gamma = [self.inverse_sin * -ax, self.inverse_sin * -ay, sin.zero()]

        def turn(by: Jet) -> Row:
            with_gamma, with_d = (a - by * b for a, b in zip(line, grown, strict=True))
            return [*(with_gamma * slope for slope in gamma[:2]), with_d]

        crank, coupler = turn(by_crank), turn(by_coupler)
        x, y, u, v = (jet.middle[0] for jet in (end[0] - l0, end[1], along, across))
        scale = inverse.middle[0]
        cos_beta, sin_beta = (x * u - y * v) * scale, (y * u + x * v) * scale
        beta = direction_jets(_shortened(crank), cos_beta, sin_beta)
        kappa = direction_jets(
            _shortened(coupler),
            (x - l1 * cos_beta) * l2.reciprocal(),
            (y - l1 * sin_beta) * l2.reciprocal(),
        )
        self.links = (
            _Link(d.constant(l0), d.zero(), beta, crank),
            _Link(beta[0] * l1 + l0, beta[1] * l1, kappa, coupler),
            _Link(*end, (-sin, cos), gamma),
        )
        up = (W[0] * ay - W[1] * ax) * self.inverse_sin, W[2] * self.inverse_sin
        self.turn = _angle_slopes(up[1], up[0])


def _shortened(row: Row) -> Row:
    """Return derivatives of an angle to one order less than they are known to."""
    return [
        Jet(
            e.order - 1,
            e.half,
            *({i: a for i, a in t.items() if degree(i) < e.order} for t in (e.middle, e.whole)),
        )
        for e in row
    ]


def _angle_slopes(cos: Jet, sin: Jet) -> Row:
    """Differentiate an angle that is given by its cosine and sine."""
    return [cos * sin.derivative(k) - sin * cos.derivative(k) for k in range(3)]


def moments(body: Body, moved: float) -> tuple[Balls, list[Balls], list[list[Balls]]]:
    """Return mass and moments of a body.

    The platform has been moved into the frame of an arm, where much of its moments may cancel, so
    they are off by what they were before and not by what is left.

    Parameters
    ----------
    body : Body
        Of which a part may have been moved.
    moved : float
        By how much at most, in m.
    """
    extent = max(0.0, *(body.second[i][i] for i in range(3)))
    # Square roots of second moments over a mass are distances; the sum holds those before.
    reach = 2 * moved + 2 * (extent / body.mass) ** 0.5 if body.mass else 0.0
    length, size = body.mass * reach, body.mass * reach**2
    first = [ball(entry, length) for entry in body.first]
    return ball(body.mass), first, [[ball(entry, size) for entry in row] for row in body.second]


def _add_energy(A: Matrix, leg: _Leg, link: _Link, body: Body) -> None:
    """Add twice the kinetic energy of a link, of particles at ``(u, v, z)`` in a turning plane.

    Their velocity is ``(u', v' - alpha' z, alpha' v)``; u and v move as a body does in its
    plane.
    """
    m, h, second = moments(body, leg.leg.l3)
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = second
    hu, hv = link.turned(h)
    du, dv, turn, plane = link.u.gradient(), link.v.gradient(), link.turn, leg.turn
    c, s = link.cos, link.sin
    vv = s * s * xx + c * s * (2 * xy) + c * c * yy
    uz = c * xz - s * yz
    _add(A, du, du, m)
    _add(A, dv, dv, m)
    _add(A, turn, turn, xx + yy)
    _add(A, turn, dv, hu)
    _add(A, turn, du, -hv)
    _add(A, plane, plane, link.v * link.v * m + link.v * hv * 2 + vv + zz)
    _add(A, plane, dv, -h[2])
    _add(A, plane, turn, -uz)


def _add(A: Matrix, left: Row, right: Row, weight: Jet | Balls) -> None:
    """Add ``w l l'``, or ``w (l r' + r l')`` for two vectors."""
    for i in range(3):
        for j in range(i, 3):
            entry = left[i] * right[j]
            if left is not right:
                entry = entry + right[i] * left[j]
            A[i][j] = A[j][i] = A[i][j] + entry * weight


def _sum(terms: Iterable[Jet]) -> Jet:
    return reduce(Jet.__add__, terms)


def _times(A: Matrix, B: Matrix) -> Matrix:
    return [[_sum(A[i][m] * B[m][j] for m in range(3)) for j in range(3)] for i in range(3)]


def _between(K: Matrix, A: Matrix) -> Matrix:
    """Return ``K' A K`` of a symmetric A."""
    AL = _times(A, K)
    upper = {
        (i, j): _sum(K[m][i] * AL[m][j] for m in range(3)) for i in range(3) for j in range(i, 3)
    }
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def _mix(weights: Row, forms: Sequence[Matrix]) -> Matrix:
    return [
        [_sum(w * form[i][j] for w, form in zip(weights, forms, strict=True)) for j in range(3)]
        for i in range(3)
    ]
