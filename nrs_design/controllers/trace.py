"""Operations recorded from formulas: what is computed with traced values becomes the list of a law.

The formulas are those of the models, run once with traced values in the place of numbers. The same
operation on the same operands is recorded once, numbers of the robot are folded before they are
rounded to single precision, and signs are carried along instead of computed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.operations import Coefficient, Kind, Operation


@dataclass(eq=False)
class Trace:
    """A list that grows, and what is in it already."""

    operations: list[Operation] = field(default_factory=list)
    constants: dict[Fraction, Coefficient] = field(default_factory=dict)
    _known: dict[tuple[str, str, str], str] = field(default_factory=dict)
    # Results that are a number times another value, by their names.
    _multiples: dict[str, tuple[float, str]] = field(default_factory=dict)

    def value(self, name: str) -> Traced:
        """Return an input or a state, to compute with."""
        return Traced(self, name)

    def values(self, name: str) -> tuple[Traced, Traced, Traced]:
        """Return the three of a name, one for each joint."""
        first, second, third = (self.value(f"{name}_{joint}") for joint in (1, 2, 3))
        return first, second, third

    def multiply(self, coefficient: str, value: Traced) -> Traced:
        """Return a coefficient that ships under its name, times a value."""
        return Traced(self, self.record("multiply", coefficient, value.name), value.negative)

    def saturate(self, coefficient: str, value: Traced) -> Traced:
        """Return a value within plus and minus a coefficient."""
        return Traced(self, self.record("saturate", coefficient, value.name), value.negative)

    def interpolate(self, table: str, position: Traced) -> Traced:
        """Return what a table has at a position, counted from its first entry."""
        return Traced(self, self.record("interpolate", table, position.positive()))

    def scaled(self, factor: float, value: Traced) -> Traced | float:
        """Return a number times a value; a number times it before is one number."""
        if factor == 0:
            return 0.0
        before, name = self._multiples.get(value.name, (1.0, value.name))
        size = abs(factor) * before
        negative = value.negative != (factor < 0)
        if to_float32(Fraction(size)) != 1:
            held = self.constant(size)
            result = self.record("multiply", held, name)
            self._multiples[result] = (size, name)
            name = result
        return Traced(self, name, negative)

    def constant(self, number: float) -> str:
        """Return the name of a number, rounded to single precision."""
        held = to_float32(Fraction(number))
        if held not in self.constants:
            name = f"number_{len(self.constants) + 1}"
            self.constants[held] = Coefficient(name, "", "", (held,), inline=True)
        return self.constants[held].name

    def record(self, kind: Kind, left: str, right: str) -> str:
        """Return the name of the result of an operation, which is recorded if it is new."""
        if kind in ("add", "product"):
            left, right = sorted((left, right))
        key = kind, left, right
        if key not in self._known:
            self._known[key] = f"t{len(self.operations) + 1}"
            self.operations.append(Operation(self._known[key], kind, left, right))
        return self._known[key]

    def reciprocal(self, value: Traced) -> Traced | None:
        """Return one over a value, if that is recorded already."""
        name = self._known.get(("invert", self.constant(1.0), value.name))
        return None if name is None else Traced(self, name, value.negative)

    def used(self, results: Iterable[str]) -> list[Operation]:
        """Return the operations that lead to some results, each as late as it is needed."""
        made = {operation.name: operation for operation in self.operations}
        found: dict[str, Operation] = {}
        open_ = [*results][::-1]
        while open_:
            operation = made.get(open_[-1])
            if operation is None or operation.name in found:
                open_.pop()
                continue
            missing = [n for n in (operation.left, operation.right) if n in made and n not in found]
            if not missing:
                found[open_.pop()] = operation
            # What was recorded last needs most: what it leads to is out of the way first.
            open_ += sorted(missing, key=lambda name: -int(name[1:]))
        return [*found.values()]


# A number, or what is computed from inputs; as the models have it.
Operand = Any


@dataclass(frozen=True, slots=True, eq=False)
class Traced:
    """A value of a step that is not known yet, or the negative of one."""

    trace: Trace  # Where what is computed with it is recorded
    name: str  # Of the value
    negative: bool = False  # Whether it is meant with the other sign

    def positive(self) -> str:
        """Return the name of the value with its sign, which is computed if it is negative."""
        if not self.negative:
            return self.name
        return self.trace.record("multiply", self._minus_one(), self.name)

    def _minus_one(self) -> str:
        return self.trace.constant(-1.0)

    def __neg__(self) -> Traced:
        """Return the value with the other sign, which costs nothing."""
        return Traced(self.trace, self.name, not self.negative)

    def __add__(self, other: Operand) -> Operand:
        """Record a sum, or a difference where signs differ."""
        if not isinstance(other, Traced):
            return self._shifted(float(other))
        if self.negative == other.negative:
            name = self.trace.record("add", self.name, other.name)
            return Traced(self.trace, name, self.negative)
        first, second = (other, self) if self.negative else (self, other)
        if first.name == second.name:
            return 0.0
        return Traced(self.trace, self.trace.record("subtract", first.name, second.name))

    __radd__ = __add__

    def _shifted(self, number: float) -> Traced:
        if number == 0:
            return self
        held = self.trace.constant(number)
        kind: Kind = "rest" if self.negative else "shift"
        return Traced(self.trace, self.trace.record(kind, held, self.name))

    def __sub__(self, other: Operand) -> Operand:
        """Record a difference."""
        return self + -other

    def __rsub__(self, other: Operand) -> Operand:
        """Record a difference from a number."""
        return -self + other

    def __mul__(self, other: Operand) -> Operand:
        """Record a product."""
        if not isinstance(other, Traced):
            return self.trace.scaled(float(other), self)
        name = self.trace.record("product", self.name, other.name)
        return Traced(self.trace, name, self.negative != other.negative)

    __rmul__ = __mul__

    def __truediv__(self, other: Operand) -> Operand:
        """Record a quotient; by a number it is a product."""
        if not isinstance(other, Traced):
            return self * (1 / float(other))
        known = self.trace.reciprocal(other)
        if known is not None:
            return self * known
        name = self.trace.record("divide", self.name, other.name)
        return Traced(self.trace, name, self.negative != other.negative)

    def __rtruediv__(self, other: Operand) -> Operand:
        """Record a number over the value."""
        number = float(other)
        if number == 0:
            return 0.0
        name = self.trace.record("invert", self.trace.constant(abs(number)), self.name)
        return Traced(self.trace, name, self.negative != (number < 0))

    def sqrt(self) -> Traced:
        """Record the square root; NumPy calls this for its own."""
        return Traced(self.trace, self.trace.record("root", "", self.positive()))
