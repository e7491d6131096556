"""Forms on a graph in integers (untrusted)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import Multiplier, Node, lifted
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import Step
from nrs_design.search.drawing import Fact, Solution, entries_of, states_at
from nrs_design.search.polynomial import make_vanish, products
from nrs_design.search.rounding import numerators, round_form, round_rate
from nrs_design.search.stays import enough_pieces

if TYPE_CHECKING:
    from nrs_design.search.forms import FormsProgram

Array = NDArray[np.float64]

# What is rounded takes a little more than in the first order.
LOST_TO_ERRORS = 1.25


def rounded_forms(
    program: FormsProgram,
    solution: Solution,
    claim: Fraction,
    digits: Sequence[int],
    *,
    errors: bool = False,
) -> Iterator[FormsOnGraph]:
    """Yield roundings of all forms to integers over one denominator.

    The claimed rate holds for the solution in floating point. `errors`: errors that were not
    solved for are covered, at a rate that leaves room.
    """
    drawing, coordinates = program.drawing, program.drawing.coordinates
    inverses = [np.linalg.inv(one.T) for one in coordinates]
    balanced = [V.T @ Q @ V for V, Q in zip(inverses, solution.forms, strict=True)]
    exponent = int(np.frexp(max(np.abs(Q).max() for Q in balanced))[1])
    top = max(int(one.exponents.max()) for one in coordinates)
    scales = np.array([*program.scales.values()])
    multipliers = np.ldexp(solution.multipliers * scales, -program.unit)
    found = dict(zip(program.scales, multipliers, strict=True))
    if errors:
        taus, claim = _allow_for(program, solution, claim)
        if claim >= 1:
            return
        found |= taus
    for bits in digits:
        if bits != digits[-1] and not errors:
            coarse = [_rounded(Q, bits - exponent) for Q in balanced]
            own = [one.T.T @ Q @ one.T for one, Q in zip(coordinates, coarse, strict=True)]
            if not program.margins(replace(solution, forms=own), float(claim)).min() > 0:
                continue
        log2 = bits + 2 * top
        whole = [
            round_form(Q, top - one.exponents, bits - exponent)
            for one, Q in zip(coordinates, balanced, strict=True)
        ]
        nodes = []
        for node, k in zip(drawing.graph.nodes, drawing.forms, strict=True):
            kept = entries_of(drawing, k, states_at(drawing, node))
            nodes.append(Node(node.place, tuple(tuple(whole[k][i][j] for j in kept) for i in kept)))
        values = numerators(np.array([*found.values()]), log2 - exponent)
        facts = tuple(
            Multiplier(name, value, target)
            for (name, b), value in zip(found, values, strict=True)
            for target in ([None] if b is None else drawing.like(b))
        )
        graph = replace(
            drawing.graph,
            nodes=tuple(nodes),
            denominator_log2=max(log2, 0),
            rate=claim,
            multipliers=facts,
        )
        if graph.stays and graph.stays.leaving and program.time is Time.CONTINUOUS:
            # How finely stays of any length are enclosed.
            if (pieces := enough_pieces(drawing.system, graph)) is None:
                continue
            graph = replace(graph, stays=replace(graph.stays, pieces=pieces))
        if program.degree > 1:
            forms = _round_vanishing(program, graph, solution, bits - exponent, top)
            graph = replace(graph, vanishing=forms)
        yield graph


def _round_vanishing(
    program: FormsProgram, graph: FormsOnGraph, solution: Solution, bits: int, top: int
) -> tuple[tuple[tuple[int, ...], ...], ...]:
    """Round forms so that they vanish exactly, in the units of the exact inequalities."""
    found, timed = [], [k for k, edge in enumerate(program.every) if edge.is_strict]
    for k, (_, step, _) in zip(timed, graph.edges_in_time(program.drawing.system), strict=True):
        edge = program.every[k]
        assert isinstance(step, Step)  # polynomials are enclosed by nobody
        exponents = program.drawing.coordinates[edge.before].exponents[edge.kept]
        N = round_form(solution.vanishing[program.stands_for[k]], top - exponents, bits)
        factor, unit = _factor(step, program.degree, graph.rate), program.unit * edge.is_flow
        scaled = [[_shift(factor * entry, -unit) for entry in row] for row in N]
        groups = products(program.variables(edge.size), program.degree)
        found.append(tuple(map(tuple, make_vanish(scaled, groups))))
    return tuple(found)


def _allow_for(
    program: FormsProgram, solution: Solution, claim: Fraction
) -> tuple[dict[Fact, float], Fraction]:
    """Return multipliers of errors, and what is left of a rate if a form loses what they take.

    In the norm of the forms, an error of size ``s`` times that of the state takes ``2 s`` of
    V; with the multiplier ``|C| / |q|`` half of it is taken by either term.
    """
    pushed, sizes = dict[Fact, float](), dict[Fact, float]()
    loss: dict[int, set[Fact]] = {}
    for edge in program.every:
        L, inverse = (
            np.linalg.cholesky(solution.forms[k][np.ix_(entries, entries)])
            for k, entries in ((edge.after, edge.left), (edge.before, edge.kept))
        )
        inverse = np.linalg.inv(inverse)
        for error in edge.errors:
            fact = error.fact
            pushed[fact] = max(pushed.get(fact, 0.0), float(np.linalg.norm(error.column @ L)))
            size = float(np.linalg.norm(inverse @ error.q))
            sizes[fact] = max(sizes.get(fact, 0.0), size)
            loss.setdefault(fact[1] or 0, set()).add(fact)
    worst = max(sum(2 * pushed[f] * sizes[f] for f in facts) for facts in loss.values())
    taus = {f: pushed[f] / sizes[f] if pushed[f] * sizes[f] else 1.0 for f in pushed}
    left = float(claim) ** 2 + LOST_TO_ERRORS * worst
    return taus, round_rate(float(np.sqrt(left)), Time.DISCRETE)


def _factor(step: Step, degree: int, rate: Fraction) -> int:
    """Return what the exact inequality of a lifted step is multiplied with."""
    moved = lifted(step, degree, rate)
    if not step.is_flow:
        return int(moved.units[0]) ** 2
    return (2 * degree * rate * moved.over).denominator * moved.over


def _shift(value: int, exponent: int) -> int:
    return value << exponent if exponent >= 0 else value >> -exponent


def _rounded(Q: Array, bits: int) -> Array:
    """Round to so many bits after the binary point, in floating point."""
    return np.asarray(np.ldexp(np.rint(np.ldexp((Q + Q.T) / 2, bits)), -bits))
