"""Continuous time: one form for all modes, quadratic or of higher degree, as a theorem of Coq."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import repeat
from math import lcm

from nrs_design.exporters.proof_assistant.text import (
    Definitions,
    deflection_first,
    factor_of,
    identifiers,
    listed,
    long_integer,
    symmetric,
)
from nrs_design.exporters.proof_assistant.theorem import Theorem
from nrs_design.proof.evidence.graph import FormsOnGraph
from nrs_design.proof.exact import IntegerMatrix, add
from nrs_design.proof.lift import monomials
from nrs_design.proof.mode import Mode
from nrs_design.proof.steps import COUPLING, FREE, Step
from nrs_design.proof.system import SwitchedSystem

LIBRARY = ("forms", "polynomials", "continuous")


@dataclass(frozen=True)
class FlowStatement:
    """A system and its form; the first state is the deflection where contact is lost."""

    system: SwitchedSystem
    evidence: FormsOnGraph

    @property
    def lost(self) -> bool:
        """Whether contact is lost and made again."""
        return self.evidence.covers_lost_contact

    @property
    def order(self) -> list[int]:
        """The states as they come."""
        n = self.system.order
        return deflection_first(n) if self.lost else list(range(n))

    @cached_property
    def acting(self) -> int:
        """How many inputs other axes have."""
        return len(self.system.couplings) if self.evidence.covers_coupling else 0

    def basis(self, states: int, inputs: int = 0) -> str:
        """Return the monomials of the first states, each as the list of its variables."""
        place = {state: k for k, state in enumerate(self.order)}
        terms = [
            sorted(i for state, power in enumerate(term) for i in repeat(place[state], power))
            for term in monomials(states, self.evidence.degree)
        ]
        terms += [[self.system.order + k] for k in range(inputs)]
        return f"{listed(listed(map(str, term)) for term in terms)}%nat"

    def flow(self, k: int, mode: Mode, definitions: Definitions) -> str:
        """Return the text of a mode.

        Parameters
        ----------
        k : int
            Its number; modes of free motion come after those in contact.
        mode : Mode
            The mode.
        definitions : Definitions
            Where its rows are defined.
        """
        couplings = self.system.couplings[: self.acting]
        parts = [(mode.A.numerators, mode.A.denominator)]
        parts += [(item.columns[k].numerators, item.columns[k].denominator) for item in couplings]
        over = lcm(*(below for _, below in parts))
        columns = [
            [row[j] * (over // below) for row in rows]
            for rows, below in parts
            for j in (self.order if len(rows[0]) > 1 else [0])
        ]
        rows = [definitions.row([column[i] for column in columns]) for i in self.order]
        limits = [item.rows[k] for item in couplings]
        below = lcm(*(q.denominator for q in limits))
        given = [
            definitions.row([q.numerators[0][j] * (below // q.denominator) for j in self.order])
            for q in limits
        ]
        return f"Flow {listed(rows)} {over} {listed(given)} {below}"

    def witnesses(self) -> Iterator[tuple[str, IntegerMatrix, int]]:
        """Yield for every flow where it begins, its inequality, and the factor that it has."""
        system, evidence = self.system, self.evidence
        added = iter(evidence.vanishing)
        for a, step, b in evidence.edges_in_time(system):
            if not isinstance(step, Step):
                continue  # A stay of some length, which Coq follows by itself
            form = evidence.inequality(step, a, b, system)
            if evidence.degree > 1:
                form = add(form, next(added))
            keeps = 2 * evidence.degree * evidence.rate
            below = [error[-1] ** 2 for error in step.errors]
            factor = lcm((keeps * step.over).as_integer_ratio()[1] * step.over, *below)
            yield step.source, form, factor


def flows_theorem(system: SwitchedSystem, evidence: FormsOnGraph) -> Theorem:
    """Return the theorem of a certificate in continuous time.

    Parameters
    ----------
    system : SwitchedSystem
        With one form for all its modes, and no force that would pull.
    evidence : FormsOnGraph
        That holds for it.
    """
    flows, definitions = FlowStatement(system, evidence), Definitions()
    modes, others = _define_modes(flows, definitions)
    _define_form(flows, definitions)
    gives, free_gives = _define_witnesses(flows, definitions)
    rate, factor = evidence.rate, factor_of(evidence.nodes[0].form)
    shape = f"{system.order} {evidence.degree} {rate.numerator} {rate.denominator} basis form"
    cut = f"{str(flows.lost).lower()}\n    {modes}\n    {others}"
    claim, sound, last = f"decays {shape}", "decays_sound", "checked eq_refl"
    if flows.acting:
        claim, sound, last = f"all_axes_decay {shape} multipliers", "all_axes_sound", "checked"
    rest = "_ " * 15
    return Theorem(
        LIBRARY,
        definitions.texts,
        f"flows_fall {shape} multipliers {factor} {cut}\n"
        f"    all_terms free_terms {gives} {free_gives}",
        f"{claim} {cut}\n  /\\ is_definite basis form {factor}",
        f"conj ({sound} {rest}{last}) (definite_sound {rest}checked)",
        tuple(system.states[i] for i in flows.order),
    )


def _define_modes(flows: FlowStatement, definitions: Definitions) -> tuple[str, str]:
    """Define every mode; return those in contact, and those of free motion."""
    system = flows.system
    free = system.free if flows.lost else ()
    names = identifiers(mode.name for mode in (*system.modes, *free))
    for k, mode in enumerate((*system.modes, *free)):
        definitions.define(names[mode.name], flows.flow(k, mode, definitions), mode.name)
    touching, flying = (listed(names[mode.name] for mode in part) for part in (system.modes, free))
    return touching, flying


def _define_form(flows: FlowStatement, definitions: Definitions) -> None:
    """Define the form with its monomials, and the multipliers of what other axes do."""
    n, given = flows.system.order, {item.fact: item.value for item in flows.evidence.multipliers}
    multipliers = (str(given.get(f"{COUPLING} {k}", 0)) for k in range(1, flows.acting + 1))
    definitions.define("basis", flows.basis(n))
    definitions.define("form", symmetric(flows.evidence.nodes[0].form))
    definitions.define("multipliers", f"{listed(multipliers)} : list Z")
    definitions.define("all_terms", flows.basis(n, flows.acting))
    terms = flows.basis(n - 1, flows.acting) if flows.lost else "[]"
    definitions.define("free_terms", f"{terms} : list mono")


def _define_witnesses(flows: FlowStatement, definitions: Definitions) -> tuple[str, str]:
    """Define the inequality of every flow; return those in contact, and those of free motion."""
    found: dict[bool, list[str]] = {False: [], True: []}
    for k, (place, gram, factor) in enumerate(flows.witnesses(), 1):
        text = f"Witness {symmetric(gram, long_integer)} {factor}"
        found[place.startswith(FREE)].append(definitions.define(f"witness{k}", text))
    return listed(found[False]), listed(found[True])
