"""Up to which frequency the admittance that a processor displays is passive, exactly.

A hand applies a force F(t). It is sampled, the law makes a command of it, the command is held, and
the motor turns. Of a force with the frequency omega, below half the sampling rate, the velocity of
the tool has a part of the same frequency, and others beyond half the rate which take no power from
that force. With ``z = exp(j omega T)`` and the law's transfer function U from force to command, the
part is

    V = Km/(tau j omega + 1)  (1 - 1/z)/(j omega T)  U(z).

Where ``Re V > 0`` for all frequencies up to one, no force of finite energy and none but these
frequencies takes energy from the robot (Parseval). Where ``Re V < 0``, a sinusoid does. Nothing is
claimed of other forces: one that is zero at the samples and acts in between may take any amount, so
no law that samples a force is passive for all of them. Where a virtual wall is displayed instead,
the position is sampled, and Colgate and Schenkel (1997) have the condition.

With ``z = (1 + w)/(1 - w)`` and ``w = j t``, ``t = tan(omega T/2)``, the sign of Re V is that of

    Re W(j t) + tau omega Im W(j t),    W(w) = (1 - w) N(w) D(-w),    U = N/D,

which is a polynomial in ``x = t^2``, but for ``omega t = (2/T) x h`` with ``h = atan(t)/t``. It is
affine in h, so its sign is shown for a number below h and one above: convergents of Gauss's
continued fraction of atan. ``exp(-T/tau)`` is enclosed, too. So every coefficient lies between
rational numbers, and since x is positive, the polynomial lies between two rational ones, whose
roots are isolated rigorously.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import floor

from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.controllers.taylor import exponential_between
from nrs_design.design.displayed_response import root_below
from nrs_design.design.enclosed_polynomial import (
    Enclosed,
    Polynomial,
    add,
    exactly,
    in_tangent,
    multiply,
    negative,
    numbers,
    plus,
    rounded_outwards,
    times,
)
from nrs_design.design.passivity import evaluate, first_root, without_zeros
from nrs_design.models.actuator import Actuator

# Convergents of the continued fraction of the arctangent: the last one, and the one before.
DEPTH = 6
# How often the point beyond the first root is moved on, at first by this share.
STEPS, SHARE = 30, Fraction(1, 10**5)
ZERO, ONE = Fraction(0), Fraction(1)


@dataclass(frozen=True)
class SampledBand:
    """Where the admittance that a processor displays is passive."""

    age: int  # Of the force sample, always the same, in samples
    # It is passive at every frequency up to this one, in rad/s; zero where that is not shown.
    passive: Fraction
    # Between these frequencies in rad/s is one at which it is not; None where none was found.
    broken: Enclosed | None = None
    tangent: Fraction | None = None  # The ``tan(omega T/2)`` of that frequency omega, exactly


def sampled_bands(
    motor: Actuator,
    motion: ProportionalDerivative,
    law: Mapping[str, Fraction],
    period: Fraction,
    ages: Sequence[int],
) -> tuple[SampledBand, ...]:
    """Find where the displayed admittance is passive, for every age of the force in samples.

    The law has no spring, else a `ValueError`; the period is in s. Empty where the law that nobody
    holds is not shown to be stable: a displayed admittance then says nothing.
    """
    if "Kt" in law:
        raise ValueError("a spring makes another admittance")
    loop = _Loop.of(motor, motion, period)
    if not (loop.is_stable and abs(law.get("a", ZERO)) < 1):
        return ()
    return tuple(_band(loop, law, motor.time_constant, period, age) for age in ages)


@dataclass(frozen=True)
class _Loop:
    """``U/xref = (z - 1) numerator / denominator`` of the motion loop, as polynomials in z."""

    numerator: Polynomial
    denominator: Polynomial

    @classmethod
    def of(cls, motor: Actuator, motion: ProportionalDerivative, period: Fraction) -> _Loop:
        """Close the loop of PD and motor.

        With ``u = C (xref - theta)``, ``C = ((Kp + D) z - D)/z`` and ``theta = Km N/((z - 1)
        (z - E)) u``, ``N = s (1 - E) + (T - s) (z - E)``, ``s = tau (1 - E)``.
        """
        low, high = exponential_between(-period / motor.time_constant)
        E, left = (low, high), (1 - high, 1 - low)
        s = times(exactly(motor.time_constant), left)
        rest = plus(exactly(period), negative(s))
        N = [plus(times(s, left), negative(times(rest, E))), rest]
        D = motion.over(period)
        C = numbers(-D, motion.Kp + D)
        lag = [negative(E), exactly(ONE)]
        turned = multiply(numbers(0, -1, 1), lag)
        driven = multiply(multiply(C, N), numbers(motor.gain))
        return cls(multiply(C, lag), add(turned, driven))

    @property
    def is_stable(self) -> bool:
        """Whether all poles are inside the circle, by Routh's criterion for degree 3."""
        p0, p1, p2, p3 = in_tangent(self.denominator, 3)
        if max(p0[1], p1[1], p2[1], p3[1]) < 0:
            p0, p1, p2, p3 = map(negative, (p0, p1, p2, p3))
        positive = min(p0[0], p1[0], p2[0], p3[0]) > 0
        return positive and p2[0] * p1[0] > p3[1] * p0[1]


def _band(
    loop: _Loop, law: Mapping[str, Fraction], tau: Fraction, period: Fraction, age: int
) -> SampledBand:
    """Bracket the first frequency at which the real part may be negative."""
    signs = sign_polynomials(*_admittance(loop, law, age), 2 * tau / period)
    lowest = [[low for low, _ in reversed(rounded_outwards(P))] for P in signs]
    highest = [[high for _, high in reversed(rounded_outwards(P))] for P in signs]
    if min(P[-1] for P in lowest) <= 0:
        return SampledBand(age, ZERO)
    brackets = [bracket for P in lowest if (bracket := first_root(without_zeros(P))) is not None]
    if not brackets:
        # Up to half the sampling rate; pi is more than 3.14159.
        return SampledBand(age, Fraction(314159, 100_000) / period)
    low, high = min(brackets)
    passive, _ = _frequency(root_below(low, 18), period)
    step = SHARE * high
    for _ in range(STEPS):
        t = root_below(high + step, 12) + Fraction(1, 10**12)
        if all(evaluate(P, t**2) < 0 for P in highest):
            return SampledBand(age, passive, _frequency(t, period), t)
        step *= 2
    return SampledBand(age, passive)


def _admittance(
    loop: _Loop, law: Mapping[str, Fraction], age: int
) -> tuple[Polynomial, Polynomial]:
    """Return the U from force to command as two polynomials in w, but for a positive factor.

    The reference moves by T v at a sample, and ``v+ = a v + b F``, or ``v = b F`` without inertia;
    the ``z - 1`` of the reference is that of the loop.
    """
    lag = numbers(-law["a"], 1) if "a" in law else numbers(1)
    denominator = multiply(lag, loop.denominator)
    degree = len(denominator) - 1
    late, early = numbers(1), numbers(1)
    for _ in range(age):
        late, early = multiply(late, numbers(1, -1)), multiply(early, numbers(1, 1))
    return (
        multiply(late, in_tangent(loop.numerator, degree)),
        multiply(early, in_tangent(denominator, degree)),
    )


def sign_polynomials(
    numerator: Polynomial, denominator: Polynomial, lag: Fraction
) -> tuple[Polynomial, Polynomial]:
    """Return what has the sign of Re V, for a number below h and one above it, as polynomials in x.

    Where both are positive, so is Re V; where both are negative, it is negative. Numerator and
    denominator are the U in w, the constant first; the lag is ``2 tau/T`` of the motor.
    """
    mirrored = [negative(c) if k % 2 else c for k, c in enumerate(denominator)]
    W = multiply(multiply(numbers(1, -1), numerator), mirrored)
    real = [negative(c) if k % 2 else c for k, c in enumerate(W[::2])]
    imaginary = [negative(c) if k % 2 else c for k, c in enumerate(W[1::2])]
    late = multiply(numbers(0, lag), imaginary)
    below, above = (
        add(multiply(q, real), multiply(p, late))
        for p, q in (_arctangent(DEPTH), _arctangent(DEPTH + 1))
    )
    return below, above


def _arctangent(depth: int) -> tuple[Polynomial, Polynomial]:
    """Return a convergent p/q of ``atan(t)/t`` in x, with q positive for positive x.

    ``atan(t)/t = 1/(1 + x/(3 + 4x/(5 + 9x/(7 + ...))))``. All terms are positive, so the
    convergents are in turn above and below.
    """
    p, q = numbers(1), numbers(2 * depth + 1)
    for k in range(depth, 0, -1):
        # 2k - 1 + k^2 x/(q/p)
        p, q = q, add(multiply(numbers(2 * k - 1), q), multiply(numbers(0, k * k), p))
    return p, q


def _frequency(t: Fraction, period: Fraction) -> Enclosed:
    """Enclose ``2 atan(t)/T`` between decimals."""
    found = []
    for depth in (DEPTH, DEPTH + 1):
        p, q = (evaluate([c for c, _ in reversed(P)], t**2) for P in _arctangent(depth))
        found.append(2 * t * p / q / period)
    unit = 10**9
    return Fraction(floor(min(found) * unit), unit), Fraction(-floor(-max(found) * unit), unit)
