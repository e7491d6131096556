"""Options that several ROS 2 commands share, and how ranges are read."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

import typer

from nrs_design.errors import NrsDesignError, SpecError
from nrs_design.ros2.quantities import LAG, Range
from nrs_design.spec.quantity import QuantityKind, parse_quantity

Lag = Annotated[
    str,
    typer.Option(
        metavar="RANGE", help="Time constant with which the robot follows, such as '5..20 ms'."
    ),
]


def read_lag(text: str) -> Range:
    """Return the ends of a range of time constants in s."""
    return range_of("--lag", text, LAG) or (Fraction(0), Fraction(0))


def range_of(option: str, text: str | None, kind: QuantityKind) -> Range | None:
    """Read one quantity, or two with ``..`` between them; None where there is no text."""
    if text is None:
        return None
    remedy = f"write {option} '{kind.example}'"
    numbers, _, unit = text.partition(" ")
    low, _, high = numbers.partition("..")
    try:
        ends = [parse_quantity(f"{n} {unit}".strip(), kind).exact for n in (low, high or low)]
    except SpecError as error:
        raise NrsDesignError(f"{option}: {error.message}", remedy=remedy) from None
    if not 0 <= ends[0] <= ends[1]:
        raise NrsDesignError(
            f"{option}: {text!r} is not a rising range from zero or above", remedy=remedy
        )
    return ends[0], ends[1]
