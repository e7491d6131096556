"""What the surgeon feels of a law that a processor runs, bounded over a band and all ranges.

Of a force with the frequency omega, below half the sampling rate, the velocity of the tool has a
part of the same frequency, as in `nrs_design.design.passivity`:

    V = Km/(tau j omega + 1)  (1 - 1/z)/(j omega T)  U(z),    z = exp(j omega T).

With ``w = j t``, ``t = tan(omega T/2)``, ``z = (1 + w)/(1 - w)`` and ``c = atan(t)/t``, omega is
``2 c t/T`` and the second factor ``1/(c (1 + w))``; how old a force sample is does not change a
magnitude, as long as it is always the same. ``F/V`` is a quotient of polynomials in w that are
affine in each of Km, ``E = exp(-T/tau)`` and ``s = tau (1 - E)``. These are taken for themselves,
and tau and c, where they stand beside, at their largest, where ``|c (1 + 2 c tau w/T)|`` is
largest, too. That covers more than there is, and little more on a short piece of the band and of
the range of tau.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from itertools import product
from math import atan, prod
from typing import Any

from nrs_design.controllers.laws import Admittance, CompliantLaw, ProportionalDerivative
from nrs_design.controllers.sensor import LowPass
from nrs_design.controllers.taylor import exponential_between
from nrs_design.design.affine_family import (
    Polynomial,
    Quotient,
    as_fmpq,
    is_stable_over,
    polynomial,
)
from nrs_design.design.displayed_response import (
    Band,
    LargestResponse,
    largest_over,
    root_below,
)
from nrs_design.loop.cut_loop import ProcessorAxis
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.interval import Interval
from nrs_design.proof.enclosure import ball_around, fraction_of, precision
from nrs_design.spec import InteractionDesignSpec

ZERO, ONE = Fraction(0), Fraction(1)
# By what share c may fall along a piece of the band, and how many pieces there are at most.
_FALL, _MOST = 1 / 300, 200
# How near the bounds shall come, and the shortest range of a time constant, as a share, to halve.
_NEARLY, _SHORT = 1 + Fraction(9, 1000), Fraction(1, 10_000)


@dataclass(frozen=True)
class SampledAdmittance:
    """An admittance that a processor runs over a motor, and what it runs beside."""

    motion: ProportionalDerivative  # The PD gains that ship
    motor: ActuatorRanges  # Where the motor is
    law: Admittance  # Without a spring
    method: str  # By which the law is discretized
    period: Fraction  # In s
    low_pass: LowPass | None = None  # Of the force

    @property
    def box(self) -> dict[str, Interval]:
        """What the polynomials are affine in, and where it is."""
        tau = self.motor.time_constant
        ends = [exponential_between(-self.period / end) for end in (tau.low, tau.high)]
        E = ends[0][0], ends[1][1]
        s = tau.low * (1 - ends[0][1]), tau.high * (1 - ends[1][0])
        Km = self.motor.gain
        moving = {} if Km.low == Km.high else {"Km": Km}
        return moving | {"E": Interval(E[0], *E), "s": Interval(min(s), min(s), max(s))}

    def command(self, values: Mapping[str, Fraction]) -> tuple[Polynomial, Polynomial]:
        """Return Km U/F as polynomials in w, at values of what is in the box."""
        T, numbers = self.period, self._numbers
        Km, E, s = values.get("Km", self.motor.gain.nominal), values["E"], values["s"]
        D = self.motion.over(T)
        C, lag, one = _linear(self.motion.Kp + D, -D), _linear(ONE, -E), _linear(ZERO, ONE)
        turned = _linear(ONE, ZERO) * _linear(ONE, -ONE) * lag
        closed = turned + C * _linear(Km * (T - s), Km * (s - T * E)) * one
        poles = [_linear(ONE, -numbers["a"])] if "a" in numbers else []
        scale = Km * numbers["T"] * numbers["b"]
        if self.low_pass is not None:
            held = self.low_pass.discretize(T)
            poles += held.order * [_linear(ONE, -held.p)]
            scale *= held.q**held.order
        return as_fmpq(scale) * C * lag * one ** (1 + len(poles)), prod(poles, start=closed)

    def quotient(self, values: Mapping[str, Fraction], c: Fraction = ONE) -> Quotient:
        """Return F/V as polynomials in w, at values of what is in the box; c is ``atan(t)/t``."""
        command, poles = self.command(values)
        late = polynomial(2 * c * self.motor.time_constant.high / self.period * c, c)
        return Quotient(poles * late * polynomial(ONE, ONE), command, poles)

    @property
    def _numbers(self) -> Mapping[str, Fraction]:
        return self.law.discretize(self.period, self.method).numbers

    def halves(self) -> tuple[SampledAdmittance, ...]:
        """Halve the range of the time constant; nothing if it is short."""
        gain, tau, command = self.motor.gain, self.motor.time_constant, self.motor.command
        if tau.high - tau.low < tau.high * _SHORT:
            return ()
        parts = ((tau.low, tau.middle), (tau.middle, tau.high))
        motors = (ActuatorRanges(gain, Interval(low, low, high), command) for low, high in parts)
        return tuple(replace(self, motor=motor) for motor in motors)

    def corners(self) -> Iterator[tuple[dict[str, Fraction], SampledAdmittance]]:
        """Yield this at each corner of the ranges of the motor, and the values there."""
        for (of_gain, gain), (of_tau, tau) in product(
            self.motor.gain.ends, self.motor.time_constant.ends
        ):
            at = {n: v for n, label, v in (("Km", of_gain, gain), ("tau", of_tau, tau)) if label}
            point = replace(self.motor.nominal, gain=gain, time_constant=tau)
            yield at, replace(self, motor=ActuatorRanges.point(point))

    def squared(self, t: Fraction) -> Any:
        """Enclose ``|F/V|^2`` in a ball, where nothing has a range; t is ``tan(omega T/2)``."""
        from flint import acb

        w, c, T = acb(0, 1) * ball_around(t), _over_tangent(t), ball_around(self.period)
        z, numbers = (1 + w) / (1 - w), self._numbers
        Km, tau = (ball_around(r.nominal) for r in (self.motor.gain, self.motor.time_constant))
        E = (-T / tau).exp()
        s = tau * (1 - E)
        D = ball_around(self.motion.over(self.period))
        C, N = ((ball_around(self.motion.Kp) + D) * z - D) / z, s * (1 - z) + T * (z - E)
        law = ball_around(numbers["b"]) / (z - ball_around(numbers["a"]) if "a" in numbers else 1)
        if self.low_pass is not None:
            held = self.low_pass.discretize(self.period)
            law *= (ball_around(held.q) / (z - ball_around(held.p))) ** held.order
        # The z - 1 of the reference is that of the loop.
        U = ball_around(numbers["T"]) * law * C * (z - E) / ((z - 1) * (z - E) + C * Km * N)
        V = Km / (1 + 2 * c * tau * w / T) / (c * (1 + w)) * U
        return 1 / (V.real**2 + V.imag**2)


def sampled_admittance(
    spec: InteractionDesignSpec,
    axis: ProcessorAxis,
    law: CompliantLaw,
    ranges: Mapping[str, Interval],
) -> SampledAdmittance | str:
    """Return a law as a processor runs it, with the ranges of the motor, or why there is none."""
    cases = {
        "commands are late": spec.late_at is not None,
        "the law is sampled, with two periods": axis.sampling.round > 1,
        "the law misses deadlines": axis.sampling.misses is not None,
        "the law is sampled, with a spring Kt": bool(law.gains.get("Kt")),
        "the law is sampled, with a load of the motor": axis.drive.loaded,
        "the robot closes its own motion loop": axis.takes is not None,
    }
    if (why := next((why for why, found in cases.items() if found), None)) is not None:
        return why
    motor = axis.places[0].motor
    known = {"Km": motor.gain, "tau": motor.time_constant}
    box = {name: Interval.point(value) for name, value in known.items()} | dict(ranges)
    return SampledAdmittance(
        motion=axis.motion,
        motor=ActuatorRanges(box["Km"], box["tau"], motor.command),
        law=Admittance.of(law.gains),
        method=axis.sampling.admittance,
        period=axis.period,
        low_pass=axis.low_pass,
    )


def largest_sampled_impedance(
    shown: SampledAdmittance, band: Band, limit: Fraction | None = None
) -> LargestResponse | None:
    """Bound the largest displayed impedance of a sampled law, in N m s/rad.

    The band is in rad/s, below half the sampling rate. None where the robot that nobody holds is
    not shown to be stable.
    """
    if not is_stable_over(shown.quotient, shown.box):
        return None
    open_ = [_Piece(shown, band, limit) for band in _pieces(*_tangents(band, shown.period))]
    for _ in range(_MOST):
        highest = max(open_, key=lambda piece: piece.height)
        lowest = max(open_, key=lambda piece: piece.seen.below).seen
        met = highest.found.above is not None and highest.found.above <= lowest.below * _NEARLY
        halves = () if met or (limit and lowest.below > limit) else highest.shown.halves()
        if not halves:
            break
        open_.remove(highest)
        open_ += (_Piece(half, highest.band, limit) for half in halves)
    return replace(lowest, above=highest.found.above)


@dataclass(frozen=True, eq=False)
class _Piece:
    """A piece of the band, in tan(omega T/2), and of the range of the time constant."""

    shown: SampledAdmittance
    band: Band
    limit: Fraction | None

    @cached_property
    def found(self) -> LargestResponse:
        """Bounds over what is covered, which is more than there is."""
        first = self.band[0]
        with precision():
            c = fraction_of(_over_tangent(first).upper()) if first else ONE
        quotient = partial(self.shown.quotient, c=c)
        return largest_over(quotient, self.shown.box, self.band, self.limit)

    @property
    def height(self) -> tuple[bool, Fraction]:
        """Orders pieces: those without a bound are above all others."""
        return self.found.above is None, self.found.above or ZERO

    @cached_property
    def seen(self) -> LargestResponse:
        """The loop itself, where what is covered is highest, at a corner of its ranges."""
        t = min(max(root_below(self.found.square, 12), self.band[0]), self.band[1])
        with precision():
            values = [(fraction_of(one.squared(t).lower()), at) for at, one in self.shown.corners()]
        square, at = max(values, key=lambda pair: pair[0])
        omega = 2 * atan(t) / float(self.shown.period)
        return LargestResponse(None, root_below(max(square, ZERO), 20), t**2, at, omega)


def _tangents(band: Band, period: Fraction) -> Band:
    """Return ``tan(omega T/2)`` of the ends of a band, rounded outwards."""
    with precision():
        low, high = ((ball_around(omega * period / 2)).tan() for omega in band)
        return max(ZERO, fraction_of(low.lower())), fraction_of(high.upper())


def _pieces(low: Fraction, high: Fraction) -> Iterator[Band]:
    """Yield pieces of a band, in tan(omega T/2), along which ``atan(t)/t`` falls by little."""
    first = low
    for _ in range(_MOST):
        last = high
        while _share(first) / _share(last) > 1 + _FALL:
            last = first + (last - first) / 2
        yield first, last
        if last == high:
            return
        first = last
    yield first, high


def _linear(a: Fraction, b: Fraction) -> Polynomial:
    """Return ``a z + b`` times ``1 - w``, as a polynomial in w."""
    return polynomial(a - b, a + b)


def _share(t: Fraction) -> float:
    return atan(t) / float(t) if t else 1.0


def _over_tangent(t: Fraction) -> Any:
    """Enclose ``atan(t)/t`` in a ball."""
    ball = ball_around(t)
    return ball.atan() / ball if t else ball + 1
