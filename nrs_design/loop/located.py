"""Modes that know what they are corners of: nobody reads that from their names."""

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
    """One mode, with what it is a corner of."""

    group: str  # The name that rules of switching know: a controller, or what is done instead
    spot: Spot
    touches: str  # The environment that it is about; free motion; or nothing, where none matters

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
        """What it is a corner of, with others: of them all, one loop is attained."""
        return tuple(label.text for label in self.spot.labels if label.attained)

    @property
    def corner(self) -> Corner:
        """At which ends of the constant numbers it is, and what else its name says."""
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
