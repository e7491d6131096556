"""What a column is called: a quantity, its unit, and an optional group."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from types import MappingProxyType

# Newtons in a kilogram-force, exactly.
KGF = 9.80665
_TURN = 2 * pi / 60

_FORCES = {
    "N": 1.0,
    "mN": 1e-3,
    "uN": 1e-6,
    "kN": 1e3,
    "kgf": KGF,
    "gf": KGF / 1000,
    "lbf": 0.45359237 * KGF,
}
_TORQUES = {"Nm": 1.0, "mNm": 1e-3, "Nmm": 1e-3}
_COMMANDS = {
    "rpm": 1.0,
    "rad_s": 1 / _TURN,
    "deg_s": 1 / 6,
    "V": 1.0,
    "mV": 1e-3,
    "A": 1.0,
    "mA": 1e-3,
    "counts": 1.0,
}
_ANGLES = {"rad": 1.0, "mrad": 1e-3, "deg": pi / 180}

# Factor to SI for every unit that a quantity may be written in; the first is the SI unit. A command
# stays in the unit of its driver: rpm of a command are a number, not a velocity. One that is a
# velocity is read in rpm.
UNITS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0},
        "deflection": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": 0.0254},
        "force": _FORCES,
        "angle": _ANGLES,
        "torque": _TORQUES,
        "velocity": {"rad_s": 1.0, "deg_s": pi / 180, "rpm": _TURN},
        "command": _COMMANDS,
        "mode": {"": 1.0},
        "input": {"any": 1.0},
        "output": {"any": 1.0},
        "frequency": {"hz": 1.0, "khz": 1e3},
        "magnitude": {"db": 1.0},
        "phase": {"deg": pi / 180, "rad": 1.0},
    }
)
# The unit that values of a command have once they are read.
_READ_AS = {"rad_s": "rpm", "deg_s": "rpm", "mV": "V", "mA": "A"}
_SYNONYMS = {
    "load": "force",
    "displacement": "deflection",
    "extension": "deflection",
    "indentation": "deflection",
    "moment": "torque",
    "speed": "velocity",
}
# What a letter or a loose word stands for, if its unit fits: a position in deg is an angle. A full
# word beside it goes first, and of two of these the user chooses.
_SYMBOLS: Mapping[str, tuple[str, ...]] = {
    "t": ("time", "torque"),
    "f": ("force",),
    "m": ("torque",),
    "position": ("deflection", "angle"),
    "pos": ("deflection", "angle"),
    "disp": ("deflection",),
    **dict.fromkeys(("x", "y", "z", "d", "s", "delta"), ("deflection",)),
    **dict.fromkeys(("phi", "theta", "alpha"), ("angle",)),
    **dict.fromkeys(("w", "omega"), ("velocity",)),
}
# How other programs spell a unit, in small letters without blanks.
_SPELLINGS = {
    "sec": "s",
    "second": "s",
    "seconds": "s",
    "msec": "ms",
    "usec": "us",
    "µs": "us",
    "nsec": "ns",
    "µm": "um",
    "inch": "in",
    "µn": "uN",
    "n": "N",
    "newton": "N",
    "newtons": "N",
    "n*m": "Nm",
    "n-m": "Nm",
    "n.m": "Nm",
    "°": "deg",
    "degree": "deg",
    "degrees": "deg",
    "radians": "rad",
    "rad/s": "rad_s",
    "deg/s": "deg_s",
    "°/s": "deg_s",
    "rev/min": "rpm",
    "1/min": "rpm",
    "volt": "V",
    "volts": "V",
    "pwm": "counts",
    "kilonewton": "kN",
    "kp": "kgf",
}
_BRACKETED = re.compile(r"^(?P<what>[^\[\](){}]+?)\s*[\[({](?P<unit>[^\[\](){}]*)[\])}]$")
_SLASHED = re.compile(r"^(?P<what>[A-Za-z ]+?)\s*[/,]\s*(?P<unit>\S+)$")
# Endings of foreign names that may be a unit, and are as often a minimum, a motor or a sensor A.
_NO_ENDINGS = frozenset({"", "any", "s", "m", "min", "in", "A"})
# Units in brackets that none of our quantities has: what says one is not to be taken for ours.
_FOREIGN = frozenset({"g", "kg", "lb", "oz", "nN", "nm", "ft", "Pa", "kPa", "MPa", "%", "h"})
# Of messages in bags that were turned into text; nanoseconds since 1970.
_STAMP = re.compile(r"(^%time|(^|[./_])stamp)$")
_PLOTTED_TIME = "__time"


@dataclass(frozen=True, slots=True)
class Name:
    """A name, taken apart."""

    quantity: str  # Of `UNITS`
    unit: str  # As written, or as we write it where that is known
    group: str = ""  # Suffix, empty for none
    loose: bool = False  # Whether it is a letter or a word that may mean something else, too

    @property
    def known(self) -> bool:
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
    """Take a name apart: ``angle_rad_2``, ``Force [N]``, ``Load (kN)``, ``Time/s``, ``t, s``.

    None if it names no quantity of ours; its unit may be unknown or empty.
    """
    text = text.strip()
    bracketed = _BRACKETED.match(text) or _SLASHED.match(text)
    if bracketed:
        what, unit = bracketed["what"].strip().lower(), bracketed["unit"]
        quantity = what if what in UNITS else _SYNONYMS.get(what)
        return Name(quantity, read_unit(unit, quantity)) if quantity else _symbol(what, unit)
    word, underscore, rest = text.partition("_")
    if word.lower() in UNITS:
        return Name(word.lower(), *(_unit_and_group(rest, word.lower()) if underscore else ("",)))
    quantity = _SYNONYMS.get(word.lower())
    # A synonym counts only with its unit.
    if not rest:
        return None
    if quantity is None:
        return _symbol(word.lower(), rest) if word.lower() == "t" else None
    name = Name(quantity, *_unit_and_group(rest, quantity))
    return name if name.known else None


def _symbol(word: str, unit: str) -> Name | None:
    """Return what a letter stands for by its unit; the time of any clock is a time."""
    quantities = ("time",) if word.endswith(" time") else _SYMBOLS.get(word, ())
    names = (Name(q, read_unit(unit, q), loose=True) for q in quantities)
    return next((name for name in names if name.known), None)


def read_stamp(text: str) -> Name | None:
    """Take a time stamp of a bag for a time, such as ``%time`` or ``/force.header.stamp``."""
    if text == _PLOTTED_TIME:
        return Name("time", "s")
    return Name("time", "ns") if _STAMP.search(text) else None


def read_unit(text: str, quantity: str) -> str:
    """Return our name of a unit, or the text itself if it is not known."""
    plain = text.strip().replace("μ", "µ").replace("·", "*").replace("⋅", "*")
    if plain in UNITS[quantity]:
        return plain
    found = _SPELLINGS.get(plain.lower().replace(" ", ""), plain)
    return {"Hz": "hz", "kHz": "khz", "dB": "db"}.get(found, found)


def stated_unit(text: str, quantity: str) -> str | None:
    """Return the known unit in a foreign name such as ``Weg [mm]`` or ``load_kN``, or None."""
    known = {unit for units in UNITS.values() for unit in units}
    bracketed = _BRACKETED.match(text.strip()) or _SLASHED.match(text.strip())
    if bracketed:
        unit = read_unit(bracketed["unit"], quantity)
        return unit if unit in (known - {""}) | _FOREIGN else None
    words = text.strip().split("_")
    endings = (read_unit("_".join(words[-n:]), quantity) for n in (2, 1) if len(words) > n)
    return next((unit for unit in endings if unit in known - _NO_ENDINGS), None)


def _unit_and_group(rest: str, quantity: str) -> tuple[str, str]:
    """Split at the longest unit that fits: ``rad_s_2`` is rad/s of group 2."""
    for unit in sorted(filter(None, UNITS[quantity]), key=len, reverse=True):
        if rest == unit or rest.startswith(f"{unit}_"):
            return unit, rest[len(unit) + 1 :]
    unit, _, group = rest.partition("_")
    return read_unit(unit, quantity), group
