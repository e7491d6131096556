"""Exact reader of matrix entries that are affine in parameters, such as ``3/4*k - m + 0.5``.

A reader of its own, of four operators and parentheses: nothing is ever evaluated as code, and
nothing passes through a float.
"""

from __future__ import annotations

import re
from fractions import Fraction
from typing import NamedTuple

from nrs_design.errors import SpecError
from nrs_design.proof.text import quoted
from nrs_design.spec.affine import Affine
from nrs_design.spec.exact import UNSIGNED_DECIMAL_PATTERN, is_number, number_fault, parse_exact

MAX_LENGTH = 200
MAX_DEPTH = 20
# Beyond these the entries leave the floats that the search for a proof uses.
LARGEST = Fraction(10) ** 100

EXPRESSION_PATTERN = r"^(?!.*/ *0+(?:\.0*)?(?![0-9.eE]))[A-Za-z0-9_.+*/() -]{1,200}$"
"""What an expression may hold, for the JSON Schema; no division by a written zero."""

_TOKEN = re.compile(
    rf"(?P<number>{UNSIGNED_DECIMAL_PATTERN})|(?P<name>[A-Za-z][A-Za-z0-9_]*)"
    r"|(?P<sign>\*\*|[-+*/()^])"
)
_EXPECTED = (
    'write a number such as -0.25 or "1/6", or a sum of parameters times numbers, such as '
    '"3/4*k - m + 0.5"'
)
_OWN_PARAMETER = (
    "declare the product, quotient or power as a parameter of its own, with its own range, and "
    "write its name here"
)


class _Token(NamedTuple):
    kind: str
    text: str


def parse_affine(text: str) -> Affine:
    """Read a number or an expression that is affine in its parameters, such as ``-2 - k``.

    Numbers, names, ``+ - * /`` and parentheses, at most 200 ASCII characters and 20 levels. One
    factor of every product and every divisor must be constant. Which names are parameters is not
    checked here. A `SpecError` for anything else.
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
    tokens = _tokens(text)
    function = _sum(tokens, text, 0)
    if tokens:
        raise _unexpected(tokens[-1], text)
    # No float holds more: each literal is capped, but products of them grow.
    if any(abs(number) > LARGEST for number in function.numbers):
        raise SpecError(
            f"{quoted(text)} holds a factor beyond 1e100", remedy="choose another scale"
        )
    return function


def _tokens(text: str) -> list[_Token]:
    """Split into tokens, reversed so that the next one is at the end."""
    tokens: list[_Token] = []
    position = 0
    while position < len(text):
        if text[position] == " ":
            position += 1
            continue
        match = _TOKEN.match(text, position)
        if match is None:
            raise SpecError(
                f"{quoted(text)} is not a number or an expression: "
                f"{quoted(text[position])} is not read",
                remedy=_EXPECTED,
            )
        tokens.append(_Token(str(match.lastgroup), match[0]))
        position = match.end()
    return tokens[::-1]


def _sum(tokens: list[_Token], text: str, depth: int) -> Affine:
    total = _product(tokens, text, depth)
    while tokens and tokens[-1].text in ("+", "-"):
        sign = 1 if tokens.pop().text == "+" else -1
        total = total.plus(_product(tokens, text, depth).times(Fraction(sign)))
    return total


def _product(tokens: list[_Token], text: str, depth: int) -> Affine:
    product = _factor(tokens, text, depth)
    while tokens and tokens[-1].text in ("*", "/", "^", "**"):
        operator = tokens.pop().text
        if operator in ("^", "**"):
            raise _not_affine(text, "it takes a power")
        factor = _factor(tokens, text, depth)
        combine = _multiply if operator == "*" else _divide
        product = combine(product, factor, text)
    return product


def _multiply(left: Affine, right: Affine, text: str) -> Affine:
    if left.is_constant:
        return right.times(left.constant)
    if right.is_constant:
        return left.times(right.constant)
    raise _not_affine(text, f"it multiplies {left.names[0]} by {right.names[0]}")


def _divide(left: Affine, right: Affine, text: str) -> Affine:
    if not right.is_constant:
        raise _not_affine(text, f"it divides by {right.names[0]}")
    if right.constant == 0:
        raise SpecError(f"{quoted(text)} divides by zero", remedy="use a nonzero divisor")
    return left.times(1 / right.constant)


def _factor(tokens: list[_Token], text: str, depth: int) -> Affine:
    if depth > MAX_DEPTH:
        raise SpecError(
            f"{quoted(text)} is nested deeper than {MAX_DEPTH} levels",
            remedy="remove parentheses and repeated signs",
        )
    if not tokens:
        raise SpecError(f"{quoted(text)} ends too early", remedy=_EXPECTED)
    token = tokens.pop()
    if token.text in ("+", "-"):
        return _factor(tokens, text, depth + 1).times(Fraction(1 if token.text == "+" else -1))
    if token.text == "(":
        inner = _sum(tokens, text, depth + 1)
        if not tokens:
            raise SpecError(f"a parenthesis of {quoted(text)} is not closed", remedy="close it")
        if tokens[-1].text != ")":
            raise _unexpected(tokens[-1], text)
        tokens.pop()
        return inner
    if token.kind == "number":
        return Affine(parse_exact(token.text))
    if token.kind == "name":
        return Affine.of_parameter(token.text)
    raise _unexpected(token, text)


def _not_affine(text: str, reason: str) -> SpecError:
    return SpecError(
        f"{quoted(text)} is not affine in the parameters: {reason}", remedy=_OWN_PARAMETER
    )


def _unexpected(token: _Token, text: str) -> SpecError:
    if token.kind in ("number", "name"):
        return SpecError(
            f"{quoted(text)} is not a number or an expression: there is no operator before "
            f"{quoted(token.text)}",
            remedy="write products with *, such as 2*k",
        )
    return SpecError(
        f"{quoted(text)} is not a number or an expression: {quoted(token.text)} is out of place",
        remedy=_EXPECTED,
    )
