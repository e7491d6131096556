"""Search for a form for each controller, where the samples of a stay are counted (untrusted).

While a controller is in force, its form decreases at a rate r of its own, faster than the rate rho
that is claimed; at a switch it may rise. So the forms of a stay grow from sample to sample: the
j-th is ``(rho/r)^2j`` times the first, and after N samples they have left room for the switch.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import MODES, Node, at_place
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import FREE
from nrs_design.proof.switching import NOWHERE, Clock
from nrs_design.search.acceptance import NO_MARGIN, Candidate, Candidates
from nrs_design.search.balance import own_norms, round_coordinates, separating
from nrs_design.search.branches import matrices_of_kinds
from nrs_design.search.drawing import Drawing, FormCoordinates, Inequality, Solution
from nrs_design.search.family import Family, limit_rate
from nrs_design.search.forms import FormsProgram
from nrs_design.search.graphs import KEPT, graph_of, search_together
from nrs_design.search.rates import Rates, digits, propose, rate_at
from nrs_design.search.work import Allowance

# Decay rates of the form of a controller in force, as shares of the slowest decay of its modes.
SHARES = (0.7, 0.4, 0.85, 0.2, 0.1)
# Positions of rates that are tried for each of them, and the share of the budget for this.
TEST_POSITIONS, TEST_SHARE = (0.0, 0.1, 0.25, 0.4, 0.6), 0.05
RATES = Rates(0.5, resolution=2.0**-5, nearest=0.99, few=True, bits=digits(24))
# Digits of how much larger the forms of a stay are than the first.
WEIGHT_BITS = 24

Array = NDArray[np.float64]
CountedStays = Sequence[Sequence[int]]


def stays_of(clock: Clock) -> CountedStays | None:
    """Return for each kind of modes the states of a stay in order, or None if it counts none."""
    last = [[k for k in range(clock.length) if clock.after(k, kind) == k] for kind in clock.kinds]
    if any(len(own) != 1 for own in last):
        return None
    ends, found = {own[0] for own in last}, list[list[int]]()
    for kind, (end,) in zip(clock.kinds, last, strict=True):
        before = {clock.after(k, kind): k for k in range(clock.length) if k not in ends}
        stay = [end]
        while (k := before.get(stay[0])) is not None and k not in stay:
            stay.insert(0, k)
        found.append(stay)
    states = sorted(state for stay in found for state in stay)
    return found if states == [*range(clock.length)] else None


def search_stays(family: Family) -> Candidates[FormsOnGraph]:
    """Search for one form under arbitrary switching; then for one for each controller."""
    clock = family.system.clock
    if clock is None or (stays := stays_of(clock)) is None:
        return NO_MARGIN
    free = replace(family, system=replace(family.system, clock=None))
    together = search_together(replace(free, allowance=family.allowance.part(TEST_SHARE)))
    everywhere = [(state, 1) for state in range(clock.length)]
    for candidate in together:
        graph = candidate.evidence
        yield Candidate(_copy_nodes(graph, [everywhere] * len(graph.nodes)), candidate.words)
    parts = matrices_of_kinds(family, clock)
    slowest = [limit_rate(own, Time.DISCRETE) for own in parts]
    limit = max(slowest)
    if not limit < 1:
        return NO_MARGIN
    programs = list[tuple[int, CountedProgram]]()
    for share in SHARES:
        own = [1 - share * (1 - rate) for rate in slowest]
        drawing = _draw(family, clock, stays, parts, own)
        if drawing.is_finite:
            program = CountedProgram(drawing, stays, own)
            programs.append((_reach(program, limit, family), program))
    coverings = (True, False) if family.system.roundings else (False,)
    # The most promising rates come first.
    for reached, program in sorted(programs, key=lambda item: -item[0]):
        if reached:
            yield from propose(program, family, limit, RATES, coverings)
    return NO_MARGIN


@dataclass(frozen=True)
class CountedProgram:
    """The program of the forms of first samples, whose solutions are forms of all samples."""

    drawing: Drawing
    stays: CountedStays  # States of a stay, for each controller
    rates: Sequence[float]  # Contraction of the form of each controller in force

    @cached_property
    def first(self) -> FormsProgram:
        """The program of first samples."""
        return FormsProgram(self.drawing, self._timed)

    def solve(self, rate: float, allowance: Allowance) -> Solution | None:
        """Return a solution at a rate."""
        return self.first.solve(rate, allowance)

    def own_rate(self, solution: Solution) -> float:
        """Return the rate that a solution shows at switches, no faster than that of any form."""
        return max(self.first.own_rate(solution), *self.rates)

    def roundings(
        self, solution: Solution, claim: Fraction, digits: Sequence[int], *, errors: bool = False
    ) -> Iterator[FormsOnGraph]:
        """Yield roundings of the forms of all samples."""
        return map(self._expanded, self.first.roundings(solution, claim, digits, errors=errors))

    def _timed(self, edge: Inequality) -> Inequality:
        """Return an inequality between forms of first samples, with the decay over the stay."""
        rate, count = self.rates[edge.before], len(self.stays[edge.before])
        if edge.before == edge.after:
            return replace(edge, lasts=0.0, share=rate**-2)
        return replace(edge, lasts=count, share=rate ** (2 * (count - 1)))

    def _expanded(self, graph: FormsOnGraph) -> FormsOnGraph:
        """Return the forms of every sample of a stay, from those of the first ones."""
        places = len(graph.nodes) // len(self.stays)
        copies = []
        for stay, rate in zip(self.stays, self.rates, strict=True):
            growth = (float(graph.rate) / rate) ** 2
            weights = [round(growth**spent * 2**WEIGHT_BITS) for spent in range(len(stay))]
            copies += [[*zip(stay, weights, strict=True)]] * places
        log2 = graph.denominator_log2 + WEIGHT_BITS
        return _copy_nodes(replace(graph, denominator_log2=log2), copies)


def _copy_nodes(graph: FormsOnGraph, copies: Sequence[Sequence[tuple[int, int]]]) -> FormsOnGraph:
    """Return a graph with copies of nodes; a copy has a clock state and a weight of the form."""
    nodes, targets = list[Node](), list[list[tuple[int, int]]]()
    for node, own in zip(graph.nodes, copies, strict=True):
        targets.append([(len(nodes) + k, weight) for k, (_, weight) in enumerate(own)])
        word, _, _ = node.place.partition(" ")
        for state, weight in own:
            form = tuple(tuple(weight * entry for entry in row) for row in node.form)
            nodes.append(Node(at_place(word, state), form))
    multipliers = (
        item._replace(value=weight * item.value, target=target)
        for item in graph.multipliers
        for own in (targets if item.target is None else [targets[item.target]])
        for target, weight in own
    )
    return replace(graph, nodes=tuple(nodes), multipliers=tuple(multipliers))


def _reach(program: CountedProgram, limit: float, family: Family) -> int:
    """Return how many of some rates, the slowest first, a program has a solution for."""
    part, found = family.allowance.part(TEST_SHARE), 0
    for position in TEST_POSITIONS:
        if program.solve(rate_at(position, limit, Time.DISCRETE), part) is None:
            break
        found += 1
    return found


def _draw(
    family: Family,
    clock: Clock,
    stays: CountedStays,
    parts: Sequence[Array],
    rates: Sequence[float],
) -> Drawing:
    """Draw a node for each controller, as if a stay had one state."""
    system, is_unilateral = family.system, family.system.contact is not None
    targets = tuple(
        tuple(
            other if clock.after(stay[-1], other) is not None else NOWHERE for other in clock.kinds
        )
        for stay in stays
    )
    short = replace(system, clock=replace(clock, length=len(stays), ahead=targets))
    places = [MODES, FREE] if is_unilateral else [MODES]
    places_of_nodes = [at_place(place, k) for k in clock.kinds for place in places]
    find_coordinates = separating if is_unilateral else round_coordinates

    def coordinates(matrices: Array, rate: float) -> FormCoordinates:
        mean = matrices.mean(axis=0)
        slowed_mean = mean / max(rate, limit_rate(mean[None], Time.DISCRETE) / KEPT)
        return FormCoordinates(
            family.exponents, find_coordinates(own_norms(slowed_mean[None], Time.DISCRETE)[0])
        )

    forms = tuple(k for k in clock.kinds for _ in places)
    coordinates_of_forms = tuple(map(coordinates, parts, rates))
    return Drawing(
        short, graph_of(places_of_nodes, len(system.roundings)), forms, coordinates_of_forms
    )
