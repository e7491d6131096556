"""Put the proofs of cases together: each has places of its own, and no step leads to another."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import accumulate

from nrs_design.loop.cases import name_in_case
from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import Multiplier, Node, at_place
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import ROUNDING
from nrs_design.proof.system import SwitchedSystem

# The system of a case with what proves it.
ProvedCase = tuple[SwitchedSystem, FormsOnGraph]


def joined(system: SwitchedSystem, parts: Sequence[FormsOnGraph]) -> FormsOnGraph:
    """Return the evidence on all cases of a system from that on each, in their order.

    All of a form and its multipliers may be scaled, so no denominator matters. What is rounded is
    covered where it is in every case.
    """
    rates, flows = [part.rate for part in parts], system.time is Time.CONTINUOUS
    rounded = all(part.covers_rounding for part in parts)
    first = accumulate((len(part.nodes) for part in parts), initial=0)
    return FormsOnGraph(
        tuple(
            Node(at_place(node.place, k), node.form)
            for k, part in enumerate(parts)
            for node in part.nodes
        ),
        max(part.denominator_log2 for part in parts),
        min(rates) if flows else max(rates),
        multipliers=tuple(
            item
            for k, (begin, part) in enumerate(zip(first, parts, strict=False))
            for item in _multipliers(part, begin, k if flows else None)
            if rounded or not item.fact.startswith(ROUNDING)
        ),
    )


def _multipliers(part: FormsOnGraph, begin: int, case: int | None) -> Iterator[Multiplier]:
    """Yield the multipliers of a part of which the nodes begin there; a fact may name a mode."""
    for item in part.multipliers:
        fact = item.fact if case is None else name_in_case(item.fact, case)
        targets = range(len(part.nodes)) if item.target is None else [item.target]
        yield from (Multiplier(fact, item.value, begin + target) for target in targets)
