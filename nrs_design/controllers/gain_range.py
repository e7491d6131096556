"""Where a gain may be while the robot runs: the designed value, or the range around it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from nrs_design.controllers.float32 import exact_decimal, to_float32
from nrs_design.models.interval import Interval
from nrs_design.spec import ControllerSpec, GainSpec


def gain_interval(gain: GainSpec, shipped: Fraction) -> Interval:
    """Return the interval that the proof covers.

    A robot holds single-precision numbers. The declared range is widened to those that its ends
    round to: rounding is monotonic, so whatever value of the range is set on the robot, the number
    that it then holds is inside.

    Parameters
    ----------
    gain : GainSpec
        With its range in SI units, if it declares one.
    shipped : Fraction
        The designed gain, a single-precision number; the nominal value of the interval.

    Returns
    -------
    Interval
        The point `shipped` if the spec declares no range.
    """
    if gain.range is None or not gain.ranged:
        return Interval.point(shipped)
    low, high = (end.exact for end in gain.range)
    return Interval(shipped, min(low, to_float32(low)), max(high, to_float32(high)))


def faults_of_ranges(
    controller: ControllerSpec, gains: Mapping[str, Fraction]
) -> Iterator[tuple[str, str]]:
    """Name the designed gains outside the range that the proof would cover, and say how far.

    Parameters
    ----------
    controller : ControllerSpec
        What the spec says.
    gains : mapping
        The designed gains by name.
    """
    for name, gain in controller.gains().items():
        shipped = gains[name]
        if gain.range is None:
            continue
        low, high = (end.exact for end in gain.range)
        if not min(low, to_float32(low)) <= shipped <= max(high, to_float32(high)):
            ends = ", ".join(end.text for end in gain.range)
            designed = f"the designed {name}, {exact_decimal(shipped)}"
            yield name, f"{designed}, is outside its range [{ends}]"
