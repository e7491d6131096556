"""What force control makes of a limit on the force, with the offset that it has (thesis 6.41).

The axis arrives at a constant velocity, and force control takes over when the force is Fd. What is
left of the force error depends on the offset X_i alone: with none the loop forgets where contact
was, with the reference it keeps the lead of the command before the position, with the measured
position it keeps nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nrs_design.design.largest_value import largest
from nrs_design.design.transfer import TransferFunction, controllable_form, static_gain
from nrs_design.errors import DesignError
from nrs_design.spec.controllers import Offset

# How far G(0) may be from 1 by rounding.
_REST = 1e-9


@dataclass(frozen=True, slots=True)
class Approach:
    """How the limit is reached."""

    offset: Offset = "none"  # What is added to the correction
    velocity: float = 0.0  # At which the axis arrives, rad/s
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
    at_rest = 1 + gain * stiffness * static_gain(motion)
    if approach.offset == "none":
        return 1 / at_rest
    left = _lead(motion, approach) if approach.offset == "reference" else 0.0
    return abs(stiffness * left / (at_rest * approach.force))


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
    # The rates of the motion loop on a ramp are constant; the command then jumps by -e, or not.
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
    beyond = largest(closed, np.eye(n + 1)[n], start, rates.astype(np.complex128))
    return approach.force + max(beyond, 0.0)


def _lead(motion: TransferFunction, approach: Approach) -> float:
    """Return how far the command is before the position on a ramp, in rad."""
    if abs(static_gain(motion) - 1) > _REST:
        raise DesignError(
            "an offset is not modelled for a motion loop that does not rest at its command: "
            f"G(0) = {static_gain(motion):.6g}",
            remedy="use `offset: none`, or a transfer function with G(0) = 1",
            at=("offset",),
        )
    ahead = motion.numerator[-2] if len(motion.numerator) > 1 else 0.0
    return approach.velocity * (motion.denominator[-2] - ahead) / motion.denominator[-1]
