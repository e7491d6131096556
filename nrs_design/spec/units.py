"""A small exact table of units: each is a rational factor, a power of pi and a dimension.

A table of our own, because pint takes the radian for dimensionless (so that a rotational stiffness
passes as a torque) and turns 10 Hz into 10 rad/s, and takes 0.4 s to load. Here ``rad`` is a base
dimension and ``Hz`` is 2 pi rad/s. What a motor driver takes as its command (``rpm``, ``V``, ``A``
or ``counts``) is a base unit of its own each time: no gain passes for one of another driver.
"""

from __future__ import annotations

import ast
import difflib
import functools
import re
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.errors import SpecError
from nrs_design.models.axis import COMMAND_UNITS
from nrs_design.proof.text import quoted
from nrs_design.spec.algebra import Operators, read_algebra

# Unit of the thesis, and of a spec that names none.
THESIS_COMMAND = "rpm"
BASE_UNITS = ("kg", "m", "s", "rad", *COMMAND_UNITS)
MAX_UNIT_LENGTH = 60
MAX_UNIT_EXPONENT = 9

_SYMBOL = re.compile(r"[A-Za-z]+")
_RANGED = "{nominal: ..., range: [lowest, highest]}"
_STRANGE = {
    **dict.fromkeys(("±", "+-"), f"write {_RANGED}"),
    "%": f"write numbers in the unit; a tolerance is {_RANGED}",
    **dict.fromkeys("·⋅×", "write a product with '*'"),
    "°": "write deg for degrees",
    "²": "write ^2 for a square",
    "³": "write ^3 for a cube",
    **dict.fromkeys("µμ", "write the number in the unit without the prefix"),
}
# Other spellings of units; spellings with other capitals are not listed.
_OTHER_WORDS = (
    "Nm=N*m Nms=N*m*s kgm=kg*m sec=s second=s seconds=s degree=deg degrees=deg radian=rad "
    "radians=rad newton=N meter=m volt=V ampere=A PWM=counts"
)
_LIKELY = dict(pair.split("=") for pair in _OTHER_WORDS.split())


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as ``factor * pi**pi_power`` times a product of base units."""

    factor: Fraction  # Rational part of the factor to SI
    pi_power: int  # Power of pi in the factor: 1 for ``deg`` and ``Hz``
    dimension: tuple[int, ...]  # Exponents of the base units

    def times(self, other: Unit, power: int = 1) -> Unit:
        """Multiply by the ``power``-th power of another unit."""
        return Unit(
            self.factor * other.factor**power,
            self.pi_power + power * other.pi_power,
            tuple(a + power * b for a, b in zip(self.dimension, other.dimension, strict=True)),
        )


def _unit(factor: Fraction | int = 1, pi_power: int = 0, **powers: int) -> Unit:
    """Return a unit, by its factor and the powers of base units."""
    return Unit(Fraction(factor), pi_power, tuple(powers.get(unit, 0) for unit in BASE_UNITS))


ONE = _unit()
UNITS = {
    "m": _unit(m=1),
    "cm": _unit(Fraction(1, 100), m=1),
    "mm": _unit(Fraction(1, 1000), m=1),
    "kg": _unit(kg=1),
    "g": _unit(Fraction(1, 1000), kg=1),
    "s": _unit(s=1),
    "ms": _unit(Fraction(1, 1000), s=1),
    "min": _unit(60, s=1),
    "rad": _unit(rad=1),
    "mrad": _unit(Fraction(1, 1000), rad=1),
    "deg": _unit(Fraction(1, 180), 1, rad=1),
    "N": _unit(kg=1, m=1, s=-2),
    "J": _unit(kg=1, m=2, s=-2),
    "mJ": _unit(Fraction(1, 1000), kg=1, m=2, s=-2),
    "W": _unit(kg=1, m=2, s=-3),
    "mW": _unit(Fraction(1, 1000), kg=1, m=2, s=-3),
    "mN": _unit(Fraction(1, 1000), kg=1, m=1, s=-2),
    "kN": _unit(1000, kg=1, m=1, s=-2),
    "Hz": _unit(2, 1, rad=1, s=-1),
    "kHz": _unit(2000, 1, rad=1, s=-1),
    "rpm": _unit(rpm=1),
    "V": _unit(V=1),
    "mV": _unit(Fraction(1, 1000), V=1),
    "A": _unit(A=1),
    "mA": _unit(Fraction(1, 1000), A=1),
    "counts": _unit(counts=1),
}


def command_unit(dimension: tuple[int, ...]) -> str:
    """Return the unit of commands for a dimension that contains the command."""
    powers = zip(BASE_UNITS, dimension, strict=True)
    held = next((unit for unit, power in powers if unit in COMMAND_UNITS and power), None)
    return held or next(
        unit
        for unit in ("N*m", "N", "rad/s", "m/s", "rad", "m")
        if parse_unit(unit).dimension == dimension
    )


@functools.lru_cache(maxsize=256)
def parse_unit(text: str) -> Unit:
    """Read a unit such as ``N*m*s/rad`` or ``rad/(N*m)``, of at most 60 ASCII characters.

    Products are written ``*``, quotients ``/`` (from left to right), integer powers ``^``. A
    `SpecError` if a symbol is unknown or the text is no product of units.
    """
    if len(text) > MAX_UNIT_LENGTH:
        raise SpecError(f"the unit {quoted(text)} is too long", remedy="write it in base units")
    for character, remedy in _STRANGE.items():
        if character in text:
            raise SpecError(f"the unit {quoted(text)} holds {character!r}", remedy=remedy)

    def read(symbol: str) -> Unit:
        if symbol == "1":
            return ONE
        if symbol.isdigit():
            raise ValueError(f"{symbol} is no unit")
        if symbol not in UNITS:
            raise _unknown(symbol, text)
        return UNITS[symbol]

    try:
        if " " in text:
            raise ValueError("no unit has spaces")
        return read_algebra(text, _SYMBOL, read, _OPERATORS, _to_power)
    except ValueError:
        remedy = "write products with *, quotients with / and powers with ^, such as N*m*s/rad"
        raise SpecError(f"{quoted(text)} is not a unit", remedy=remedy) from None


def _to_power(unit: Unit, exponent: int) -> Unit:
    """Return a power of a unit, which may be a power itself: the factor stays of a size."""
    if abs(exponent) > MAX_UNIT_EXPONENT or not 1e-60 < unit.factor < 1e60:
        message = f"the unit has an exponent beyond +-{MAX_UNIT_EXPONENT}"
        raise SpecError(message, remedy="check the exponent")
    return ONE.times(unit, exponent)


_OPERATORS: Operators[Unit] = {
    ast.Mult: Unit.times,
    ast.Div: lambda a, b: a.times(b, -1),
}


def has_unknown(text: str) -> bool:
    """Tell whether a unit has symbols that are none."""
    return not UNITS.keys() >= {*_SYMBOL.findall(text)}


def guess_unit(symbol: str) -> str | None:
    """Return the unit that an unknown symbol probably means."""
    alike = [unit for unit in UNITS if unit.lower() == symbol.lower()]
    near = alike or difflib.get_close_matches(symbol, UNITS, n=1)
    return _LIKELY.get(symbol) or (near[0] if near else None)


def _unknown(symbol: str, text: str) -> SpecError:
    guess, known = guess_unit(symbol), "known units are " + " ".join(UNITS)
    remedy = f"did you mean {guess}? {known}" if guess else known
    within = "" if symbol == text else f" in {quoted(text)}"
    return SpecError(f"unknown unit {quoted(symbol)}{within}", remedy=remedy)
