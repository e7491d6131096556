"""The axis that a spec is about: it turns about a pivot, or slides.

Nothing in the mathematics differs. What is N*m, rad and kg*m^2 of an axis that turns is N, m and kg
of one that slides, so the unit of a quantity follows from that for a rotation.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from enum import StrEnum
from functools import cache

from nrs_design.errors import InternalError
from nrs_design.spec.units import COMMAND_UNITS

# Units of an axis that turns, and of one that slides. Frequencies are in rad/s on both, and none of
# these.
_SLIDING: Mapping[str, str] = {
    "": "",
    "1": "1",
    "s": "s",
    "1/s": "1/s",
    "J": "J",
    "W": "W",
    "rad": "m",
    "rad/s": "m/s",
    "rad/s^2": "m/s^2",
    "deg": "mm",
    "deg/s": "mm/s",
    "N*m": "N",
    "N*m*s": "N*s",
    "N*m/s": "N/s",
    "N*m/rad": "N/m",
    "N*m*s/rad": "N*s/m",
    "N^2*m^2*s": "N^2*s",
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
# How a unit is written: in records, in tables of a terminal, and in pages and figures.
_STYLES = (("*", "^2"), (" ", "^2"), ("\N{MIDDLE DOT}", "\N{SUPERSCRIPT TWO}"))


class Axis(StrEnum):
    """What an axis does."""

    ROTARY = "rotary"
    PRISMATIC = "prismatic"

    def unit(self, turning: str) -> str:
        """Return the unit of a quantity of the axis.

        Parameters
        ----------
        turning : str
            That of an axis that turns, in any of the ways that units are written here.

        Raises
        ------
        InternalError
            If that is none of the known ones.
        """
        if turning not in _every():
            raise InternalError(f"{turning!r} is no unit of an axis")
        return turning if self is Axis.ROTARY else _every()[turning]

    def named(self, text: str) -> str:
        """Return the name of a state with its unit, such as ``vm [rad/s]``, on this axis."""
        name, bracket, unit = text.partition(" [")
        return f"{name}{bracket}{self.unit(unit[:-1])}]" if bracket else text

    @property
    def fine(self) -> float:
        """How many deg, or mm, are in a unit of its position."""
        return 180 / math.pi if self is Axis.ROTARY else 1000.0


@cache
def _every() -> Mapping[str, str]:
    """Return the units of both in every way they are written."""
    found = {}
    for dot, square in _STYLES:
        for turning, sliding in _SLIDING.items():
            first, last = (u.replace("*", dot).replace("^2", square) for u in (turning, sliding))
            found[first] = last
    return found


_READING: ContextVar[Axis] = ContextVar("axis", default=Axis.ROTARY)


def reading() -> Axis:
    """Return the axis of the spec that is being read, which its quantities are about."""
    return _READING.get()


@contextmanager
def reading_of(axis: object) -> Iterator[None]:
    """Read the quantities of a spec as those of an axis; if it is none, of one that turns.

    Parameters
    ----------
    axis : object
        What the spec says.
    """
    known = axis if axis in [*Axis] else Axis.ROTARY
    token = _READING.set(Axis(str(known)))
    try:
        yield
    finally:
        _READING.reset(token)
