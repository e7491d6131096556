"""Discrete time: forms for all modes, with roundings and lost contact, as a theorem of Coq."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import gcd, lcm

from nrs_design.coq.text import (
    AbstractStatement,
    Definitions,
    Theorem,
    factor_of,
    listed,
    reordered,
    symmetric,
)
from nrs_design.proof.evidence.graph import FormsOnGraph
from nrs_design.proof.mode import Mode
from nrs_design.proof.steps import FREE, LOST, ROUNDING
from nrs_design.proof.system import SwitchedSystem

LIBRARY = ("forms", "steps", "sampled")


@dataclass(frozen=True)
class SampledStatement(AbstractStatement):
    """A system in discrete time, and its forms."""

    def mode(self, k: int, mode: Mode, definitions: Definitions) -> str:
        """Return the k-th mode: units, columns, and bounds of the errors, in integers.

        The unit of a state is the least multiple of the denominator of the rate in which its column
        and the bounds are integers.
        """
        before = self.order[1:] if k >= len(self.system.modes) else self.order
        roundings = self.system.roundings if self.evidence.covers_rounding else ()
        parts = [([row[j] for row in mode.A.numerators], mode.A.denominator) for j in before]
        added = (item.columns[k] for item in roundings)
        parts += [([row[0] for row in M.numerators], M.denominator) for M in added]
        bounds = [
            ([item.rows[k].numerators[0][j] for j in before], item.rows[k].denominator)
            for item in roundings
        ]
        units = [
            lcm(
                self.evidence.rate.denominator if j < len(before) else 1,
                below // gcd(below, *column),
                *(over // gcd(over, q[j]) for q, over in bounds if j < len(before)),
            )
            for j, (column, below) in enumerate(parts)
        ]
        columns = [
            definitions.row([unit * column[i] // below for i in self.order])
            for unit, (column, below) in zip(units, parts, strict=True)
        ]
        rows = [
            definitions.row([u * e // over for u, e in zip(units, q, strict=False)])
            for q, over in bounds
        ]
        return f"Mode {definitions.row(units)} {listed(columns)} {listed(rows)}"

    def nodes(self, *, free: bool) -> list[int]:
        """Return the numbers of the forms in contact, or in free motion."""
        return [
            k for k, node in enumerate(self.evidence.nodes) if node.place.startswith(FREE) == free
        ]

    def node(self, k: int) -> str:
        """Return a form with the multipliers of the constraints on steps to the form."""
        found = {
            item.fact: item.value
            for target in (None, k)
            for item in self.evidence.multipliers
            if item.target == target
        }
        count = len(self.system.roundings) if self.evidence.covers_rounding else 0
        errors = [found.get(f"{ROUNDING} {i}", 0) for i in range(1, count + 1)]
        form = self.evidence.nodes[k].form
        order = [i for i in self.order if i < len(form)]
        return (
            f"Node {symmetric(reordered(form, order))} {found.get(LOST, 0)} "
            f"{listed(map(str, errors))}"
        )

    def sources(self, modes: Sequence[Mode], nodes: list[int]) -> str:
        """Return for each mode the place among some nodes of one from which it leads to all."""
        ways = {(edge.source, edge.mode) for edge in self.evidence.edges}
        found = (
            next(
                place
                for place, a in enumerate(nodes)
                if not ways.isdisjoint({(None, None), (a, None), (None, mode.name), (a, mode.name)})
            )
            for mode in modes
        )
        return f"{listed(map(str, found))}%nat"


def sampled_theorem(system: SwitchedSystem, evidence: FormsOnGraph) -> Theorem:
    """Return the theorem of a certificate in discrete time, with quadratic forms for all modes."""
    sampled, definitions = SampledStatement(system, evidence), Definitions()
    modes, flying = sampled.define_modes(definitions)
    nodes, free_nodes = sampled.nodes(free=False), sampled.nodes(free=True)
    definitions.define("nodes", listed(map(sampled.node, nodes)))
    definitions.define("free_nodes", f"{listed(map(sampled.node, free_nodes))} : list node")
    rate, factor = evidence.rate, max(factor_of(node.form) for node in evidence.nodes)
    size = f"{len(system.roundings) if evidence.covers_rounding else 0} {system.order}"
    computed = f"{rate.numerator} {rate.denominator} {factor} {size}\n    {modes}"
    bound = f"({rate.numerator} / {rate.denominator})%R {factor}%R"
    sources = sampled.sources(system.modes, nodes)
    if not sampled.lost:
        return Theorem(
            LIBRARY,
            definitions.texts,
            f"kept {computed}\n    nodes {sources}",
            f"decays (step {size}\n    {modes})\n"
            f"    (largest (map form nodes)) (norm2 {system.order}) {bound}",
            "kept_sound _ _ _ _ _ _ _ _ checked",
            system.states,
        )
    return Theorem(
        LIBRARY,
        definitions.texts,
        f"losable {computed}\n    {flying}\n"
        f"    nodes free_nodes {sources} {sampled.sources(system.free, free_nodes)}",
        f"decays (losable_step {size}\n    {modes}\n    {flying})\n"
        f"    (conewise nodes free_nodes) (conewise_size {system.order}) {bound}",
        "losable_sound _ _ _ _ _ _ _ _ _ _ _ checked",
        tuple(system.states[i] for i in sampled.order),
    )
