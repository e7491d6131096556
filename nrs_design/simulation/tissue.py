"""Surfaces of a scenario: their torque on the robot, and their dampers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from nrs_design.models.contact import AbstractNonlinearLaw
from nrs_design.simulation.scenario import Surface


@dataclass
class Tissue:
    """What is touched during a run."""

    surfaces: tuple[Surface, ...]  # Where it begins
    # Times in s at which `note` found a surface met (true) or lost, and its environment.
    contacts: list[tuple[float, str, bool]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin free of contact, with all dampers at rest."""
        self.dampers = [[0.0] * len(surface.elements) for surface in self.surfaces]
        self.touched = [False] * len(self.surfaces)
        self.noted = list(self.touched)
        self.direction = self.surfaces[0].sign if self.surfaces else 1

    @property
    def creeps(self) -> bool:
        """Whether a surface has a damper with memory."""
        return any(math.isfinite(e.b) for surface in self.surfaces for e in surface.elements)

    def depths(self, theta: float) -> list[float]:
        """Return the depth of an angle in rad below every surface."""
        return [surface.sign * (theta - surface.at) for surface in self.surfaces]

    def torque(self, theta: float, omega: float) -> float:
        """Return the torque of all surfaces on the robot in N m: none of them pulls.

        At an angle in rad and a velocity in rad/s.
        """
        total = 0.0
        for j, surface in enumerate(self.surfaces):
            depth, speed = surface.sign * (theta - surface.at), surface.sign * omega
            push = _push(surface, self.dampers[j], depth, speed) if depth > 0 else 0.0
            self.touched[j] = push > 0
            if push > 0:
                total += surface.sign * push
        return total

    def note(self, time: float) -> None:
        """Write down which surfaces have been met and lost since the last time."""
        if self.touched == self.noted:
            return
        for j, surface in enumerate(self.surfaces):
            if self.touched[j] != self.noted[j]:
                self.contacts.append((time, surface.environment, self.touched[j]))
                if self.touched[j]:
                    self.direction = surface.sign
        self.noted = list(self.touched)

    def creep(self, before: list[float], after: list[float], time: float) -> None:
        """Move the dampers while the depths, in rad, change evenly within a time in s.

        The surface of one body with several arms returns by itself where nothing pushes it.
        """
        for j, surface in enumerate(self.surfaces):
            dampers, depth = self.dampers[j], (before[j] + after[j]) / 2
            pushed = bool(dampers) and _push(surface, dampers, depth, 0.0) > 0
            if surface.arms and not pushed:
                springs = sum(e.k for e in surface.elements)
                each = zip(surface.elements, dampers, strict=True)
                pushed, depth = True, sum(e.k * damper for e, damper in each) / springs
            for i, element in enumerate(surface.elements):
                k = element.k if pushed else 0.0
                rate = (k + element.h) / element.b
                if rate:
                    rest = k * depth / (k + element.h)
                    dampers[i] = rest + (dampers[i] - rest) * math.exp(-rate * time)


def _push(surface: Surface, dampers: Sequence[float], depth: float, speed: float) -> float:
    """Return the force at a depth, below zero where it would pull: arms are held together."""
    if surface.element is None:
        assert isinstance(surface.law, AbstractNonlinearLaw)
        return surface.law.push(depth, speed)
    each = zip(surface.elements, dampers, strict=True)
    return sum(e.k * (depth - damper) + e.c * speed for e, damper in each)
