"""Times on a command line: seconds as a number, or with a unit as in a spec."""

from __future__ import annotations

from collections.abc import Callable

import typer


def seconds(low: float = 0.0, high: float = float("inf")) -> Callable[[str], float]:
    """Return what reads a time for an option, ``0.001`` or ``1 ms``, between two times in s.

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
