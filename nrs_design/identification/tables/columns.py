"""Quantities and units of the columns of a file, and layouts of columns."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from types import MappingProxyType

from nrs_design.identification.errors import DataError

# Newtons in a kilogram-force, exactly.
KGF = 9.80665
_TURN = 2 * pi / 60

# Factor to SI for every unit of a quantity; the first unit is the SI unit. A command stays in the
# unit of its driver: rpm of a command are a number, not a velocity. A command in rad/s or deg/s is
# read in rpm.
UNITS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0},
        "deflection": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": 0.0254},
        "force": {
            **{"N": 1.0, "mN": 1e-3, "uN": 1e-6, "kN": 1e3},
            **{"kgf": KGF, "gf": KGF / 1000, "lbf": 0.45359237 * KGF},
        },
        "angle": {"rad": 1.0, "mrad": 1e-3, "deg": pi / 180},
        "torque": {"Nm": 1.0, "mNm": 1e-3, "Nmm": 1e-3},
        "velocity": {"rad_s": 1.0, "deg_s": pi / 180, "rpm": _TURN},
        "command": {
            **{"rpm": 1.0, "rad_s": 1 / _TURN, "deg_s": 1 / 6},
            **{"V": 1.0, "mV": 1e-3, "A": 1.0, "mA": 1e-3, "counts": 1.0},
            **{"rad": 1.0, "deg": pi / 180, "Nm": 1.0},
        },
        "mode": {"": 1.0},
        "input": {"any": 1.0},
        "output": {"any": 1.0},
    }
)
# The unit that values of a command have once they are read.
_READ_AS = {
    **dict.fromkeys(("rad_s", "deg_s"), "rpm"),
    **{"mV": "V", "mA": "A", "deg": "rad", "Nm": "N*m"},
}
# Units as other programs spell them, in small letters.
_SPELLINGS = {
    **dict.fromkeys(("sec", "seconds"), "s"),
    **{"µs": "us", "µm": "um", "µn": "uN", "n": "N"},
    **dict.fromkeys(("n*m", "n m"), "Nm"),
    **{"°": "deg", "rad/s": "rad_s", "deg/s": "deg_s", "°/s": "deg_s", "pwm": "counts"},
}
_BRACKETED = re.compile(r"^(?P<what>[^\[\]()]+?)\s*[\[(](?P<unit>[^\[\]()]*)[\])]$")
# Endings of foreign names that may be a unit, and are as often a minimum, a motor or a sensor A.
_NO_ENDINGS = frozenset({"", "any", "s", "m", "min", "in", "A"})
# Units in brackets of other quantities.
_FOREIGN = frozenset({"g", "kg", "lb", "oz", "nN", "nm", "ft", "Pa", "kPa", "MPa", "%", "h"})
_ALL_UNITS = frozenset(unit for units in UNITS.values() for unit in units)


@dataclass(frozen=True, slots=True)
class Name:
    """A name, taken apart."""

    quantity: str  # Of `UNITS`
    unit: str  # In standard spelling if known, else as written

    @property
    def is_known(self) -> bool:
        """Whether the quantity may be written in this unit."""
        return self.unit in UNITS[self.quantity]

    @property
    def factor(self) -> float:
        """SI value over number in the file."""
        return UNITS[self.quantity][self.unit]

    @property
    def read_as(self) -> str:
        """The unit after multiplication by the factor."""
        if self.quantity == "command":
            return _READ_AS.get(self.unit, self.unit)
        return next(iter(UNITS[self.quantity]))


def standard_name(quantity: str) -> str:
    """Return the name of a column in SI, such as ``force_N``."""
    unit = next(iter(UNITS[quantity]))
    return quantity if unit == "" else f"{quantity}_{unit}"


def read_name(text: str) -> Name | None:
    """Take a name apart: ``angle_rad``, ``Force [N]``, ``Force (kN)``.

    None if it names no quantity of ours; the unit of one that does may be unknown or empty.
    """
    bracketed = _BRACKETED.match(text.strip())
    label, _, unit = text.strip().partition("_")
    if bracketed:
        label, unit = bracketed["what"], bracketed["unit"]
    quantity = label.lower()
    return Name(quantity, _read_unit(unit, quantity)) if quantity in UNITS else None


def _read_unit(text: str, quantity: str) -> str:
    """Return our name of a unit, or the text itself if it is not known."""
    spelling = text.strip().replace("μ", "µ").replace("·", "*")
    return spelling if spelling in UNITS[quantity] else _SPELLINGS.get(spelling.lower(), spelling)


def _stated_unit(text: str, quantity: str) -> str | None:
    """Return the known unit in a foreign name such as ``Weg [mm]`` or ``load_kN``, or None."""
    if bracketed := _BRACKETED.match(text.strip()):
        unit = _read_unit(bracketed["unit"], quantity)
        return unit if unit in (_ALL_UNITS - {""}) | _FOREIGN else None
    endings = (unit for unit in _ALL_UNITS - _NO_ENDINGS if text.endswith(f"_{unit}"))
    return max(endings, key=len, default=None)


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a file: its place, and its factor to SI."""

    index: int  # Counted from 0
    name: str  # In the file
    factor: float  # SI value over number in the file
    unit: str  # The unit that its values have then


def parse_mapping(entries: Sequence[str]) -> dict[str, str]:
    """Read ``OURS=THEIRS`` entries of ``--map``; return standard names by names in the file."""
    mapping: dict[str, str] = {}
    for entry in entries:
        standard, equals, foreign = (part.strip() for part in entry.partition("="))
        if not (standard and equals and foreign):
            raise DataError(f"--map {entry!r} is not a pair", remedy="write --map force_N=Fz")
        _read_standard_name(standard, f"--map {entry!r}: ")
        if foreign in mapping or standard in mapping.values():
            raise DataError(f"--map {entry!r}: the column is mapped twice", remedy="keep one")
        mapping[foreign] = standard
    return mapping


def find_columns(
    header: Sequence[str],
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    optional: tuple[str, ...],
) -> tuple[tuple[str, ...], dict[str, Column]]:
    """Return the first layout that a header has in full, and its columns by quantity.

    What the user has mapped decides between layouts, then their order.
    """
    for foreign, standard in mapping.items():
        _check_mapped(foreign, standard, header)
    quantities_to_find = {quantity for layout in layouts for quantity in layout} | set(optional)
    mapped_quantities = {_read_standard_name(standard).quantity for standard in mapping.values()}
    found: dict[str, Column] = {}
    faults: list[DataError] = []
    for index, text in enumerate(header):
        name = read_name(mapping.get(text, text))
        # A mapped column takes precedence over others with a name of the same quantity.
        if name is None or (text not in mapping and name.quantity in mapped_quantities):
            continue
        quantity = name.quantity
        if quantity not in quantities_to_find:
            continue
        if not name.is_known:
            faults.append(_unknown_unit(name, text))
            # What would be judged must not fall away in silence.
            if quantity in optional:
                raise faults[-1]
        elif quantity in found:
            raise DataError(
                f"the {quantity} is there twice ({found[quantity].name!r} and {text!r})",
                remedy=f"rename one of them, or choose with --map {standard_name(quantity)}=NAME",
            )
        else:
            found[quantity] = Column(index, text, name.factor, name.read_as)
    for layout in sorted(layouts, key=lambda quantities: len(mapped_quantities - set(quantities))):
        if set(layout) <= found.keys():
            layout_quantities = (*layout, *(key for key in optional if key in found))
            return layout, {quantity: found[quantity] for quantity in layout_quantities}
    raise faults[0] if faults else _missing(found, header, layouts)


def _check_mapped(foreign: str, standard: str, header: Sequence[str]) -> None:
    """Refuse a mapping of no column, and one whose unit contradicts the name of its column."""
    if foreign not in header:
        matches = difflib.get_close_matches(foreign, header, n=1)
        hint = f"did you mean {matches[0]!r}?" if matches else f"it has {_header_text(header)}"
        raise DataError(f"there is no column {foreign!r} to map", remedy=hint)
    name = _read_standard_name(standard)
    unit = _stated_unit(foreign, name.quantity)
    if unit in (None, name.unit) or name.unit in ("", "any"):
        return
    remedy = f"map another column; if this is one in {name.unit}, correct its name"
    if unit in UNITS[name.quantity]:
        right = f"{name.quantity}_{unit}"
        remedy = f"write --map '{right}={foreign}', or rename the column if its unit is wrong"
    conflict = f"the column {foreign!r} says {unit}, and {standard} is in {name.unit}"
    raise DataError(f"--map '{standard}={foreign}': {conflict}", remedy=remedy)


def _read_standard_name(text: str, prefix: str = "") -> Name:
    """Take a name of ours apart, and check its unit."""
    name = read_name(text)
    if name is None:
        known = ", ".join(map(standard_name, UNITS))
        raise DataError(f"{prefix}{text!r} is no column of ours", remedy=f"these are {known}")
    if not name.is_known:
        raise _unknown_unit(name, text, prefix)
    return name


def _unknown_unit(name: Name, text: str, prefix: str = "") -> DataError:
    fault = f"has the unit {name.unit!r}" if name.unit else "has no unit"
    units = " or ".join(f"{name.quantity}_{key}" for key in UNITS[name.quantity])
    remedy = f"expected {units}; --map gives a column another name"
    return DataError(f"{prefix}the column {text!r} {fault}", remedy=remedy)


def _missing(
    present: Collection[str], header: Sequence[str], layouts: Sequence[tuple[str, ...]]
) -> DataError:
    nearest = min(layouts, key=lambda layout: len(set(layout).difference(present)))
    missing = [_called(quantity) for quantity in nearest if quantity not in present]
    expected = " or ".join(", ".join(map(_called, layout)) for layout in layouts)
    return DataError(
        f"the columns {', '.join(missing)} are missing: it has {_header_text(header)}",
        remedy=f"expected {expected}, in these units or others; name foreign columns with --map "
        f"{missing[0]}=NAME",
    )


def _called(quantity: str) -> str:
    """Return what a user calls a column: two are named by options."""
    options = {"input": "the column of --command", "output": "the column of --measured"}
    return options.get(quantity) or standard_name(quantity)


def _header_text(header: Sequence[str]) -> str:
    names = [name if len(name) <= 30 else name[:27] + "..." for name in header[:12]]
    return ", ".join(names) + (f" and {len(header) - 12} more" if len(header) > 12 else "")
