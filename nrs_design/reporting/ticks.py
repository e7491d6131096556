"""Tick labels in full: no offset and no common factor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.ticker import Formatter

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# Labels of a logarithmic axis by how many times its low end the high end is.
_DIGITS = ((30.0, (1, 2, 3, 4, 6)), (200.0, (1, 3)))


def write_ticks_in_full(figure: Figure) -> None:
    """Replace the formatters of all numeric axes: no offset, no common factor in a corner."""
    from nrs_design.plotting import LogFormatter, ScalarFormatter

    for axes in figure.axes:
        for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            if isinstance(axis.get_major_formatter(), LogFormatter):
                _write_logarithmic(axis, *sorted(limits))
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


def power_of_ten(value: float) -> str:
    """Write a power of ten, from a thousandth to a thousand as a plain number."""
    exponent = round(math.log10(value))
    return f"{value:.15g}" if abs(exponent) <= 3 else f"10{str(exponent).translate(_SUPERSCRIPT)}"


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


def _write_logarithmic(axis: Axis, low: float, high: float) -> None:
    """Write 0.6 rather than 6 times a power of ten where the axis spans few decades."""
    from nrs_design.plotting import FuncFormatter, NullFormatter

    digits = next((digits for span, digits in _DIGITS if high <= span * low), None)
    if digits is None:
        axis.set_major_formatter(FuncFormatter(lambda value, _: power_of_ten(value)))
        axis.set_minor_formatter(NullFormatter())
        return

    def text(value: float, position: int | None) -> str:
        digit = value / 10.0 ** math.floor(math.log10(value) + 1e-9)
        # On a short axis, the ticks are chosen as on a linear one, and all are written.
        wanted = high < 3 * low or min(abs(digit - d) for d in digits) < 0.01
        return in_full(value, high - low) if wanted else ""

    axis.set_major_formatter(FuncFormatter(text))
    axis.set_minor_formatter(FuncFormatter(text))
