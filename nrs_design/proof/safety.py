"""TRUSTED: how far a position loop goes behind a reference that moves by bounded steps.

The motor is not loaded, so errors of the motion loop follow from the steps of its reference alone,
whatever moves it. With the held command u, the error e (reference less angle) and the velocity w of
a sample,

    d = s w + g u,   w+ = E w + h u,   e+ = e + r - d,   u = Kp e + D (e - e before),

``E = exp(-T/tau)``, ``s = tau (1 - E)``, ``g = Km (T - s)`` and ``h = Km (1 - E)``. What the motor
does otherwise than one of fixed numbers is a disturbance of d and of w+, in proportion to w and u:
sums of the responses of that one motor bound everything, if the bounds that they begin with hold
for what they end with. All of it is rational; the responses are exact.

**Motion.** e, w and u are sums ``z(k) = sum c(j) r(k-1-j)`` of one response c each, so with steps
of at most W, ``|z| <= W sum |c|``. Steps of the signs of c attain it. Nothing in it depends on who
chose the steps.

**Ranges, friction, encoder, rounding.** Another motor, from sample to sample another, adds
``ds w + dg u`` to d and ``dE w + dh u`` to w+; friction and the roundings of the command, f, add
``g f`` and ``h f``. While ``|w|`` and ``|u|`` have kept bounds, all of this is bounded, and the
sums bound the next sample: if that is within the same bounds, it holds for ever. An error n of the
angle changes e by ``n(k+1) - n(k)``, so it counts with ``sum |c(j) - c(j-1)|``. Sums are exact up
to a horizon N; behind it ``|A^N| v <= q v`` with q < 1 bounds what is left.

**Torque.** Let j be the last sample at which the reference moved inward, and ``b = j - a``, a at
most `oldest`, the one whose torque it saw: there ``F <= torque``, so the deflection was
``y(b) <= torque/low``. The angle follows a unit step of the reference by ``h(n) = 1 - c(n)``. M
samples after b, since behind j all steps are outward and h is not negative,

    y - y(b) = sum r(i) (h(b+M-1-i) - h(b-1-i)) <= W max over M of sum |h(q+M) - h(q)|

over ``q >= -(oldest + 1)``: W times `carry`. What ranges and noise add to the error counts twice,
and between samples the angle goes on by at most ``V T/2``, V the bound on the velocity: all
together `depth`. With a constant k, ``k y <= torque + k depth``. A damping b presses by at most
``b V`` more, and hides as much of the spring while the tissue is left. If the reference never moved
inward, y is not beyond that of the start.

**Work.** What is spent stays in [0, `energy`], so the books of n samples sum up to at most
`energy`, and the refill for each. Products and sums are rounded once each, and the reference,
rounded to its own last place, goes on by up to twice what is booked, or stays where a step out is.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.proof.saturation import OF_ANGLES, OF_TERMS, ONE, ZERO, Governed, Range
from nrs_design.proof.taylor import exponential_between

Row = tuple[Fraction, Fraction, Fraction]
# The numbers of the motor that responses are computed with have so many binary digits.
MOTOR_BITS = 48
# Sums of responses are rounded up to so many.
SUM_BITS = 80
# More than what is lost below the smallest numbers of single precision.
LOST = Fraction(1, 2**100)


@dataclass(frozen=True, slots=True)
class SampledMotor:
    """Numbers of a motor over a period, each within a radius of a dyadic one."""

    E: Range
    s: Range
    g: Range
    h: Range

    @classmethod
    def of(cls, loop: Governed, period: Fraction) -> SampledMotor:
        """Enclose those of all motors of a loop: middle and radius of each."""
        (fast, slow), (least, most) = loop.time_constant, loop.gain
        E = exponential_between(-period / fast)[0], exponential_between(-period / slow)[1]
        # Both rise with the time constant.
        s = (
            fast * (1 - exponential_between(-period / fast)[1]),
            slow * (1 - exponential_between(-period / slow)[0]),
        )
        left = max(period - s[1], ZERO), period - s[0]
        g, h = (least * left[0], most * left[1]), (least * (1 - E[1]), most * (1 - E[0]))
        return cls(*map(_middle, (E, s, g, h)))

    def matrix(self, loop: Governed) -> tuple[Row, Row, Row]:
        """Return the step of e, e before and w for a reference that rests."""
        both, D = loop.Kp + loop.D, loop.D
        (E, _), (s, _), (g, _), (h, _) = self.E, self.s, self.g, self.h
        return (1 - g * both, g * D, -s), (ONE, ZERO, ZERO), (h * both, -h * D, E)


def _middle(ends: Range) -> Range:
    middle = Fraction(round(sum(ends) / 2 * 2**MOTOR_BITS), 2**MOTOR_BITS)
    return middle, max(ends[1] - middle, middle - ends[0])


@dataclass(frozen=True, slots=True)
class Response:
    """Sums over the response of one output: none is too small."""

    step: Fraction  # Of |its| response to a step of the reference
    change: Fraction  # Of how much that changes from sample to sample
    spin: Fraction  # Of |its| response to a change of the velocity


@dataclass(frozen=True, slots=True)
class Responses:
    """Those of a loop with one motor, exactly, up to a horizon, with bounds on the rest."""

    error: Response
    change: Response  # Of the error, from sample to sample
    velocity: Response
    command: Response
    # Over a reference that has just stopped, how far the angle may go on, in steps.
    carry: Fraction
    # Whether the angle never goes back while the reference goes on.
    forward: bool


def respond(loop: Governed, motor: SampledMotor, horizon: int, oldest: int) -> Responses | None:
    """Sum the responses of a loop; None where they have not died down by the horizon.

    Parameters
    ----------
    loop, motor : Governed, SampledMotor
        The loop, with one motor.
    horizon : int
        Samples that are summed one by one.
    oldest : int
        Age of the torque.
    """
    powers, last = _powers(motor.matrix(loop), horizon)
    unit = 2**SUM_BITS
    weights = (unit, unit, int(unit / loop.tick))
    # |A^N| v <= q v, and the columns of A^N are within shares of v.
    q = max(
        Fraction(sum(abs(a) * v for a, v in zip(row, weights, strict=True)), unit * own)
        for row, own in zip(last, weights, strict=True)
    )
    if q >= 1:
        return None
    left = tuple(
        max(Fraction(row[k], v) for row, v in zip(last, weights, strict=True)) / (1 - q)
        for k in (0, 2)
    )
    rows = {
        "error": (ONE, ZERO, ZERO),
        "change": (ONE, -ONE, ZERO),
        "velocity": (ZERO, ZERO, ONE),
        "command": (loop.Kp + loop.D, -loop.D, ZERO),
    }
    tails = {name: _tail(row, powers, weights) for name, row in rows.items()}
    found = {
        name: _response(row, powers, tails[name] * left[0], tails[name] * left[1])
        for name, row in rows.items()
    }
    error, tail = [p[0][0] for p in powers], int(tails["error"] * left[0]) + 1
    # The first one is 1 exactly, others are less than a unit above.
    forward = all(g < unit for g in error[1:]) and tail < unit
    return Responses(**found, carry=_carry(error, tail, oldest), forward=forward)


def _powers(A: tuple[Row, Row, Row], horizon: int) -> tuple[list[list[list[int]]], list[list[int]]]:
    """Return A^0, A^1, ... in units, each entry rounded down, and the one after them, rounded up.

    The last is a bound on sizes.
    """
    bits = max(entry.denominator for row in A for entry in row).bit_length() - 1
    M = [[int(entry * 2**bits) for entry in row] for row in A]
    P = [[int(i == j) for j in range(3)] for i in range(3)]
    powers: list[list[list[int]]] = []
    for j in range(horizon + 1):
        # P is A^j over two to the power j bits.
        shift = j * bits - SUM_BITS
        powers.append([[p >> shift if shift > 0 else p << -shift for p in row] for row in P])
        P = [[sum(p * M[k][i] for k, p in enumerate(row)) for i in range(3)] for row in P]
    # An entry that is rounded down is less than one unit below.
    last = [[max(abs(p), abs(p + 1)) for p in row] for row in powers.pop()]
    return powers, last


def _tail(row: Row, powers: list[list[list[int]]], weights: tuple[int, ...]) -> Fraction:
    """Bound ``sum |C A^j| v`` over the horizon, in units."""
    size = sum((abs(c) for c in row), ZERO)
    sums = [[sum((c * p[i][k] for i, c in enumerate(row)), ZERO) for k in range(3)] for p in powers]
    each = (sum(((abs(c) + size) * v for c, v in zip(r, weights, strict=True)), ZERO) for r in sums)
    return sum(each, ZERO) / (1 << SUM_BITS)


def _response(
    row: Row, powers: list[list[list[int]]], first: Fraction, second: Fraction
) -> Response:
    """Sum the response of one output to a step and to a spin; behind the horizon they have tails.

    Every entry of ``C A^j`` is off by less than the sum of the sizes of C, in units.
    """
    size, unit = sum((abs(c) for c in row), ZERO), 2**SUM_BITS
    steps, spins = (
        [sum((c * p[i][k] for i, c in enumerate(row)), ZERO) for p in powers] for k in (0, 2)
    )
    step, spin = (sum(abs(r) + size for r in each) for each in (steps, spins))
    pairs = zip([ZERO, *steps], steps, strict=False)
    change = sum(abs(b - a) + 2 * size for a, b in pairs)
    # The response goes from its last value to zero.
    change += abs(steps[-1]) + size + 2 * first
    return Response((step + first) / unit, change / unit, (spin + second) / unit)


def _carry(error: list[int], tail: int, oldest: int) -> Fraction:
    """Bound ``sum |h(q + M) - h(q)|`` over q >= -(oldest + 1), for every M >= 1, in steps.

    The angle follows a step of the reference by ``h = 1 - g``, g the response of the error, and by
    zero before it. M samples lie between the torque that was seen and now.
    """
    unit, N = 2**SUM_BITS, len(error)
    sizes = [abs(g) + 1 for g in error]
    # More samples than the horizon lie between.
    late = max(*sizes[-(oldest + 1) :], tail)
    beyond = sum(sizes) + 2 * tail + (oldest + 1) * (unit + late)
    after = [0]
    for size in reversed(sizes):
        after.append(after[-1] + size)
    most = beyond
    for M in range(1, N + 1):
        early = sum(
            abs(unit - error[q + M]) + 1 if q + M < N else unit + tail
            for q in range(-(oldest + 1), 0)
            if q + M >= 0
        )
        both = sum(abs(a - b) + 1 for a, b in zip(error, error[M:], strict=False))
        most = max(most, early + both + after[min(M, N)] + 3 * tail)
    return Fraction(most, unit)


@dataclass(frozen=True, slots=True)
class Reach:
    """How far a loop goes from rest; every number is a bound on a size."""

    # At samples: the error as it is computed, how it changes, the velocity, and the command without
    # what it is rounded by.
    error: Fraction
    change: Fraction
    velocity: Fraction
    command: Fraction


@dataclass(frozen=True, slots=True)
class SafetyBounds:
    """What is kept at all times; every number is a bound on a size."""

    velocity: Fraction  # Of the joint, rad/s
    error: Fraction  # Reference less angle at samples, rad
    command: Fraction  # Of the motor
    depth: Fraction  # Beyond the deflection at which the torque is that of the layer, rad
    torque: Fraction  # Of contact, where its stiffness jumps in the range, N m
    steady: Fraction  # Of contact, where its stiffness is constant, N m
    stored: Fraction  # In a contact of constant stiffness, J
    lost: Fraction  # By which the books are off, J in a sample


def reach_of(loop: Governed, motor: SampledMotor, found: Responses, claimed: Reach) -> Reach:
    """Return how far the loop goes in a sample more, while it has not gone beyond what is claimed.

    Parameters
    ----------
    loop, motor, found
        The loop, with one motor and its responses.
    claimed : Reach
        Of all samples before.
    """
    turned, spun = _strays(loop, motor, claimed)
    each = (found.error, found.change, found.velocity, found.command)
    return Reach(
        *(r.step * (loop.step + turned) + r.change * loop.noise + r.spin * spun for r in each)
    )


def _roundings(loop: Governed, claimed: Reach) -> Fraction:
    terms = loop.Kp * claimed.error + loop.D * claimed.change
    return OF_TERMS * terms + LOST


def _strays(loop: Governed, motor: SampledMotor, claimed: Reach) -> Range:
    """Return by how much the way and the velocity of a sample differ from those of one motor."""
    disturbed = loop.friction + _roundings(loop, claimed)
    (_, E), (_, s), (g, off), (h, away) = motor.E, motor.s, motor.g, motor.h
    turned = s * claimed.velocity + off * claimed.command + (g + off) * disturbed
    spun = E * claimed.velocity + away * claimed.command + (h + away) * disturbed
    return turned, spun


def limits_of(
    loop: Governed, period: Fraction, motor: SampledMotor, found: Responses, reach: Reach
) -> SafetyBounds:
    """Return what is kept at all times by a loop that keeps its reach.

    Parameters
    ----------
    loop, period, motor, found
        The loop, with one motor and its responses.
    reach : Reach
        That has been shown.
    """
    turned, spun = _strays(loop, motor, reach)
    # Between samples, the velocity is between those at their ends, but for friction.
    velocity = reach.velocity + 2 * sum(motor.h) * loop.friction
    stray = found.error.step * turned + found.error.spin * spun
    stray += (found.error.change + 1) * loop.noise
    depth = found.carry * loop.step + 2 * stray + velocity * period / 2
    damped, (low, high) = loop.damping * velocity, loop.stiffness
    # A retreat hides as much of the torque of the spring.
    seen = loop.torque * (1 + OF_TERMS) + loop.sensor + damped
    pressed = (seen + k * depth for k in (low, high))
    most = high * (seen / low + depth) + damped
    # The reference goes on by more, or goes back by less, than the step that is booked.
    unbooked = (most + loop.sensor) * (1 + OF_TERMS) * loop.angle * OF_ANGLES
    return SafetyBounds(
        velocity,
        reach.error + loop.noise,
        reach.command + _roundings(loop, reach),
        depth,
        most,
        seen + high * depth + damped,
        max(torque**2 / (2 * k) for torque, k in zip(pressed, (low, high), strict=True)),
        2 * OF_TERMS * (loop.energy + loop.refill) + unbooked + LOST,
    )
