"""The variables of a law as a co-simulation model has them: names, references, units."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from nrs_design.controllers.operations import StepLaw


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable that is a real number."""

    name: str  # As the description calls it
    reference: int  # Its number
    place: str  # Member of the model in C
    causality: str  # What it is to others
    # unit, meaning: in words.
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Variables:
    """All real variables of a law: inputs first, then outputs, then states."""

    reals: tuple[Variable, ...]  # By their references

    @classmethod
    def of(cls, law: StepLaw) -> Variables:
        """Give every variable of a law its number."""
        return cls(tuple(Variable(name, i, *rest) for i, (name, *rest) in enumerate(_rows(law))))


def _rows(law: StepLaw) -> Iterator[tuple[str, str, str, str, str]]:
    for value in law.inputs:
        yield value.name, f"in.{value.name}", "input", value.unit, value.meaning
    for name in law.outputs:
        meaning = "what the step computed; 0 where it was not valid"
        yield name, f"out.{name}", "output", law.units[name], meaning
    for value in law.states:
        yield f"state.{value.name}", f"state.{value.name}", "local", value.unit, value.meaning
