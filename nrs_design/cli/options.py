"""Arguments and options that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Annotated

import typer


def read_work(text: str) -> float:
    """Read a budget of work for an option; raises `typer.BadParameter` on anything else."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not value >= 0:
        raise typer.BadParameter(
            f"{text!r} is no budget: give units of work, such as 60, each of about a second"
        )
    return value


def seconds(low: float = 0.0, high: float = float("inf")) -> Callable[[str], float]:
    """Return a reader of times, ``0.001`` or ``1 ms``, between two bounds in s.

    It raises `typer.BadParameter` on anything else.
    """

    def read(text: str) -> float:
        value = _number(str(text))
        if not low <= value <= high:
            limits = f"at least {low:g} s" if high == float("inf") else f"{low:g} to {high:g} s"
            raise typer.BadParameter(f"{text!r} is out of range: {limits}")
        return value

    return read


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        pass
    from nrs_design.errors import SpecError
    from nrs_design.spec.quantity import QuantityKind, parse_quantity

    try:
        return parse_quantity(text, QuantityKind("a time", ("s",), "0.001 s")).si
    except SpecError as error:
        hint = f" ({error.remedy})" if error.remedy else ""
        raise typer.BadParameter(
            f"{error.message}{hint}; seconds without a unit, as 0.001, are read too"
        ) from error


def refuse_both(*pairs: tuple[str, str, object], reason: str = "") -> None:
    """Refuse the first pair of options whose third entry is true."""
    from nrs_design.errors import NrsDesignError

    for first, second, are_used in pairs:
        if are_used:
            message = f"{first} and {second} exclude each other{reason}"
            raise NrsDesignError(message, remedy="keep one of them")


SpecFile = Annotated[Path, typer.Argument(metavar="SPEC", help="Spec file (*.nrs.yaml).")]
MaxDegree = Annotated[
    int | None,
    typer.Option(
        min=2,
        max=64,
        help="Highest degree of a polynomial function; default: the spec's, or as the budget "
        "allows.",
    ),
]
Budget = Annotated[
    float | None,
    typer.Option(
        metavar="WORK",
        parser=read_work,
        help="Work of each search, counted in units of about a second, the same on every machine; "
        "default: the spec's, or 60.",
    ),
]
Memory = Annotated[
    float | None, typer.Option(min=0.0, help="Memory for a step of the search in GB; default 2.")
]
Date = Annotated[
    datetime | None,
    typer.Option(
        "--date",
        formats=["%Y-%m-%d"],
        metavar="YYYY-MM-DD",
        help="Write this date on the page; without it there is no date.",
    ),
]
