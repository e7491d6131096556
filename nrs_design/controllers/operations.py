"""A law as a short list of single-precision operations: what a processor computes once a sample.

The list is the one definition of the law. From it follow its exact linear map and how often every
term is rounded (`nrs_design.controllers.step_analysis`), the C (`nrs_design.exporters.formats.c`)
and the same steps in NumPy (`nrs_design.controllers.replica`).

An operation is one of `Kind`. Every one rounds once, as IEEE 754 says; a saturation does not round.
The map of a law is that of a step in which nothing saturates.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeVar

from nrs_design.controllers.float32 import is_float32
from nrs_design.controllers.step_logic import StepLogic

V = TypeVar("V")
# Rounding model of an input or a result; `step_analysis.rounded_terms` defines the models.
Rounding = Literal["term", "own", "angle", "none"]
Kind = Literal["add", "subtract", "multiply", "saturate"]
# Kinds with a coefficient for the first operand.
COEFFICIENT_KINDS: frozenset[Kind] = frozenset({"multiply", "saturate"})


@dataclass(frozen=True, slots=True)
class Value:
    """What a step gets from outside, or from the step before."""

    name: str  # As the exported code calls it
    symbol: str  # As terms and formulas call it
    unit: str  # Its unit
    limit: Fraction  # Single precision; a step refuses larger magnitudes and NaN
    meaning: str  # In words
    rounding: Rounding = "none"  # Rounding of the reading
    # The first value of a state is the measured angle, else zero.
    starts_at_angle: bool = False
    stored: str = ""  # As modes call a state that matters to stability, with its unit


@dataclass(frozen=True, slots=True)
class Coefficient:
    """A number that ships, the same in all modes or one for each."""

    name: str  # As the exported code calls it
    symbol: str  # As terms and formulas call it
    unit: str  # Its unit
    values: tuple[Fraction, ...]  # Single-precision numbers: one, or one for each mode
    symbols: tuple[str, ...] = ()  # Symbols by mode, if not `symbol`

    @property
    def differs_by_mode(self) -> bool:
        """Whether each mode has a number of its own."""
        return len(self.values) > 1

    def number(self, mode: int) -> Fraction:
        """Return its value in a mode."""
        return self.values[mode if self.differs_by_mode else 0]

    def mode_symbol(self, mode: int) -> str:
        """Return the name in terms of a mode."""
        return self.symbols[mode] if self.symbols else self.symbol


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation; for `COEFFICIENT_KINDS` the first operand is a coefficient."""

    name: str  # Name of the result
    # ``add``, ``subtract``: first plus or minus second. ``multiply``: a coefficient times second.
    # ``saturate``: second within plus and minus a coefficient.
    kind: Kind
    # first, second: names of values, of coefficients, or of results of operations before.
    first: str
    second: str
    rounding: Rounding = "term"  # Kind of rounding
    symbol: str = ""  # Name of the result in terms; default: the expression


@dataclass(frozen=True, slots=True)
class StepLaw:
    """One step of a law, with a mode for each controller that the robot switches between.

    A ValueError if a name is used before it is computed, or twice, or kinds of operands do not fit.
    """

    modes: tuple[str, ...]  # Controllers, in the order of the spec
    # inputs, states: what a step gets.
    inputs: tuple[Value, ...]
    states: tuple[Value, ...]
    coefficients: tuple[Coefficient, ...]  # Numbers that ship
    operations: tuple[Operation, ...]  # In the order in which they are computed
    outputs: Mapping[str, str]  # Outputs, and the results that they are; ``units`` has their units
    following: Mapping[str, str]  # Every state, and the result that it has after the step
    units: Mapping[str, str]  # Units of the outputs
    logic: StepLogic | None = None  # Mode logic of the spec, if any

    def __post_init__(self) -> None:
        """Refuse a list that does not fit together."""
        known, constants = {value.name for value in self.values}, {*self.coefficient}
        for operation in self.operations:
            lefts = constants if operation.kind in COEFFICIENT_KINDS else known
            if operation.first not in lefts or operation.second not in known:
                raise ValueError(f"{operation.name} is computed from what is not there")
            known.add(operation.name)
        parts = (self.values, self.coefficients, self.operations)
        if len(known | constants) != sum(map(len, parts)):
            raise ValueError("a name occurs twice")
        if set(self.following) != {state.name for state in self.states}:
            raise ValueError("next values do not match the states")
        results = {operation.name for operation in self.operations}
        if not {*self.outputs.values(), *self.following.values()} <= results:
            raise ValueError("an output, or the next state, is not computed")
        numbers = (n for c in self.coefficients for n in c.values)
        if not all(map(is_float32, (*numbers, *(value.limit for value in self.values)))):
            raise ValueError("a coefficient or a limit is no single-precision number")
        if any(len(c.values) not in (1, len(self.modes)) for c in self.coefficients):
            raise ValueError("a coefficient has a number for some modes only")

    @property
    def values(self) -> tuple[Value, ...]:
        """Inputs and states, in this order."""
        return (*self.inputs, *self.states)

    @property
    def coefficient(self) -> Mapping[str, Coefficient]:
        """The coefficients by name."""
        return {c.name: c for c in self.coefficients}

    def read(
        self, inputs: Mapping[str, V], compute: Mapping[Kind, Callable[[V, V], V]]
    ) -> dict[str, V]:
        """Return all values of a step: the operations, read with some kind of number.

        `known` are inputs, states and coefficients; `compute`, what a kind of operation makes of
        operands.
        """
        found = dict(inputs)
        for operation in self.operations:
            left, right = found[operation.first], found[operation.second]
            found[operation.name] = compute[operation.kind](left, right)
        return found
