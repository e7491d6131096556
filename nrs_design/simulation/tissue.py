"""All surfaces of a scenario: their torque on the robot, and what moves by itself in them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from nrs_design.models.contact import AbstractNonlinearLaw
from nrs_design.models.contact.law import Element
from nrs_design.simulation.scenario import Surface


@dataclass
class Tissue:
    """What is touched during a run."""

    surfaces: tuple[Surface, ...]  # Where it begins
    # Times in s at which `note` found a surface met (true) or lost, and its environment.
    contacts: list[tuple[float, str, bool]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin free of contact, with all dampers at rest."""
        self.dampers = [0.0] * len(self.surfaces)
        self.arms = [[0.0] * (1 + len(surface.arms)) for surface in self.surfaces]
        self.touched = [False] * len(self.surfaces)
        self.noted = list(self.touched)
        self.direction = self.surfaces[0].sign if self.surfaces else 1

    @property
    def creeps(self) -> bool:
        """Whether something in it moves by itself."""
        each = (element for s in self.surfaces for element in (s.element, *s.arms))
        return any(element is not None and math.isfinite(element.b) for element in each)

    def depths(self, theta: float) -> list[float]:
        """Return the depth of an angle in rad below every surface."""
        return [surface.sign * (theta - surface.at) for surface in self.surfaces]

    def torque(self, theta: float, omega: float) -> float:
        """Return the torque of all surfaces on the robot in N m: none of them pulls.

        At an angle in rad and a velocity in rad/s.
        """
        total = 0.0
        for j, surface in enumerate(self.surfaces):
            depth = surface.sign * (theta - surface.at) - self.dampers[j]
            push = 0.0
            if depth > 0 and surface.arms:
                push = _pull(surface, self.arms[j], depth, surface.sign * omega)
            elif depth > 0:
                push = _push(surface, depth, surface.sign * omega)
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
        """Move the dampers while the depths, in rad, change evenly within a time in s."""
        for j, (begin, end) in enumerate(zip(before, after, strict=True)):
            element = self.surfaces[j].element
            middle = (begin + end) / 2
            if self.surfaces[j].arms:
                self._creep_together(j, middle, time)
                continue
            if element is None or not math.isfinite(element.b):
                continue
            pushed = element.k if middle > self.dampers[j] else 0.0
            rate = (pushed + element.h) / element.b
            if rate:
                rest = pushed * middle / (pushed + element.h)
                self.dampers[j] = rest + (self.dampers[j] - rest) * math.exp(-rate * time)

    def _creep_together(self, j: int, depth: float, time: float) -> None:
        """Move the dampers of one body, whose surface returns by itself where nothing pushes it."""
        surface, dampers = self.surfaces[j], self.arms[j]
        elements = _elements(surface)
        if _pull(surface, dampers, depth, 0.0) <= 0:
            springs = sum(element.k for element in elements)
            depth = sum(e.k * d for e, d in zip(elements, dampers, strict=True)) / springs
        for i, element in enumerate(elements):
            if math.isfinite(element.b):
                rest = element.k * depth / (element.k + element.h)
                gone = math.exp(-(element.k + element.h) / element.b * time)
                dampers[i] = rest + (dampers[i] - rest) * gone


def _elements(surface: Surface) -> tuple[Element, ...]:
    assert surface.element is not None
    return (surface.element, *surface.arms)


def _pull(surface: Surface, dampers: list[float], depth: float, speed: float) -> float:
    """Return the sum of all arms, below zero where it would pull: they are held together."""
    each = zip(_elements(surface), dampers, strict=True)
    return sum(element.k * (depth - damper) + element.c * speed for element, damper in each)


def _push(surface: Surface, depth: float, speed: float) -> float:
    if surface.element is not None:
        return surface.element.k * depth + surface.element.c * speed
    assert isinstance(surface.law, AbstractNonlinearLaw)
    return surface.law.push(depth, speed)
