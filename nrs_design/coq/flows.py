"""Continuous time: one form for all modes, quadratic or of higher degree, as a theorem of Coq."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import repeat

from nrs_design.coq.text import (
    AbstractStatement,
    Definitions,
    Theorem,
    factor_of,
    listed,
    long_integer,
    symmetric,
)
from nrs_design.proof.evidence.graph import FormsOnGraph
from nrs_design.proof.exact import IntegerMatrix, add
from nrs_design.proof.lift import monomials
from nrs_design.proof.mode import Mode
from nrs_design.proof.steps import FREE, Step
from nrs_design.proof.system import SwitchedSystem

LIBRARY = ("forms", "polynomials", "continuous")


@dataclass(frozen=True)
class FlowStatement(AbstractStatement):
    """A system in continuous time, and its form."""

    def basis(self, states: int) -> str:
        """Return the monomials of the first states, each as the list of its variables."""
        place = {state: k for k, state in enumerate(self.order)}
        terms = [
            sorted(i for state, power in enumerate(term) for i in repeat(place[state], power))
            for term in monomials(states, self.evidence.degree)
        ]
        return f"{listed(listed(map(str, term)) for term in terms)}%nat"

    def mode(self, k: int, mode: Mode, definitions: Definitions) -> str:
        """Return the flow of a mode, without inputs."""
        rows = [definitions.row([mode.A.numerators[i][j] for j in self.order]) for i in self.order]
        return f"Flow {listed(rows)} {mode.A.denominator} [] 1"

    def witnesses(self) -> Iterator[tuple[str, IntegerMatrix, int]]:
        """Yield source, inequality and factor of every flow."""
        system, evidence = self.system, self.evidence
        added = iter(evidence.vanishing)
        for a, step, b in evidence.edges_in_time(system):
            if not isinstance(step, Step):
                continue  # A stay of some length, which Coq follows by itself
            form = evidence.inequality(step, a, b, system)
            if evidence.degree > 1:
                form = add(form, next(added))
            share = 2 * evidence.degree * evidence.rate
            yield step.source, form, (share * step.over).denominator * step.over


def flows_theorem(system: SwitchedSystem, evidence: FormsOnGraph) -> Theorem:
    """Return the theorem of a certificate in continuous time, with one form for all modes."""
    flows, definitions = FlowStatement(system, evidence), Definitions()
    modes, others = flows.define_modes(definitions)
    _define_form(flows, definitions)
    witnesses, free_gives = _define_witnesses(flows, definitions)
    rate, factor = evidence.rate, factor_of(evidence.nodes[0].form)
    shape = f"{system.order} {evidence.degree} {rate.numerator} {rate.denominator} basis form"
    arguments = f"{str(flows.lost).lower()}\n    {modes}\n    {others}"
    holes = "_ " * 15
    return Theorem(
        LIBRARY,
        definitions.texts,
        f"flows_fall {shape} multipliers {factor} {arguments}\n"
        f"    all_terms free_terms {witnesses} {free_gives}",
        f"decays {shape} {arguments}\n  /\\ is_definite basis form {factor}",
        f"conj (decays_sound {holes}checked eq_refl) (definite_sound {holes}checked)",
        tuple(system.states[i] for i in flows.order),
    )


def _define_form(flows: FlowStatement, definitions: Definitions) -> None:
    """Define the form with its monomials, and an empty list of multipliers of inputs."""
    n = flows.system.order
    definitions.define("basis", flows.basis(n))
    definitions.define("form", symmetric(flows.evidence.nodes[0].form))
    definitions.define("multipliers", "[] : list Z")
    definitions.define("all_terms", flows.basis(n))
    terms = flows.basis(n - 1) if flows.lost else "[]"
    definitions.define("free_terms", f"{terms} : list mono")


def _define_witnesses(flows: FlowStatement, definitions: Definitions) -> tuple[str, str]:
    """Define the inequality of every flow; return those in contact, and those of free motion."""
    found: dict[bool, list[str]] = {False: [], True: []}
    for k, (place, gram, factor) in enumerate(flows.witnesses(), 1):
        text = f"Witness {symmetric(gram, long_integer)} {factor}"
        found[place.startswith(FREE)].append(definitions.define(f"witness{k}", text))
    return listed(found[False]), listed(found[True])
