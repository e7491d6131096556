"""What a displayed impedance and a tracking error add to the cost of an admittance.

Each is the largest magnitude over a band of frequencies over the limit of its goal, at nominal
values: a search has to try thousands of gains. What is proved of the gains that it chooses says
`nrs_design.design.displayed_response`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nrs_design.design.impedance import ImpedanceLoop
from nrs_design.design.transfer import ComplexArray, FloatArray, frequency_response

# Frequencies in a band.
_NODES = 64


@dataclass(frozen=True, eq=False)
class ResponseCost:
    """One part of a cost."""

    weight: float
    limit: float  # Of the goal
    omega: FloatArray  # rad/s
    drawn: float  # Kt of the admittance, N m/rad
    motion: ComplexArray  # G, from commanded to actual velocity
    filtered: ComplexArray  # G H, from the velocity of the law without its admittance
    forward: ComplexArray | None = None  # G Ze H in contact, for a tracking error

    def of(self, Mt: FloatArray, Bt: FloatArray) -> FloatArray:
        """Return the part of the cost of admittances, shape (n,); Mt and Bt, in SI, are (n, 1)."""
        admittance = Bt + 1j * (Mt * self.omega - self.drawn / self.omega)
        if self.forward is None:
            response = admittance / self.filtered
        else:
            response = 1 - self.motion * admittance / (admittance + self.forward)
        return np.asarray(self.weight / self.limit * np.abs(response).max(axis=1))


def response_cost(
    loop: ImpedanceLoop,
    weight: float,
    limit: float,
    band: tuple[float, float],
    *,
    touches: bool,
) -> ResponseCost:
    """Return the part of the cost for a limit over a band in rad/s.

    What `touches` is limited by its tracking error in contact, all else by its displayed impedance.
    """
    low, high = band
    middles = low + (high - low) * (np.arange(_NODES) + 0.5) / _NODES
    # At rest some of it is infinite.
    omega = np.concatenate([[low] * (low > 0), middles, [high]])
    s = 1j * omega
    motion = frequency_response(loop.motion, omega)
    filtered = motion / np.polyval(loop.lags, s)
    above, below = (np.polyval(part, s) for part in loop.contact.impedance)
    forward = filtered * above / below if touches else None
    return ResponseCost(weight, limit, omega, loop.Kt, motion, filtered, forward)
