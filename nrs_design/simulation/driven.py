"""A robot with a drive of its own, while its command is held, by matrix exponentials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import prod

import numpy as np
from numpy.typing import NDArray

from nrs_design.models.drive import Drive, MultiAffine

Array = NDArray[np.float64]


@dataclass
class DrivenJoint:
    """A drive at its nominal numbers, with those of its states that nobody else knows."""

    generator: Array  # [[A, B], [0, 0]], shape (n + 1, n + 1)
    speed: Array | None  # The velocity by the same, where it jumps
    rest: Array = field(repr=False)  # The states between the velocity and the deflection

    @classmethod
    def of(cls, drive: Drive) -> DrivenJoint:
        """Return a drive at rest; what is touched does not act on it."""
        n = drive.order
        known = {s: float(interval.nominal) for s, interval in drive.ranges.items()}
        values = {s: 1 / v if s in drive.inverse else v for s, v in known.items()}
        generator = np.zeros((n + 1, n + 1))
        generator[:n] = _evaluated(drive.rates, values, (n, n + 1))
        speed = None if drive.speed is None else _evaluated(drive.speed, values, (1, n + 1))[0]
        return cls(generator, speed, np.zeros(len(drive.states) - 1))

    def after(self, theta: float, omega: float, command: float, time: float) -> tuple[float, float]:
        """Return angle (rad) and velocity (rad/s) after a time in s, and keep the other states.

        The command, in its unit, is held.
        """
        from scipy.linalg import expm

        first = [] if self.speed is not None else [omega]
        z = expm(self.generator * time) @ np.array([*first, *self.rest, theta, command])
        self.rest = z[len(first) : -2]
        return float(z[-2]), float(z[0] if self.speed is None else self.speed @ z)


def _evaluated(M: MultiAffine, values: Mapping[str, float], shape: tuple[int, int]) -> Array:
    total = np.zeros(shape)
    for symbols, rows in M.terms.items():
        total += prod(values.get(s, 0.0) for s in symbols) * np.array(rows, float)
    return total
