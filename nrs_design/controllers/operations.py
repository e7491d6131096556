"""A law as a short list of single-precision operations: what a processor computes once a sample.

The list is the one definition of the law. From it follow its exact linear map and how often every
term is rounded (`nrs_design.controllers.step_analysis`), the C (`nrs_design.exporters.c`) and the
same steps in NumPy (`nrs_design.controllers.replica`).

An operation is a sum, a difference, a product with a coefficient, or a saturation. Every one rounds
once; a saturation does not round. The linear map is that of a step in which nothing saturates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from nrs_design.controllers.float32 import is_float32

# How the result of an operation, or the reading of an input, counts as rounded: with the terms that
# it is made of; as a number of its own, of which the next operations take the rounded value; in
# proportion to the largest angle, apart from all terms.
Rounding = Literal["term", "own", "angle", "none"]
Kind = Literal["add", "subtract", "multiply", "saturate"]


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
