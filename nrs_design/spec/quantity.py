"""Quantities: a number with its unit, as written and in SI."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from nrs_design.errors import SpecError
from nrs_design.models.axis import COMMAND_UNITS, AxisType
from nrs_design.proof.text import quoted
from nrs_design.spec.exact import DECIMAL_PATTERN, MAX_LENGTH, RATIO_PATTERN, parse_exact
from nrs_design.spec.units import MAX_UNIT_LENGTH, Unit, guess_unit, has_unknown, parse_unit

# Numbers beyond these are slips, and their products leave the floats.
SMALLEST = 1e-30
LARGEST = 1e30

# Below and above pi, one unit of the last of 30 digits apart.
PI_BETWEEN = (
    Fraction("3.14159265358979323846264338327"),
    Fraction("3.14159265358979323846264338328"),
)
QUANTITY_PATTERN = rf"^(?:{DECIMAL_PATTERN}|{RATIO_PATTERN}) +[A-Za-z1(][A-Za-z0-9*/^()+-]*$"
_GLUED = rf"({DECIMAL_PATTERN})((?![eE][+-]?[0-9])[A-Za-z].*)"


@dataclass(frozen=True, slots=True)
class Quantity:
    """A physical quantity, exact as far as its unit allows."""

    text: str  # As written, such as ``8 deg/s``
    value: Fraction  # The number as written
    unit: str  # The unit as written
    _scale: Unit = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Resolve the unit once."""
        object.__setattr__(self, "_scale", parse_unit(self.unit))

    @property
    def dimension(self) -> tuple[int, ...]:
        """Exponents of the base units."""
        return self._scale.dimension

    @property
    def rational_part(self) -> Fraction:
        """SI value divided by ``pi**pi_power``."""
        return self.value * self._scale.factor

    @property
    def pi_power(self) -> int:
        """Power of pi in the SI value."""
        return self._scale.pi_power

    @property
    def is_exact(self) -> bool:
        """Whether the SI value is rational."""
        return self.pi_power == 0

    @property
    def exact(self) -> Fraction:
        """SI value as a fraction; a ValueError if that is irrational (``deg``, ``Hz``)."""
        if not self.is_exact:
            raise ValueError(f"{self.text!r} is not rational in SI: its unit holds a factor of pi")
        return self.rational_part

    @property
    def not_below(self) -> Fraction:
        """A fraction not below the SI value, and above it only where the unit holds a pi."""
        pi = PI_BETWEEN[(self.pi_power > 0) == (self.value >= 0)]
        return self.rational_part * pi**self.pi_power

    @property
    def not_above(self) -> Fraction:
        """A fraction not above the SI value, and below it only where the unit holds a pi."""
        pi = PI_BETWEEN[(self.pi_power > 0) != (self.value >= 0)]
        return self.rational_part * pi**self.pi_power

    @property
    def si(self) -> float:
        """SI value as a float."""
        return float(self.rational_part) * math.pi**self.pi_power


@dataclass(frozen=True, slots=True)
class QuantityKind:
    """The dimension of a field, and its units."""

    name: str  # For messages, such as ``a rotational stiffness``
    # One unit for each accepted dimension; the first is the SI unit that is shown.
    units: tuple[str, ...]
    example: str  # A quantity of this kind
    # Advice for units that are often written instead; ``{value}`` is the number as written.
    confusions: Mapping[str, str] = field(default_factory=dict)
    reason: str = ""  # Before what is advised else
    # Whether the SI value must be rational, as everything that enters a proof; then units with a
    # factor of pi (``deg``, ``Hz``) are refused.
    rational: bool = True
    # The kind on a sliding axis; None if it is the same.
    sliding: QuantityKind | None = None

    def on(self, axis: AxisType) -> QuantityKind:
        """Return what the field measures on an axis."""
        return self if axis is AxisType.ROTARY else self.sliding or self

    @property
    def si_unit(self) -> str:
        """The SI unit in which values of this kind are shown."""
        return self.units[0]

    def accepts(self, dimension: tuple[int, ...]) -> bool:
        """Whether a quantity of this dimension is of this kind."""
        return any(parse_unit(unit).dimension == dimension for unit in self.units)

    def unit_in(self, dimension: tuple[int, ...]) -> str:
        """Return the unit of a dimension that is accepted."""
        return next(unit for unit in self.units if parse_unit(unit).dimension == dimension)

    def advice(self, value: str, dimension: tuple[int, ...]) -> str:
        """Return the remedy for a quantity with the wrong dimension."""
        for unit, advice in self.confusions.items():
            if parse_unit(unit).dimension == dimension:
                return advice.format(value=value)
        if self.is_about_commands:
            return f"write {written_as(self.units).format(value=value)}"
        return f"{self.reason}write it in {' or '.join(self.units)}{self.example_clause}"

    @property
    def example_clause(self) -> str:
        """An example behind advice; none where its unit depends on the motor."""
        return "" if self.is_about_commands else f", such as {self.example!r}"

    @property
    def is_about_commands(self) -> bool:
        """Tell whether its unit depends on the command of the motor."""
        return all(any(command in unit for unit in self.units) for command in COMMAND_UNITS)


def written_as(units: Sequence[str]) -> str:
    """Return advice on units of which the motor decides; ``{value}`` is the number as written."""
    written = (f"'{{value}} {unit}'" for unit in units)
    return f"{' or '.join(written)}, whichever the motor takes"


def parse_quantity(text: str, kind: QuantityKind) -> Quantity:
    """Read a number, a space and a unit, such as ``0.3 N*m``, and check what they measure.

    The number is kept as written. A `SpecError` if number, unit or dimension is wrong, or the
    magnitude is not physical.
    """
    number, _, unit = text.partition(" ")
    if not unit:
        raise _without_unit(text, kind)
    if len(unit) > MAX_UNIT_LENGTH:
        raise SpecError(f"{quoted(text)} has a long unit", remedy=f"such as {kind.example!r}")
    value, unit = parse_exact(number), unit.lstrip(" ")
    try:
        quantity = Quantity(text, value, unit)
    except SpecError as error:
        if not has_unknown(unit):
            raise
        units = f"{kind.name} is written in {' or '.join(kind.units)}{kind.example_clause}"
        guess = guess_unit(unit)
        if guess is not None and kind.accepts(parse_unit(guess).dimension):
            units = f"did you mean {guess}? {units}"
        raise SpecError(error.message, remedy=units) from None
    return _checked_kind(quantity, kind)


def _checked_kind(quantity: Quantity, kind: QuantityKind) -> Quantity:
    """Return the quantity if it is of this kind and of a physical magnitude, else a `SpecError`."""
    if not kind.accepts(quantity.dimension):
        raise SpecError(
            f"{quoted(quantity.text)} is not {kind.name}, expected {' or '.join(kind.units)}",
            remedy=kind.advice(_without_prefix(quantity), quantity.dimension),
        )
    if kind.rational and not quantity.is_exact:
        raise _irrational(quantity, kind)
    if quantity.value and not SMALLEST <= abs(quantity.rational_part) <= LARGEST:
        raise SpecError(
            f"{quoted(quantity.text)} is not a physical magnitude for {kind.name}",
            remedy=f"SI values between {SMALLEST:g} and {LARGEST:g} are read",
        )
    return quantity


def _without_prefix(quantity: Quantity) -> str:
    """Return the number to write where a unit is advised instead, all of which are plain."""
    unit = parse_unit(quantity.unit)
    if unit.pi_power or unit.factor == 1:
        return quantity.text.partition(" ")[0]
    return f"{quantity.si:.6g}"


def _irrational(quantity: Quantity, kind: QuantityKind) -> SpecError:
    unit = kind.unit_in(quantity.dimension)
    return SpecError(
        f"the unit of {quoted(quantity.text)} holds a factor of pi: not exact in SI",
        remedy=f"{kind.name} enters the proof: write it in {unit}, "
        f"such as '{quantity.si:.6g} {unit}' (rounded)",
    )


def _without_unit(text: str, kind: QuantityKind) -> SpecError:
    glued = len(text) <= MAX_LENGTH and re.fullmatch(_GLUED, text)
    if glued:
        return SpecError(
            f"{quoted(text)} has no space between number and unit",
            remedy=f"write '{glued[1]} {glued[2]}'",
        )
    parse_exact(text)
    units = kind.units
    if not kind.is_about_commands:
        units = tuple(dict.fromkeys((kind.example.partition(" ")[2], *units)))
    expected, written = " or ".join(kind.units), " or ".join(f"'{text} {unit}'" for unit in units)
    remedy = f"write {written}, " + ("whichever is meant" if units[1:] else "if that is the unit")
    return SpecError(f"{quoted(text)} has no unit, expected {expected}", remedy=remedy)


def exact_number(value: Quantity | Fraction) -> Fraction:
    """Return a value in SI, which may be a number without a unit."""
    return value.exact if isinstance(value, Quantity) else value


def is_less(a: Quantity, b: Quantity) -> bool:
    """Whether ``a < b``; exact wherever both have the same power of pi."""
    if a.pi_power == b.pi_power:
        return a.rational_part < b.rational_part
    return a.si < b.si
