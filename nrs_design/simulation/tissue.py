"""Surfaces of a scenario: their torque on the robot, and their dampers."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from nrs_design.simulation.scenario import Surface


@dataclass
class Tissue:
    """What is touched during a run."""

    surfaces: tuple[Surface, ...]  # Positions and laws
    # Times in s at which `note` found a surface met (true) or lost, and its environment.
    contacts: list[tuple[float, str, bool]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin free of contact, with all dampers at rest."""
        self.dampers = [0.0] * len(self.surfaces)
        self.touched = [False] * len(self.surfaces)
        self.noted = list(self.touched)
        self.direction = self.surfaces[0].sign if self.surfaces else 1

    @property
    def creeps(self) -> bool:
        """Whether a surface has a damper with memory."""
        return any(s.element is not None and math.isfinite(s.element.b) for s in self.surfaces)

    def depths(self, theta: float) -> list[float]:
        """Return the depth of an angle in rad below every surface."""
        return [surface.sign * (theta - surface.at) for surface in self.surfaces]

    def torque(self, theta: float, omega: float) -> float:
        """Return the torque of all surfaces on the robot in N m: none of them pulls.

        At an angle in rad and a velocity in rad/s.
        """
        total = 0.0
        for j, (surface, depth) in enumerate(zip(self.surfaces, self.depths(theta), strict=True)):
            push = 0.0
            if depth > 0:
                push = surface.law.push(depth - self.dampers[j], surface.sign * omega)
            self.touched[j] = push > 0
            if push > 0:
                total += surface.sign * push
        return total

    def note(self, time: float) -> None:
        """Write down which surfaces have been met and lost since the last time."""
        for surface, touched, noted in zip(self.surfaces, self.touched, self.noted, strict=True):
            if touched != noted:
                self.contacts.append((time, surface.environment, touched))
                if touched:
                    self.direction = surface.sign
        self.noted = list(self.touched)

    def creep(self, before: list[float], after: list[float], time: float) -> None:
        """Move the dampers while the depths, in rad, change evenly within a time in s."""
        for j, surface in enumerate(self.surfaces):
            element, damper, depth = surface.element, self.dampers[j], (before[j] + after[j]) / 2
            if element is None or math.isinf(element.b):
                continue
            k = element.k if depth > damper else 0.0
            if rate := (k + element.h) / element.b:
                rest = k * depth / (k + element.h)
                self.dampers[j] = rest + (damper - rest) * math.exp(-rate * time)
