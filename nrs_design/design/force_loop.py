"""Proportional force control on top of the motion loop (thesis 6.3.3.1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from nrs_design.axis import unit
from nrs_design.design.polynomials import frequencies
from nrs_design.design.root_locus import dominant_pair
from nrs_design.design.transfer import (
    FloatArray,
    TransferFunction,
    hurwitz,
    poles,
    static_gain,
    trim,
)
from nrs_design.errors import DesignError


@dataclass(frozen=True)
class ForceLoop:
    """What a proportional force gain really gives."""

    gain: float  # ``Kp``, rad/(N m)
    poles: tuple[complex, ...]  # Closed-loop poles, rad/s, rightmost first
    damping_ratio: float  # Of the dominant pair
    natural_frequency: float  # Of the dominant pair, rad/s


def force_loop_response(motion: TransferFunction, stiffness: float, gain: float) -> ForceLoop:
    """Close the force loop ``Kp k G(s)`` (thesis 6.33) and return its poles.

    G leads from commanded to actual position, k is in N m/rad, Kp in rad/(N m). An unstable loop is
    a `DesignError`.
    """
    _check(stiffness, gain)
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
        gain=gain,
        poles=tuple(complex(p) for p in roots),
        damping_ratio=zeta,
        natural_frequency=wn,
    )


def design_force_gain(motion: TransferFunction, stiffness: float, damping_ratio: float) -> float:
    """Find the smallest Kp in rad/(N m) whose dominant pole pair has the wanted damping ratio.

    Poles of damping ratio zeta lie on a ray from the origin. Where the root locus meets that
    ray, ``-D(s)/N(s)`` is real and positive, which is a polynomial equation in ``|s|``. If no gain
    reaches it, the `DesignError` names the interval that gains do reach.
    """
    _check(stiffness, 0.0)
    if not 0 < damping_ratio < 1:
        raise DesignError(f"the damping ratio must lie between 0 and 1, not {damping_ratio}")
    for loop_gain in (0.0, *_crossings(motion, damping_ratio)):
        reached = _damping(motion, loop_gain)
        if reached is not None and abs(reached - damping_ratio) <= 1e-9:
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


def _check(stiffness: float, gain: float) -> None:
    if not (math.isfinite(stiffness) and stiffness > 0):
        raise DesignError(f"the stiffness must be positive, not {stiffness}")
    if not (math.isfinite(gain) and gain >= 0):
        raise DesignError(f"the force gain must not be negative: {gain}")
