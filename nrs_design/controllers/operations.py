"""A law as a short list of single-precision operations: what a processor computes once a sample.

The list is the one definition of the law. From it follow its exact linear map and how often every
term is rounded (both below), the C (`nrs_design.exporters.c`) and the same steps in NumPy
(`nrs_design.controllers.replica`).

An operation is a sum, a difference, a product with a coefficient, or a saturation. Every one rounds
once; a saturation does not round. The linear map is that of a step in which nothing saturates.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import Literal

from nrs_design.controllers.float32 import is_float32
from nrs_design.controllers.sampled import Term
from nrs_design.errors import DesignError
from nrs_design.models.linear_form import LinearForm, combine

# How the result of an operation, or the reading of an input, counts as rounded: with the terms that
# it is made of; as a number of its own, of which the next operations take the rounded value; in
# proportion to the largest angle, apart from all terms.
Rounding = Literal["term", "own", "angle", "none"]
Kind = Literal["add", "subtract", "multiply", "saturate"]
# Single precision reaches to 2^128; what a bound itself leaves out is far less than the other half.
LARGEST = Fraction(2) ** 127
# More than all roundings of a step add to a value, over its size.
SLACK = 1 + Fraction(1, 2**16)


@dataclass(frozen=True, slots=True)
class Value:
    """What a step gets from outside, or from the step before.

    Parameters
    ----------
    name : str
        As the exported code calls it.
    symbol : str
        As terms and formulas call it.
    unit : str
        Its unit.
    limit : Fraction
        A single-precision number; beyond it, or not a number, the value is refused.
    meaning : str
        In words.
    rounding : {"none", "term", "angle"}
        Whether it is rounded when it is read, and how that counts.
    starts_at_angle : bool
        Whether a state is the measured angle at first; others are zero.
    """

    name: str
    symbol: str
    unit: str
    limit: Fraction
    meaning: str
    rounding: Rounding = "none"
    starts_at_angle: bool = False


@dataclass(frozen=True, slots=True)
class Coefficient:
    """A number that ships, the same in all modes or one for each.

    Parameters
    ----------
    name : str
        As the exported code calls it.
    symbol : str
        As terms and formulas call it.
    unit : str
        Its unit.
    values : tuple of Fraction
        Single-precision numbers: one, or one for each mode.
    """

    name: str
    symbol: str
    unit: str
    values: tuple[Fraction, ...]

    def of(self, mode: int) -> Fraction:
        """Return its value in a mode."""
        return self.values[mode if len(self.values) > 1 else 0]


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation; of `multiply` and `saturate` the left operand is a coefficient.

    Parameters
    ----------
    name : str
        Of the result.
    kind : {"add", "subtract", "multiply", "saturate"}
        Left plus right, left minus right, left times right, right within plus and minus left.
    left, right : str
        Names of values, of coefficients, or of results of operations before.
    rounding : {"term", "own", "angle"}
        How its rounding counts.
    symbol : str
        As terms call the result; by default they write it out.
    """

    name: str
    kind: Kind
    left: str
    right: str
    rounding: Rounding = "term"
    symbol: str = ""


@dataclass(frozen=True, slots=True)
class StepLaw:
    """One step of a law, with a mode for each controller that the robot switches between.

    Parameters
    ----------
    modes : tuple of str
        Controllers, in the order of the spec.
    inputs, states : tuple of Value
        What a step gets.
    coefficients : tuple of Coefficient
        Numbers that ship.
    operations : tuple of Operation
        In the order in which they are computed.
    outputs : mapping of str to str
        Outputs, and the results that they are; ``units`` has their units.
    following : mapping of str to str
        Every state, and the result that it has after the step.
    units : mapping of str to str
        Of the outputs.

    Raises
    ------
    ValueError
        If a name is used before it is computed, or twice, or the kinds of operands do not fit.
    """

    modes: tuple[str, ...]
    inputs: tuple[Value, ...]
    states: tuple[Value, ...]
    coefficients: tuple[Coefficient, ...]
    operations: tuple[Operation, ...]
    outputs: Mapping[str, str]
    following: Mapping[str, str]
    units: Mapping[str, str]

    def __post_init__(self) -> None:
        """Refuse a list that does not fit together."""
        known = [value.name for value in (*self.inputs, *self.states)]
        constants = {c.name for c in self.coefficients}
        for operation in self.operations:
            lefts = constants if operation.kind in ("multiply", "saturate") else known
            if operation.left not in lefts or operation.right not in known:
                raise ValueError(f"{operation.name} is computed from what is not there")
            known.append(operation.name)
        if len({*known, *constants}) != len(known) + len(self.coefficients):
            raise ValueError("a name occurs twice")
        if set(self.following) != {state.name for state in self.states}:
            raise ValueError("every state needs the value that follows it, and nothing else")
        results = {operation.name for operation in self.operations}
        if not {*self.outputs.values(), *self.following.values()} <= results:
            raise ValueError("an output, or the next state, is not computed")
        numbers = [
            *(n for c in self.coefficients for n in c.values),
            *(v.limit for v in self.values),
        ]
        if not all(map(is_float32, numbers)):
            raise ValueError("a coefficient or a limit is no single-precision number")
        if {len(c.values) for c in self.coefficients} - {1, len(self.modes)}:
            raise ValueError("a coefficient has a number for some modes only")

    @property
    def values(self) -> tuple[Value, ...]:
        """Inputs and states, in this order."""
        return (*self.inputs, *self.states)

    @property
    def coefficient(self) -> Mapping[str, Coefficient]:
        """The coefficients by name."""
        return {c.name: c for c in self.coefficients}


def linear_forms(law: StepLaw, mode: int, given: Mapping[str, LinearForm]) -> dict[str, LinearForm]:
    """Return every value of a step as a linear form, computed without rounding or saturation.

    Parameters
    ----------
    law : StepLaw
        The law.
    mode : int
        Which controller is in force.
    given : mapping of str to LinearForm
        Inputs and states in coordinates of the caller's choice.
    """
    forms = dict(given)
    for operation in law.operations:
        right = forms[operation.right]
        if operation.kind == "saturate":
            forms[operation.name] = right
        elif operation.kind == "multiply":
            factor = law.coefficient[operation.left].of(mode)
            forms[operation.name] = combine((factor, right))
        else:
            sign = Fraction(1 if operation.kind == "add" else -1)
            forms[operation.name] = combine((Fraction(1), forms[operation.left]), (sign, right))
    return forms


def rounded_terms(
    law: StepLaw, mode: int, given: Mapping[str, LinearForm]
) -> dict[str, tuple[Term, ...]]:
    """Return what each result is a sum of, and in how many roundings each summand takes part.

    Only of results that are used further on: those whose rounding is their own, the outputs and
    the next states. Of a result with a rounding of its own, the operations after it take the
    rounded value.

    Parameters
    ----------
    law : StepLaw
        The law.
    mode : int
        Which controller is in force.
    given : mapping of str to LinearForm
        Inputs and states in coordinates of the caller's choice.
    """
    forms, terms = linear_forms(law, mode, given), dict[str, tuple[Term, ...]]()
    for value in law.values:
        count = int(value.rounding == "term")
        terms[value.name] = (Term(value.symbol, given[value.name], count),)
    kept: dict[str, tuple[Term, ...]] = {}
    targets = {*law.outputs.values(), *law.following.values()}
    for operation in law.operations:
        found = _terms(law, mode, operation, terms)
        if operation.rounding == "own" or operation.name in targets:
            kept[operation.name] = found
        if operation.rounding == "own":
            found = (Term(operation.symbol, forms[operation.name], 0),)
        terms[operation.name] = found
    return kept


def _terms(
    law: StepLaw, mode: int, operation: Operation, terms: Mapping[str, tuple[Term, ...]]
) -> tuple[Term, ...]:
    right = terms[operation.right]
    if operation.kind == "saturate":
        return right
    if operation.kind == "multiply":
        coefficient = law.coefficient[operation.left]
        factor, prefix = coefficient.of(mode), f"{coefficient.symbol} "
        return tuple(term.times(factor, prefix, 1) for term in right)
    add, left = operation.kind == "add", terms[operation.left]
    sign = Fraction(1 if add else -1)
    more = int(operation.rounding != "angle")
    both = (*left, *(term.times(sign, "", 0) for term in right))
    if any(term.roundings for term in both):
        return tuple(term.times(Fraction(1), "", more) for term in both)
    # A sum of exact numbers is off in proportion to itself.
    names = [" + ".join(term.name for term in side) for side in (left, right)]
    name = operation.symbol or f"({names[0]} {'+' if add else '-'} {names[1]})"
    return (Term(name, combine(*((Fraction(1), term.form) for term in both)), more),)


def check_range(law: StepLaw) -> None:
    """See that no operation can leave single precision while values keep their limits.

    Raises
    ------
    DesignError
        If one can.
    """
    bounds = {value.name: value.limit for value in law.values}
    for operation in law.operations:
        right = bounds[operation.right]
        if operation.kind in ("multiply", "saturate"):
            left = max(map(abs, law.coefficient[operation.left].values))
            bound = min(left, right) if operation.kind == "saturate" else left * right * SLACK
        else:
            bound = (bounds[operation.left] + right) * SLACK
        if bound >= LARGEST:
            raise DesignError(
                f"{operation.name} of the law may be beyond single precision",
                remedy="choose smaller gains, or other units",
            )
        bounds[operation.name] = bound


def term_counts(law: StepLaw) -> dict[str, int]:
    """Return how often each term of a law is rounded, by its name."""
    given: dict[str, Sequence[Fraction]] = {value.name: [Fraction(0)] for value in law.values}
    terms = chain.from_iterable(rounded_terms(law, 0, given).values())
    return {term.name: term.roundings for term in terms if term.roundings}
