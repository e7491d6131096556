"""A spring and a damper in a row: the element that forgets its deflection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nrs_design.models.recursion import run_first_order

if TYPE_CHECKING:
    from nrs_design.models.contact.motion import Array, Motion


def relax(motion: Motion, time_constant: float) -> tuple[Array, Array]:
    """Solve ``y' = -y / tau + ddelta`` exactly, from y = 0.

    The deflection is linear between samples, so that ``y+ = a y + (1 - a)/h Delta`` with
    ``h = dt / tau`` and ``a = exp(-h)`` has no discretization error.

    Parameters
    ----------
    motion : Motion
        Deflection, n samples.
    time_constant : float
        tau in s.

    Returns
    -------
    tuple of ndarray
        y and its derivative by log tau at the samples, shape (n,) each, in m (rad).
    """
    h = motion.steps / time_constant
    a = np.exp(-h)
    gain = -np.expm1(-h) / h
    y = run_first_order(a, gain * motion.increments)
    slope = run_first_order(a, a * h * y[:-1] + (gain - a) * motion.increments)
    return y, slope
