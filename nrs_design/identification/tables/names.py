"""Names of columns: a quantity and its unit."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from types import MappingProxyType

# Newtons in a kilogram-force, exactly.
KGF = 9.80665
_TURN = 2 * pi / 60

# Factor to SI for every unit that a quantity may be written in; the first is the SI unit. A command
# stays in the unit of its driver: rpm of a command are a number, not a velocity. One that is a
# velocity is read in rpm.
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
        },
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
# Quantities of other words and letters, if their unit fits: a position in deg is an angle.
_WORDS: Mapping[str, tuple[str, ...]] = {
    "t": ("time", "torque"),
    **dict.fromkeys(("load", "f"), ("force",)),
    **dict.fromkeys(("moment", "m"), ("torque",)),
    **dict.fromkeys(("speed", "w", "omega"), ("velocity",)),
    **dict.fromkeys(("position", "pos"), ("deflection", "angle")),
    **dict.fromkeys(("displacement", "extension", "indentation", "disp"), ("deflection",)),
    **dict.fromkeys(("x", "y", "z", "d", "s", "delta"), ("deflection",)),
    **dict.fromkeys(("phi", "theta", "alpha"), ("angle",)),
}
# Words that count before an underscore, too, or above a unit; letters there may mean anything.
FULL_WORDS = frozenset({"t", "load", "moment", "speed", "displacement", "extension", "indentation"})
# Units as other programs spell them, in small letters without blanks.
_SPELLINGS = {
    **dict.fromkeys(("sec", "second", "seconds"), "s"),
    **{"msec": "ms", "usec": "us", "µs": "us", "nsec": "ns"},
    **{"µm": "um", "inch": "in", "µn": "uN", "kilonewton": "kN", "kp": "kgf"},
    **dict.fromkeys(("n", "newton", "newtons"), "N"),
    **dict.fromkeys(("n*m", "n-m", "n.m"), "Nm"),
    **dict.fromkeys(("°", "degree", "degrees"), "deg"),
    **{"radians": "rad", "rad/s": "rad_s", "deg/s": "deg_s", "°/s": "deg_s"},
    **{"rev/min": "rpm", "1/min": "rpm", "volt": "V", "volts": "V", "pwm": "counts"},
    **{"hz": "hz", "khz": "khz", "db": "db"},
}
_BRACKETED = re.compile(r"^(?P<what>[^\[\](){}]+?)\s*[\[({](?P<unit>[^\[\](){}]*)[\])}]$")
_SLASHED = re.compile(r"^(?P<what>[A-Za-z ]+?)\s*[/,]\s*(?P<unit>\S+)$")
# Endings of foreign names that may be a unit, and are as often a minimum, a motor or a sensor A.
_NO_ENDINGS = frozenset({"", "any", "s", "m", "min", "in", "A"})
# Units in brackets of other quantities.
_FOREIGN = frozenset({"g", "kg", "lb", "oz", "nN", "nm", "ft", "Pa", "kPa", "MPa", "%", "h"})


@dataclass(frozen=True, slots=True)
class Name:
    """A name, taken apart."""

    quantity: str  # Of `UNITS`
    unit: str  # In standard spelling if known, else as written

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
    """Take a name apart: ``angle_rad``, ``Force [N]``, ``Load (kN)``, ``Time/s``, ``t, s``.

    None if it names no quantity of ours; the unit of one in its full name may be unknown or empty.
    """
    text = text.strip()
    bracketed = _BRACKETED.match(text) or _SLASHED.match(text)
    what, _, rest = text.partition("_")
    if bracketed:
        what, rest = bracketed["what"].strip(), bracketed["unit"]
    word = what.lower()
    # The time of any clock is a time.
    quantities = ("time",) if word.endswith(" time") else _WORDS.get(word, ())
    if word in UNITS:
        quantities = (word,)
    elif not bracketed and word not in FULL_WORDS:
        return None
    names = [Name(q, read_unit(rest, q)) for q in quantities]
    # Another word counts only with its unit.
    return next((name for name in names if name.known or word in UNITS), None)


def read_unit(text: str, quantity: str) -> str:
    """Return our name of a unit, or the text itself if it is not known."""
    plain = text.strip().replace("μ", "µ").replace("·", "*").replace("⋅", "*")
    if plain in UNITS[quantity]:
        return plain
    return _SPELLINGS.get(plain.lower().replace(" ", ""), plain)


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
