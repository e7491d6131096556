"""Proportional force control on top of the motion loop (thesis 6.3.3.1), and its offset (6.41).

The axis arrives at a constant velocity, and force control takes over at the force Fd. The lasting
error depends on the offset X_i: none, the reference, or the measured position.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from nrs_design.design.root_locus import dominant_pair, largest
from nrs_design.design.transfer import (
    FloatArray,
    TransferFunction,
    controllable_form,
    frequencies,
    hurwitz,
    poles,
    static_gain,
    trim,
)
from nrs_design.errors import DesignError
from nrs_design.models.axis import unit
from nrs_design.spec.controllers import Offset


@dataclass(frozen=True)
class ForceLoop:
    """What a proportional force gain really gives."""

    gain: float  # ``Kp``, rad/(N m)
    poles: tuple[complex, ...]  # Closed-loop poles, rad/s, rightmost first
    damping_ratio: float  # Damping ratio of the dominant pair
    natural_frequency: float  # Frequency of the dominant pair, rad/s


def force_loop_response(motion: TransferFunction, stiffness: float, gain: float) -> ForceLoop:
    """Close the force loop ``Kp k G(s)`` (thesis 6.33) and return its poles.

    G leads from commanded to actual position, k is in N m/rad, Kp in rad/(N m). An unstable loop is
    a `DesignError`.
    """
    closed = _closed(motion, gain * stiffness)
    if not bool(hurwitz(closed.denominator)):
        raise DesignError(
            f"the force loop is unstable with Kp = {gain:.6g} {unit('rad/(N m)')} at "
            f"{stiffness:.6g} {unit('N m/rad')}",
            remedy="lower the proportional gain",
            at=("proportional_gain",),
        )
    roots = poles(closed)
    zeta, wn = dominant_pair(roots)
    return ForceLoop(
        gain=gain, poles=tuple(complex(p) for p in roots), damping_ratio=zeta, natural_frequency=wn
    )


def design_force_gain(motion: TransferFunction, stiffness: float, damping_ratio: float) -> float:
    """Find the smallest Kp in rad/(N m) whose dominant pole pair has the wanted damping ratio.

    Poles of damping ratio zeta lie on a ray from the origin. Where the root locus meets that
    ray, ``-D(s)/N(s)`` is real and positive, which is a polynomial equation in ``|s|``. If no gain
    reaches it, the `DesignError` names the interval that gains do reach.
    """
    for loop_gain in (0.0, *_crossings(motion, damping_ratio)):
        damping = _damping(motion, loop_gain)
        if damping is not None and abs(damping - damping_ratio) <= 1e-9:
            return loop_gain / stiffness
    raise DesignError(
        f"no force gain gives the damping ratio {damping_ratio:.6g}",
        remedy=f"gains reach {_reachable(motion)}",
        at=("damping_ratio",),
    )


def _closed(motion: TransferFunction, loop_gain: float) -> TransferFunction:
    scaled = loop_gain * np.asarray(motion.numerator)
    denominator = trim(np.polyadd(motion.denominator, scaled).tolist())
    return TransferFunction(motion.numerator, denominator)


def _crossings(motion: TransferFunction, damping_ratio: float) -> list[float]:
    """Return, ascending, the loop gains that put a pole on the ray of that damping ratio."""
    angle = math.acos(-damping_ratio)
    num, den = np.asarray(motion.numerator[::-1]), np.asarray(motion.denominator[::-1])
    # Im(D conj(N)) at s = r exp(j angle), by powers of r.
    powers = np.subtract.outer(np.arange(len(den)), np.arange(len(num)))
    terms = np.outer(den, num) * np.sin(angle * powers)
    ascending = np.zeros(len(den) + len(num) - 1)
    np.add.at(ascending, np.add.outer(np.arange(len(den)), np.arange(len(num))), terms)
    roots = frequencies(ascending[None, ::-1])[0] ** 2
    s = roots[np.isfinite(roots)] * np.exp(1j * angle)
    gains = -(np.polyval(motion.denominator, s) / np.polyval(motion.numerator, s)).real
    return sorted(float(gain) for gain in gains if gain > 0)


def _damping(motion: TransferFunction, loop_gain: float) -> float | None:
    """Return the damping ratio of the dominant pair, or nothing for an unstable loop."""
    closed = _closed(motion, loop_gain)
    if not bool(hurwitz(closed.denominator)):
        return None
    return dominant_pair(poles(closed))[0]


def _reachable(motion: TransferFunction) -> str:
    gain = abs(static_gain(motion)) or 1.0
    grid: FloatArray = np.concatenate([[0.0], np.geomspace(1e-4, 1e4, 400) / gain])
    reached = [zeta for zeta in (_damping(motion, float(k)) for k in grid) if zeta is not None]
    if not reached:
        return "no stable loop"
    return f"{min(reached):.5g} to {min(1.0, max(reached)):.5g}"


_STATIC_ERROR = 1e-9  # How far G(0) may be from 1 by rounding


@dataclass(frozen=True, slots=True)
class Approach:
    """How the limit is reached."""

    offset: Offset = "none"  # Position added to the correction
    velocity: float = 0.0  # Velocity of arrival, rad/s
    force: float = 1.0  # Fd, and the force at the switch, N m
    # Ki of a PI controller in rad/(N m s), for the peak; 0 is a proportional one.
    integral: float = 0.0


def steady_force_error(
    motion: TransferFunction, stiffness: float, gain: float, approach: Approach
) -> float:
    """Return the force error that is left in the end, over Fd.

    ``1/(1 + Kp k G(0))`` without offset. With the reference it is ``k e / ((1 + Kp k) Fd)``, where
    ``e = v / Kv`` is the lead of the command at the switch; with the measured position it is zero.
    G leads from commanded to actual position; with an offset, G(0) must be 1.
    """
    static_response = 1 + gain * stiffness * static_gain(motion)
    if approach.offset == "none":
        return 1 / static_response
    left = _lead(motion, approach) if approach.offset == "reference" else 0.0
    return abs(stiffness * left / (static_response * approach.force))


def peak_force(
    motion: TransferFunction, stiffness: float, gain: float, approach: Approach
) -> float | None:
    """Return the largest force after the switch in N m; None without offset.

    Without offset the command jumps away from the contact, so the force is largest at the switch.
    """
    if approach.offset == "none":
        return None
    lead = _lead(motion, approach)
    A, C = controllable_form(motion.numerator, motion.denominator)
    n = len(C)
    # On a ramp the rates of the motion loop are constant; then the command may jump by -e.
    start = np.zeros(n + 1)
    start[0] = approach.velocity / C[0]
    start[n - 1] -= lead if approach.offset == "measured" else 0.0
    closed = np.zeros((n + 1, n + 1))
    closed[:n, :n] = A
    closed[n - 1, :n] -= gain * stiffness * C
    # The last state is the force beyond Fd, from zero on.
    closed[n, :n] = stiffness * C
    closed[n - 1, n] = -approach.integral
    rates = np.linalg.eigvals(closed if approach.integral else closed[:n, :n])
    overshoot = largest(closed, np.eye(n + 1)[n], start, rates.astype(np.complex128))
    return approach.force + max(overshoot, 0.0)


def _lead(motion: TransferFunction, approach: Approach) -> float:
    """Return how far the command is before the position on a ramp, in rad."""
    if abs(static_gain(motion) - 1) > _STATIC_ERROR:
        raise DesignError(
            "an offset is not modelled for a motion loop that does not rest at its command: "
            f"G(0) = {static_gain(motion):.6g}",
            remedy="use `offset: none`, or a transfer function with G(0) = 1",
            at=("offset",),
        )
    ahead = motion.numerator[-2] if len(motion.numerator) > 1 else 0.0
    return approach.velocity * (motion.denominator[-2] - ahead) / motion.denominator[-1]
