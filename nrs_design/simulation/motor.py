"""Motor with friction, or drive of a robot, under a command that is held."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from nrs_design.models.drive import Drive, MultiAffine
from nrs_design.simulation.scenario import Array


@dataclass(frozen=True, slots=True)
class Motor:
    """The actuator with friction, as it moves while its command is held."""

    Km: float  # In rad/s per unit of the command
    tau: float  # In s
    friction: float = 0.0  # In the unit of the command

    def advance(
        self, theta: float, omega: float, command: float, time: float
    ) -> tuple[float, float]:
        """Return angle (rad) and velocity (rad/s) after a time in s, exactly; a command is held."""
        friction = self.friction
        if not friction:
            return self._glide(theta, omega, self.Km * command, time)
        while time > 0:
            if omega == 0.0 and abs(command) <= friction:
                return theta, 0.0
            sign = math.copysign(1.0, omega if omega else command)
            final = self.Km * (command - sign * friction)
            # Time to rest, if the final velocity has the other sign.
            stop = math.inf
            if omega and final * sign < 0:
                stop = self.tau * math.log1p(-omega / final)
            if stop >= time:
                return self._glide(theta, omega, final, time)
            theta, _ = self._glide(theta, omega, final, stop)
            omega, time = 0.0, time - stop
        return theta, omega

    def _glide(self, theta: float, omega: float, final: float, time: float) -> tuple[float, float]:
        """Let the velocity tend to a final one."""
        fraction = -math.expm1(-time / self.tau)
        coefficient = self.tau * fraction
        return theta + coefficient * omega + (time - coefficient) * final, omega + fraction * (
            final - omega
        )


@dataclass
class DrivenJoint:
    """A drive at its nominal numbers, with its internal states."""

    generator: Array  # [[A, B], [0, 0]], shape (n + 1, n + 1)
    speed: Array | None  # The velocity by the same, where it jumps
    inner_states: Array = field(repr=False)  # The states between the velocity and the deflection

    @classmethod
    def create(cls, drive: Drive) -> DrivenJoint:
        """Return a drive at rest; the environment does not act on it."""
        n = drive.order
        known = {s: float(interval.nominal) for s, interval in drive.ranges.items()}
        values = {s: 1 / v if s in drive.inverse else v for s, v in known.items()}
        generator = np.zeros((n + 1, n + 1))
        generator[:n] = _evaluated(drive.rates, values, (n, n + 1))
        speed = None if drive.speed is None else _evaluated(drive.speed, values, (1, n + 1))[0]
        return cls(generator, speed, np.zeros(len(drive.states) - 1))

    def advance(
        self, theta: float, omega: float, command: float, time: float
    ) -> tuple[float, float]:
        """Return angle (rad) and velocity (rad/s) after a time in s, and keep the other states.

        The command, in its unit, is held.
        """
        from scipy.linalg import expm

        first = [] if self.speed is not None else [omega]
        z = expm(self.generator * time) @ np.array([*first, *self.inner_states, theta, command])
        self.inner_states = z[len(first) : -2]
        return float(z[-2]), float(z[0] if self.speed is None else self.speed @ z)


def _evaluated(M: MultiAffine, values: Mapping[str, float], shape: tuple[int, int]) -> Array:
    total = np.zeros(shape)
    for symbols, rows in M.terms.items():
        total += math.prod(values.get(s, 0.0) for s in symbols) * np.array(rows, float)
    return total
