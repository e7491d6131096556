"""Modes with the corner of the ranges at which they stand."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from nrs_design.loop.constant_parameters import Corner
from nrs_design.loop.spot import Spot
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode


@dataclass(frozen=True, slots=True, eq=False)
class AbstractLocatedMode(ABC):
    """A mode and its corner of the ranges."""

    group: str  # The name that rules of switching know: a controller, or what is done instead
    spot: Spot
    # Name of the environment, or of free motion; empty if the mode is the same in all contacts
    touches: str

    @property
    @abstractmethod
    def A(self) -> RationalMatrix:
        """Its map, or its rates in 1/s."""

    @property
    def name(self) -> str:
        """Its name in certificates."""
        return "/".join(label.text for label in self.spot.labels)

    @property
    def mode(self) -> Mode:
        """The mode, as a proof is about it."""
        return Mode(self.name, self.A)

    @property
    def point(self) -> tuple[str, ...]:
        """Key of the set of corners that enclose a loop together."""
        return tuple(label.text for label in self.spot.labels if label.attained)

    @property
    def corner(self) -> Corner:
        """Ends of the constant parameters, and the rest of the name."""
        varying = (label.text for label in self.spot.labels if not label.constant)
        return Corner(self.name, tuple(varying), dict(self.spot.corner))


@dataclass(frozen=True, slots=True, eq=False)
class MatrixMode(AbstractLocatedMode):
    """A mode that is a matrix alone."""

    matrix: RationalMatrix

    @property
    def A(self) -> RationalMatrix:
        """The matrix."""
        return self.matrix


def grouped(items: Iterable[AbstractLocatedMode]) -> dict[str, list[str]]:
    """Return the names of modes by their groups."""
    groups: dict[str, list[str]] = {}
    for item in items:
        groups.setdefault(item.group, []).append(item.name)
    return groups


def enclosures_of(items: Iterable[AbstractLocatedMode]) -> Iterator[tuple[str, ...]]:
    """Yield the modes that enclose one map or motion together."""
    found: dict[tuple[str, ...], list[str]] = {}
    for item in items:
        found.setdefault(item.point, []).append(item.name)
    yield from (tuple(names) for names in found.values() if len(names) > 1)
