"""Matrix entries that are affine in parameters, such as ``3/4*k - m + 0.5``, read exactly."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.errors import SpecError
from nrs_design.proof.text import quoted
from nrs_design.spec.algebra import Operators, read_algebra
from nrs_design.spec.exact import UNSIGNED_DECIMAL_PATTERN, is_number, number_fault, parse_exact

MAX_LENGTH = 200
# Beyond these the entries leave the floats that the search for a proof uses.
LARGEST = Fraction(10) ** 100

EXPRESSION_PATTERN = r"^(?!.*/ *0+(?:\.0*)?(?![0-9.eE]))[A-Za-z0-9_.+*/() -]{1,200}$"
"""What an expression may hold, for the JSON Schema; no division by a written zero."""

_LEAF = re.compile(rf"{UNSIGNED_DECIMAL_PATTERN}|[A-Za-z][A-Za-z0-9_]*")
_EXPECTED = (
    'write a number such as -0.25 or "1/6", or a sum of parameters times numbers, such as '
    '"3/4*k - m + 0.5"'
)
_OWN_PARAMETER = (
    "declare the product, quotient or power as a parameter of its own, with its own range, and "
    "write its name here"
)


@dataclass(frozen=True, slots=True)
class Affine:
    """An affine function of parameters; two are equal iff they are the same function."""

    constant: Fraction  # Value where all parameters are zero
    # Parameter names with their nonzero factors, sorted by name.
    slopes: tuple[tuple[str, Fraction], ...] = ()

    @classmethod
    def of_parameter(cls, name: str) -> Affine:
        """Return the function that equals one parameter."""
        return cls(Fraction(0), ((name, Fraction(1)),))

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that it depends on."""
        return tuple(name for name, _ in self.slopes)

    @property
    def numbers(self) -> tuple[Fraction, ...]:
        """The constant and the factors."""
        return (self.constant, *(slope for _, slope in self.slopes))

    @property
    def is_constant(self) -> bool:
        """Tell whether it depends on no parameter."""
        return not self.slopes

    def plus(self, other: Affine) -> Affine:
        """Add another function."""
        slopes = dict(self.slopes)
        for name, slope in other.slopes:
            slopes[name] = slopes.get(name, Fraction(0)) + slope
        kept = tuple(sorted((name, slope) for name, slope in slopes.items() if slope))
        return Affine(self.constant + other.constant, kept)

    def times(self, factor: Fraction) -> Affine:
        """Multiply by a number."""
        if not factor:
            return Affine(Fraction(0))
        slopes = tuple((name, slope * factor) for name, slope in self.slopes)
        return Affine(self.constant * factor, slopes)

    def at(self, values: Mapping[str, Fraction]) -> Fraction:
        """Evaluate at the given parameter values; a KeyError if one is missing."""
        return self.constant + sum(
            (slope * values[name] for name, slope in self.slopes), Fraction(0)
        )


def parse_affine(text: str) -> Affine:
    """Read a number or an expression that is affine in its parameters, such as ``-2 - k``.

    Numbers, names, ``+ - * /`` and parentheses, at most 200 ASCII characters. One factor of every
    product and every divisor must be constant. Which names are parameters is not checked here. A
    `SpecError` for anything else.
    """
    if len(text) > MAX_LENGTH:
        raise SpecError(
            f"the entry {quoted(text)} has {len(text)} characters, at most {MAX_LENGTH} are read",
            remedy="write fewer digits or terms",
        )
    if is_number(text):
        return Affine(parse_exact(text))
    if fault := number_fault(text):
        raise fault
    try:
        if re.search(r"\^|\*\*", text):
            raise ArithmeticError("it takes a power")
        function = read_algebra(text, _LEAF, _read_leaf, _OPERATORS)
    except ValueError:
        message = f"{quoted(text)} is not a number or an expression"
        raise SpecError(message, remedy=_EXPECTED) from None
    except ZeroDivisionError:
        message = f"{quoted(text)} divides by zero"
        raise SpecError(message, remedy="use a nonzero divisor") from None
    except ArithmeticError as error:
        message = f"{quoted(text)} is not affine in the parameters: {error}"
        raise SpecError(message, remedy=_OWN_PARAMETER) from None
    # No float holds more: each literal is capped, but products of them grow.
    if any(abs(number) > LARGEST for number in function.numbers):
        raise SpecError(
            f"{quoted(text)} holds a factor beyond 1e100", remedy="choose another scale"
        )
    return function


def _read_leaf(text: str) -> Affine:
    return Affine.of_parameter(text) if text[0].isalpha() else Affine(parse_exact(text))


def _multiply(left: Affine, right: Affine) -> Affine:
    if left.is_constant:
        return right.times(left.constant)
    if right.is_constant:
        return left.times(right.constant)
    raise ArithmeticError(f"it multiplies {left.names[0]} by {right.names[0]}")


def _divide(left: Affine, right: Affine) -> Affine:
    if not right.is_constant:
        raise ArithmeticError(f"it divides by {right.names[0]}")
    return left.times(1 / right.constant)


_OPERATORS: Operators[Affine] = {
    ast.UAdd: lambda a: a,
    ast.USub: lambda a: a.times(Fraction(-1)),
    ast.Add: Affine.plus,
    ast.Sub: lambda a, b: a.plus(b.times(Fraction(-1))),
    ast.Mult: _multiply,
    ast.Div: _divide,
}
