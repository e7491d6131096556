"""Surfaces of a scenario: their torque on the robot, and their dampers."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from nrs_design.simulation.scenario import Surface


@dataclass
class Tissue:
    """What is touched during a run."""

    surfaces: tuple[Surface, ...]  # Positions and laws
    # Times in s at which `sample` found a surface met (true) or lost, and its environment.
    contacts: list[tuple[float, str, bool]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin free of contact, with all dampers at rest."""
        self.dampers = [0.0] * len(self.surfaces)
        self.contacting = [False] * len(self.surfaces)
        # Sign of the surface that was met last.
        self.direction = self.surfaces[0].sign if self.surfaces else 1

    @property
    def creeps(self) -> bool:
        """Whether a surface has a damper with memory."""
        return any(s.element is not None and math.isfinite(s.element.b) for s in self.surfaces)

    def depths(self, theta: float) -> list[float]:
        """Return the depth of an angle in rad below every surface."""
        return [surface.sign * (theta - surface.angle) for surface in self.surfaces]

    def _pushes(self, theta: float, omega: float) -> list[float]:
        """Return the contact torque of every surface in N m; tensile torques count as zero."""
        triples = zip(self.surfaces, self.depths(theta), self.dampers, strict=True)
        return [
            max(0.0, surface.law.push(depth - damper, surface.sign * omega)) if depth > 0 else 0.0
            for surface, depth, damper in triples
        ]

    def torque(self, theta: float, omega: float) -> float:
        """Return the torque of all surfaces on the robot in N m.

        At an angle in rad and a velocity in rad/s.
        """
        pairs = zip(self.surfaces, self._pushes(theta, omega), strict=True)
        return sum((surface.sign * force for surface, force in pairs), 0.0)

    def sample(self, time: float, theta: float, omega: float) -> float:
        """Return `torque`, and note the surfaces that have been met and lost since last time."""
        contacting = [force > 0 for force in self._pushes(theta, omega)]
        triples = zip(self.surfaces, contacting, self.contacting, strict=True)
        for surface, is_met, was_met in triples:
            if is_met != was_met:
                self.contacts.append((time, surface.environment, is_met))
                self.direction = surface.sign if is_met else self.direction
        self.contacting = contacting
        return self.torque(theta, omega)

    def creep(self, starts: list[float], ends: list[float], time: float) -> None:
        """Move the dampers while the depths, in rad, change evenly within a time in s."""
        for j, surface in enumerate(self.surfaces):
            element, damper, depth = surface.element, self.dampers[j], (starts[j] + ends[j]) / 2
            if element is None or math.isinf(element.b):
                continue
            k = element.k if depth > damper else 0.0
            if rate := (k + element.h) / element.b:
                limit = k * depth / (k + element.h)
                self.dampers[j] = limit + (damper - limit) * math.exp(-rate * time)
