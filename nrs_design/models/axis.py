"""The axis that a spec is about: it turns about a pivot, or slides.

Nothing in the mathematics differs. What is N*m, rad and kg*m^2 of an axis that turns is N, m and kg
of one that slides, so the unit of a quantity follows from that for a rotation.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar, Token
from enum import StrEnum
from functools import cache

from nrs_design.errors import InternalError

# Units of motor commands.
COMMAND_UNITS = ("rpm", "V", "A", "counts")
COMMON_UNITS = ("", "1", "s", "1/s", "J", "Hz", "%", "N", "N/m", "ms", "samples", "decades", "W")
# Units on a rotary axis, and the units on a prismatic axis. Frequencies stay in rad/s: the table
# does not hold them.
_SLIDING: Mapping[str, str] = {
    **{same: same for same in COMMON_UNITS},
    "rad": "m",
    "rad/s": "m/s",
    "rad/s^2": "m/s^2",
    "deg/s^2": "mm/s^2",
    "deg": "mm",
    "deg/s": "mm/s",
    "N*m": "N",
    "N*m*s": "N*s",
    "N*m/s": "N/s",
    "N*m/rad": "N/m",
    "N*m*s/rad": "N*s/m",
    "kg*m^2": "kg",
    "rad/(N*m)": "m/N",
    "rad/(N*m*s)": "m/(N*s)",
    "rad/(s*N*m)": "m/(s*N)",
    **{
        turning.format(command): sliding.format(command)
        for command in COMMAND_UNITS
        for turning, sliding in (
            ("{}", "{}"),
            ("rad/s/{}", "m/s/{}"),
            ("{}/rad", "{}/m"),
            ("{}*s/rad", "{}*s/m"),
        )
    },
    "N*m*s/rad/(N*m)": "s/m",
}
# Product and square in records, in tables of a terminal, and in pages and figures.
_STYLES = (("*", "^2"), (" ", "^2"), ("\N{MIDDLE DOT}", "\N{SUPERSCRIPT TWO}"))


class AxisType(StrEnum):
    """What an axis does."""

    ROTARY = "rotary"
    PRISMATIC = "prismatic"

    def unit(self, turning: str) -> str:
        """Return the unit of a quantity on this axis, given the unit on a rotary axis."""
        if turning not in _unit_table():
            raise InternalError(f"{turning!r} is no unit of an axis")
        return turning if self is AxisType.ROTARY else _unit_table()[turning]

    def label(self, text: str) -> str:
        """Return a name with its unit in brackets, such as ``vm [rad/s]``, on this axis."""
        name, opened, tail = text.partition(" [")
        unit_text, closed, suffix = tail.partition("]")
        return f"{name}{opened}{self.unit(unit_text)}{closed}{suffix}" if opened else text

    @property
    def fine(self) -> float:
        """How many deg, or mm, are in a unit of its position."""
        return 180 / math.pi if self is AxisType.ROTARY else 1000.0


@cache
def _unit_table() -> Mapping[str, str]:
    """Return the units of both in every way they are written."""
    found = {}
    for dot, square in _STYLES:
        for turning, sliding in _SLIDING.items():
            first, last = (u.replace("*", dot).replace("^2", square) for u in (turning, sliding))
            found[first] = last
    return found


def find_axis(states: Iterable[str]) -> AxisType:
    """Return the axis whose states have these names: one that slides, if one of them is in m."""
    units = {text.partition(" [")[2] for text in states}
    return AxisType.PRISMATIC if units & {"m]", "m/s]"} else AxisType.ROTARY


# Axis of the current spec. Texts about gains read their units here.
_CURRENT: ContextVar[AxisType] = ContextVar("axis", default=AxisType.ROTARY)


def current() -> AxisType:
    """Return the axis that quantities and words are about, of `about`; else one that turns."""
    return _CURRENT.get()


def unit(turning: str) -> str:
    """Return the unit on the `current` axis, given the unit on a rotary axis."""
    return current().unit(turning)


def labelled(text: str) -> str:
    """Return a label with its unit in brackets, on the `current` axis."""
    return current().label(text)


def take(axis: object) -> Token[AxisType]:
    """Make an axis the `current` one, until an enclosing `about` ends; others count as rotary."""
    return _CURRENT.set(AxisType(str(axis)) if axis in [*AxisType] else AxisType.ROTARY)


@contextmanager
def axis_context(axis: object) -> Iterator[None]:
    """Set the `current` axis inside a context; unknown values select a rotary axis."""
    token = take(axis)
    try:
        yield
    finally:
        _CURRENT.reset(token)
