"""Sizes that no surgical or co-worker robot has: one table for all quantities of a spec.

What lies outside is valid and probably a slip of the unit, which the same table names: the same
number in another unit that would lie within. The ranges are wide, so that what is doubted here is
out of the question by an order of magnitude or more.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from nrs_design.spec.model import SpecModel
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.units import parse_unit


@dataclass(frozen=True, slots=True)
class Size:
    """What sizes of a quantity are plausible."""

    unit: str  # SI unit of the range, which tells the quantity
    # low, high: least and largest size; zero is never doubted, and signs do not count.
    low: float
    high: float
    # Units in which the same number may have been meant, the likeliest first.
    slips: tuple[str, ...] = ()
    # Keys of a spec that it is about; empty for all others in this unit.
    fields: frozenset[str] = frozenset()

    def holds(self, value: float) -> bool:
        """Tell whether a value in SI is plausible."""
        return value == 0 or self.low <= abs(value) <= self.high

    def doubt(self, value: float, number: str, unit: str) -> str | None:
        """Ask about a value that is not plausible; None for one that is.

        Parameters
        ----------
        value : float
            In SI.
        number, unit : str
            As written.
        """
        if self.holds(value):
            return None
        written = float(parse_unit(unit).factor) * math.pi ** parse_unit(unit).pi_power
        meant = []
        for slip in self.slips:
            other = parse_unit(slip)
            if self.holds(value / written * float(other.factor) * math.pi**other.pi_power):
                meant.append(f"{number} {slip}")
        if meant:
            return f"is that its unit? did you mean {' or '.join(meant[:2])}?"
        return f"is that its unit? {self.low:g} {self.unit} to {self.high:g} {self.unit} is usual"


@lru_cache(maxsize=1)
def sizes() -> tuple[Size, ...]:
    """Return the table: of the rows in one unit, those that name a field go before the others."""
    return tuple(_sizes())


def _sizes() -> Iterator[Size]:
    time, length, angle = ("ms", "s", "min"), ("mm", "cm", "m"), ("deg", "mrad", "rad")
    turning, torque = ("deg/s", "rad/s"), ("mN*m", "N*mm", "N*m", "kN*m")
    inertia = ("g*m^2", "kg*cm^2", "g*cm^2", "kg*mm^2", "kg*m^2")

    def row(unit: str, low: float, high: float, slips: tuple[str, ...], fields: str = "") -> Size:
        return Size(unit, low, high, slips, frozenset(fields.split()))

    yield row("s", 1e-4, 1, time, "time_constant")
    yield row("s", 1e-5, 1, time, "period outer_period sample_period")
    yield row("s", 1e-6, 2, time, "age delay min_delay_margin")
    yield row("s", 1e-3, 120, time, "settling_time")
    yield row("s", 2e-5, 0.999, ("ms", "min"), "recorded_step")
    yield row("s", 1e-6, 1e7, time)
    yield row("m", 2e-3, 2, length, "lever_arm")
    yield row("m", 1e-6, 0.5, length, "about preload")
    yield row("m", 1e-6, 2, length, "center_of_mass x y z")
    yield row("m", 1e-5, 0.5, length, "recorded_deflection")
    yield row("m", 1e-6, 10, length)
    yield row("rad", 1e-5, math.pi, angle, "about preload")
    yield row("rad", 1e-4, math.pi, angle, "recorded_angle")
    yield row("rad", 1e-9, 20, angle)
    yield row(
        "N/m", 0.05, 1e7, ("N/mm", "kN/m", "N/m"), "stiffness parallel_stiffness series_stiffness"
    )
    yield row("N/m", 1e-3, 1e9, ("N/mm", "kN/m", "N/m"))
    yield row("N*m/rad", 1e-4, 1e6, ("N*mm/rad", "kN*m/rad", "N*m/rad"))
    yield row("N*s/m", 1e-5, 1e7, ("N*s/mm", "kN*s/m", "N*s/m"))
    yield row("N*m*s/rad", 1e-6, 1e4, ("mN*m*s/rad", "N*mm*s/rad", "N*m*s/rad"))
    yield row("N*m*s", 1e-6, 1e4, ("mN*m*s", "N*mm*s", "N*m*s"))
    yield row("kg", 2e-3, 300, ("g", "kg"), "mass payload")
    yield row("kg", 1e-4, 300, ("g", "kg"))
    yield row("kg*m^2", 1e-11, 1, inertia, "rotor_inertia axis_inertia")
    yield row("kg*m^2", 1e-11, 300, inertia)
    yield row("kg*m^2/rad", 1e-11, 300, ("g*m^2/rad", "kg*m^2/rad"))
    yield row("N", 0.02, 5e3, ("mN", "kN", "N"), "recorded_force")
    yield row("N", 1e-6, 1e4, ("mN", "N", "kN"))
    yield row("N*m", 1e-4, 2e3, torque, "torque peak_torque wanted_torque initial_force")
    yield row("N*m", 5e-4, 2e3, torque, "recorded_torque")
    yield row("N*m", 1e-9, 2e3, torque)
    yield row("N*m/s", 1e-12, 1e6, ("mN*m/s", "N*m/s"))
    yield row("N^2*m^2*s", 1e-18, 1, ())
    yield row("rad/s", 1e-4, 30, turning, "velocity angular_velocity speed amplitude command")
    yield row("rad/s", 1e-2, 1e5, ("Hz", "kHz", "rad/s"), "bandwidth cutoff frequency")
    yield row("rad/s", 1e-12, 1e3, turning)
    yield row("rad/s^2", 1e-4, 1e5, ("deg/s^2", "rad/s^2"))
    yield row("m/s", 1e-6, 20, ("mm/s", "cm/s", "m/s"))
    yield row("m/s^2", 1e-6, 200, ("mm/s^2", "cm/s^2", "m/s^2"))
    yield row("1/s", 1e-4, 1e6, ())
    # A motor without gears turns 0.1047 rad/s per rpm.
    yield row("rad/s/rpm", 1e-8, 1, ())
    yield row("rad/s/V", 1e-5, 1e4, ("rad/s/V", "rad/s/mV"))
    yield row("rad/s/A", 1e-5, 1e6, ("rad/s/A", "rad/s/mA"))
    yield row("rad/s/counts", 1e-9, 1e3, ())
    yield row("rpm", 1e-3, 1e6, ())
    yield row("V", 1e-6, 1e3, ("mV", "V"))
    yield row("A", 1e-6, 1e3, ("mA", "A"))
    yield row("counts", 1e-3, 1e10, ())
    for unit in ("rpm", "V", "A", "counts"):
        yield row(f"{unit}*s/rad", 1e-9, 1e10, ())
        yield row(f"{unit}/(N*m)", 1e-6, 1e12, ())
    yield row("rad/(N*m)", 1e-7, 1e3, ("mrad/(N*m)", "deg/(N*m)", "rad/(N*m)"))
    yield row("rad/(N*m*s)", 1e-7, 1e5, ("mrad/(N*m*s)", "rad/(N*m*s)"))


@lru_cache(maxsize=1024)
def size_of(field: str, dimension: tuple[int, ...]) -> Size | None:
    """Return the row of the table for a field of a spec; None for a quantity that it lacks.

    Parameters
    ----------
    field : str
        Key in a spec; of a bound or an end of a range, the key above.
    dimension : tuple of int
        Of the quantity.
    """
    rows = [size for size in sizes() if parse_unit(size.unit).dimension == dimension]
    named = (size for size in rows if field in size.fields)
    return next(named, next((size for size in rows if not size.fields), None))


def doubt_size(field: str, value: float, unit: str, number: str | None = None) -> str | None:
    """Ask about a size that is no spec's, such as one that was identified; None if it is plausible.

    Parameters
    ----------
    field : str
        Key that it has, or would have, in a spec.
    value : float
        In SI.
    unit : str
        The SI unit.
    number : str, optional
        As it is shown.
    """
    size = size_of(field, parse_unit(unit).dimension)
    return None if size is None else size.doubt(value, number or f"{value:.4g}", unit)


# Ends of a range, and bounds: they are what the key above says.
_ENDS = frozenset({"nominal", "range", "min", "max"})


def doubt_sizes(spec: SpecModel) -> Iterator[tuple[tuple[str, ...], str]]:
    """Yield fields of a spec with implausible sizes, as keys that lead there, and a question.

    A field is asked about once, by its first size that is not plausible. Where a part of the spec
    has `accept_doubt`, and no doubts of an identification that this is about, nothing is asked.
    """
    yield from _walk(spec, (), "")


def unusual(part: SpecModel) -> tuple[str, ...]:
    """Return what is asked about a part of a spec, accepted or not."""
    return tuple(text for _, text in _parts(part, (), ""))


def _walk(value: object, at: tuple[str, ...], field: str) -> Iterator[tuple[tuple[str, ...], str]]:
    if isinstance(value, Quantity):
        size = size_of(field, value.dimension)
        asked = size and size.doubt(value.si, value.text.split(" ")[0], value.unit)
        if asked:
            yield at, f"{'.'.join(at)} is {value.text}: {asked}"
    elif isinstance(value, SpecModel):
        reason, doubts = (getattr(value, key, None) for key in ("accept_doubt", "doubts"))
        if reason is None or doubts:
            yield from _parts(value, at, field)
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _walk(item, (*at, str(key)), str(key))
    elif isinstance(value, tuple):
        for item in value:
            yield from _once(_walk(item, at, field))


def _parts(
    model: SpecModel, at: tuple[str, ...], field: str
) -> Iterator[tuple[tuple[str, ...], str]]:
    for key in type(model).model_fields:
        ends = key in _ENDS
        value = getattr(model, key)
        yield from _once(_walk(value, at if ends else (*at, key), field if ends else key))


def _once(
    found: Iterator[tuple[tuple[str, ...], str]],
) -> Iterator[tuple[tuple[str, ...], str]]:
    seen = set()
    for at, text in found:
        if at not in seen:
            seen.add(at)
            yield at, text
