"""The motor with Coulomb friction while its command is held, exactly."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Motor:
    """The actuator with friction, as it moves while its command is held."""

    Km: float  # In rad/s per unit of the command
    tau: float  # In s
    friction: float = 0.0  # In the unit of the command

    def after(self, theta: float, omega: float, command: float, time: float) -> tuple[float, float]:
        """Return angle (rad) and velocity (rad/s) after a time in s, exactly; a command is held."""
        friction = self.friction
        if not friction:
            return self._glide(theta, omega, self.Km * command, time)
        while time > 0:
            if omega == 0.0 and abs(command) <= friction:
                return theta, 0.0
            sign = math.copysign(1.0, omega if omega else command)
            final = self.Km * (command - sign * friction)
            # When it comes to rest, if the velocity that it tends to is on the other side.
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
        gone = -math.expm1(-time / self.tau)
        moved = self.tau * gone
        return theta + moved * omega + (time - moved) * final, omega + gone * (final - omega)
