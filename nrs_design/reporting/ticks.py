"""Tick labels in full: no offset and no common factor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.ticker import Formatter

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def write_ticks_in_full(figure: Figure) -> None:
    """Replace the formatters of all numeric axes: no offset, no common factor in a corner."""
    from nrs_design.plotting import LogFormatter, ScalarFormatter

    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if isinstance(axis.get_major_formatter(), LogFormatter):
                axis.set_major_formatter(_logarithmic(base_only=True))
                axis.set_minor_formatter(_logarithmic(base_only=False))
            elif isinstance(axis.get_major_formatter(), ScalarFormatter):
                axis.set_major_formatter(_plain())


def in_full(value: float, step: float) -> str:
    """Write a tick with the digits that tell it from its neighbour one step away."""
    if abs(value) < 1e-9 * step:
        return "0"
    exponent = math.floor(math.log10(abs(value)) + 1e-12)
    fine = math.floor(math.log10(step) + 1e-12)
    if -5 < exponent < 7:
        return _trimmed(f"{value:.{max(0, 2 - fine)}f}")
    mantissa = _trimmed(f"{value / 10.0**exponent:.{max(0, exponent - fine + 2)}f}")
    power = f"10{str(exponent).translate(_SUPERSCRIPT)}"
    if mantissa in ("1", "−1"):
        return mantissa.replace("1", power)
    return f"{mantissa}·{power}"


def _trimmed(digits: str) -> str:
    if "." in digits:
        digits = digits.rstrip("0").rstrip(".")
    return digits.replace("-", "−")


def _plain() -> Formatter:
    from nrs_design.plotting import Formatter

    class InFull(Formatter):
        """Writes all ticks at once: to find their distance anew for each would be slow."""

        def format_ticks(self, values: Sequence[float]) -> list[str]:
            distance = float(values[1] - values[0]) if len(values) > 1 else None
            return [in_full(value, distance or abs(value) or 1.0) for value in values]

    return InFull()


def _logarithmic(*, base_only: bool) -> Formatter:
    """Return what writes 0.6, not 6e-1; where the axis spans few decades, between powers, too."""
    from nrs_design.plotting import LogFormatter

    class InPowers(LogFormatter):
        def __call__(self, value: float, pos: int | None = None) -> str:
            return in_full(value, value) if super().__call__(value, pos) else ""

    return InPowers(labelOnlyBase=base_only)
