"""One semidefinite program for forms on any graph that is drawn (untrusted).

Margin form: maximize t subject to ``0 <= Q <= I`` for every form and the inequality of every edge
with at least t to spare. The edges are those of the evidence, in floating point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import log, sqrt

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import Multiplier, Node, lifted
from nrs_design.proof.lift import monomials
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import Step
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import balance, scale_states, time_unit
from nrs_design.search.drawing import (
    Drawing,
    Fact,
    Inequality,
    Solution,
    distinct,
    entries_of,
    inequalities,
    states_at,
)
from nrs_design.search.interior_point import maximize, step_cost
from nrs_design.search.polynomial import make_vanish, products, vanishing_basis
from nrs_design.search.rates import numerators, rate_at, round_form, round_rate
from nrs_design.search.sdp import STEPS, SemidefiniteProgram, pack, packed_columns, unpack
from nrs_design.search.stays import enough_pieces
from nrs_design.search.work import Allowance, Cost

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# With so many edges a program begins.
FIRST_EDGES, FEW_EACH = 8, 2
# Least margin of an edge outside the program, relative to the margins of its edges.
NEARLY_ALL = 0.8
# Work for the first edges from which on a general solver is not asked, nor for one form: to load it
# takes longer than to find that. Our own method is content with this share of the margin instead.
# It begins with multipliers of this size, or at this share of what it found last.
DEAR, BARELY = 0.05, 0.1
START_MULTIPLIER, RESTART_SHARE = 0.1, 0.7
# A multiplier of a crossing lies between 0 and this, where all numbers are of like size.
LARGEST_MULTIPLIER = 64.0
# Forms reach up to the identity where there are any; all of them below this are zero.
NOTHING = 1e-4
# Rounding error where a form need not decrease, relative to its size.
SLACK = 1e-9
# Loss to rounding errors, as multiples of the loss of first order.
LOST_TO_ERRORS = (1.25, 3.0)


@dataclass(frozen=True)
class DualSolution:
    """A solution, with its dual variables: how much a unit of an inequality adds to the margin."""

    solution: Solution
    duals: Mapping[int, Array]  # A form for each edge of the program, by its number


class FormsProgram:
    """The program of a drawing, at any rate."""

    def __init__(
        self, drawing: Drawing, timed: Callable[[Inequality], Inequality] = lambda edge: edge
    ) -> None:
        """State the inequalities of a drawing; `timed` says what each leaves of a form."""
        self.drawing = drawing
        self.time, self.degree = drawing.system.time, drawing.graph.degree
        self.sizes = [len(one.T) for one in drawing.coordinates]
        stated_edges, self.scales = inequalities(drawing)
        self.every = [timed(edge) for edge in stated_edges]
        self.edges, self.stands_for = distinct(self.every)
        count = len(self.edges)
        # With few edges for each form, nearly all are needed.
        whole = self.degree > 1 or count <= FEW_EACH * len(self.sizes)
        edge_count = count if whole else min(count, FIRST_EDGES)
        # Edges of the program; an edge that a solution violates is added, and stays.
        self.active = sorted({k * (count - 1) // max(edge_count - 1, 1) for k in range(edge_count)})
        flows = [np.abs(edge.M).max() for edge in self.edges if edge.is_flow]
        if flows and self.degree > 1:
            # The unit of the modes themselves: lifted entries, and margins with them, grow with
            # the degree.
            mode_matrices = np.array([mode.A.floats() for mode in drawing.system.modes])
            flows = [float(np.abs(scale_states(mode_matrices, balance(mode_matrices))).max())]
        self.unit = time_unit(np.array(max(flows))[None], self.time) if flows else 0
        self._last: Array | None = None  # What our own method found last

    @property
    def _building(self) -> Cost:
        """Predict the memory for the images of all forms: packed, and in full for one edge."""
        sizes = [(self.edges[k].size, self.sizes[self.edges[k].before]) for k in self.active]
        full = [8.0 * size**2 * n * (n + 1) / 2 for size, n in sizes]
        return Cost(0.0, sum(full) / 2 + 3 * max(full, default=0.0))

    @cached_property
    def is_dear(self) -> bool:
        """Tell whether our own method is faster than a general solver.

        It begins where every inequality has room, and knows quadratic forms only.
        """
        if self.degree > 1 or not all(edge.is_strict for edge in self.edges):
            return False
        program = self._program(self.active, rate_at(0.0, 1.0, self.time))
        whole = program.cost().work
        own = STEPS * step_cost(program.groups, program.unknowns).work
        return len(self.sizes) == 1 or own < whole > DEAR

    @cached_property
    def _vanishing(self) -> list[Array]:
        """Return a basis of the forms that vanish, for each edge."""
        if self.degree == 1:
            return [np.zeros((0, edge.size, edge.size)) for edge in self.edges]
        found: dict[tuple[int, int], Array] = {}
        for edge in self.edges:
            key = edge.before, edge.size
            if key not in found:
                exponents = self.drawing.coordinates[edge.before].exponents[edge.kept]
                variables = self.variables(edge.size)
                found[key] = vanishing_basis(variables, self.degree, -exponents)
        return [found[edge.before, edge.size] for edge in self.edges]

    def variables(self, size: int) -> int:
        """Return the number of states of so many monomials."""
        return next(
            n
            for n in range(1, self.drawing.system.order + 1)
            if len(monomials(n, self.degree)) == size
        )

    def solve(self, rate: float, allowance: Allowance) -> Solution | None:
        """Maximize the margin at a rate; None if it is not positive.

        Of many edges of quadratic forms, only those are kept to which the last solution left a
        margin well below that of the others.
        """
        allowance.require(self._building, f"a program of {self._starts[-1] + 1} unknowns or more")
        while True:
            solution = self.solve_for(self.active, rate, allowance)
            if solution is None or len(self.active) == len(self.edges):
                return solution
            margins, known = self.margins(solution, rate), set(self.active)
            strict = np.array([edge.is_strict for edge in self.edges])
            share = BARELY if self.is_dear else NEARLY_ALL
            enough = share * min((margins[k] for k in known if strict[k]), default=0.0)
            tight = ~(margins > np.where(strict, max(enough, 0.0), 0.0))
            added = [k for k in np.argsort(margins) if tight[k] and k not in known]
            if not added:
                return solution
            self.active = sorted([*known, *added[: len(known)]])

    def solve_for(
        self, active: Sequence[int], rate: float, allowance: Allowance
    ) -> Solution | None:
        """Solve for some of the edges; None if there is no margin.

        Our own method goes on from where the last one ended, if it ended.
        """
        program = self._program(active, rate)
        if self.is_dear:
            y = maximize(program.groups, self._start(), allowance)
            if y is not None:
                self._last = y if y[-1] > 0 else self._last
                return self._read(y, rate)
        found = program.maximize(allowance)
        return None if found is None else self._read(found.x, rate)

    def solve_dual(self, rate: float, allowance: Allowance) -> DualSolution | None:
        """Solve at a rate, for the dual variables as well; None without a margin."""
        if self.solve(rate, allowance) is None:
            return None
        # Enough of the edges, as the solution has found.
        found = self._program(self.active, rate).maximize(allowance)
        solution = None if found is None else self._read(found.x, rate)
        if found is None or solution is None:
            return None
        own = found.duals[len(found.duals) - len(self.active) :]
        return DualSolution(solution, dict(zip(self.active, own, strict=True)))

    def _start(self) -> Array:
        """Return forms and multipliers inside their bounds, and their margin if it is known."""
        if self._last is not None:
            return RESTART_SHARE * self._last
        halves = [pack(np.eye(n) / 2) for n in self.sizes]
        return np.array([*np.concatenate(halves), *[START_MULTIPLIER] * len(self.scales), 0.0])

    @cached_property
    def _kinds(self) -> list[tuple[list[int], Inequality]]:
        """Put edges together that differ in their numbers alone: which, and a stack of them."""
        groups: dict[object, list[int]] = {}
        for k, edge in enumerate(self.edges):
            groups.setdefault((edge.kind, k if self.degree > 1 else None), []).append(k)
        found = []
        for members in groups.values():
            first, edges = self.edges[members[0]], [self.edges[k] for k in members]
            facts_of = tuple(
                (fact, np.array([edge.facts[i][1] for edge in edges]))
                for i, (fact, _) in enumerate(first.facts)
            )
            M = np.array([edge.M for edge in edges])
            found.append((members, replace(first, M=M, facts=facts_of)))
        return found

    @cached_property
    def _starts(self) -> list[int]:
        """Index of the first unknown of each form, and of the multipliers behind them."""
        return [0, *(int(end) for end in np.cumsum([n * (n + 1) // 2 for n in self.sizes]))]

    def _program(self, active: Sequence[int], rate: float) -> SemidefiniteProgram:
        """State the inequalities of some edges at a rate, which are the last blocks."""
        starts, place = self._starts, {fact: k for k, fact in enumerate(self.scales)}
        free = starts[-1] + len(place)
        last = free + sum(len(self._vanishing[k]) for k in active)
        program, one = SemidefiniteProgram(last + 1), np.ones((1, 1))
        for first, n in zip(starts, self.sizes, strict=False):
            form, identity = np.eye(n * (n + 1) // 2), np.eye(n)
            program.add(0 * identity, [(first, form), (last, packed_columns(-identity[None]))])
            program.add(identity, [(first, -form)])
        for k in range(starts[-1], free):
            program.add(0 * one, [(k, one)])
            program.add(LARGEST_MULTIPLIER * one, [(k, -one)])
        factors = self.factors(rate)
        for k in active:
            edge = self.edges[k]
            images = edge.images(starts, self.sizes, 1.0, factors[k], self.unit)
            images += [
                (starts[-1] + place[fact], packed_columns(own[None])) for fact, own in edge.facts
            ]
            if len(vanishing := self._vanishing[k]):
                images.append((free, packed_columns(vanishing)))
                free += len(vanishing)
            if edge.is_strict:
                images.append((last, packed_columns(-np.eye(edge.size)[None])))
            program.add(np.zeros((edge.size, edge.size)), images)
        return program

    def factors(self, rate: float) -> list[float]:
        """Return twice the rate for a flow, and the weight of the form after a map."""
        return [
            2 * self.degree * float(np.ldexp(rate, self.unit))
            if edge.is_flow
            else edge.weight(rate, self.degree, self.time)
            for edge in self.edges
        ]

    def _read(self, x: Array, rate: float) -> Solution | None:
        """Take apart what the solver returned, in the units of edges; None without a margin."""
        *packed, multipliers_and_forms = np.split(x[:-1], self._starts[1:])
        forms = [unpack(part, n) for part, n in zip(packed, self.sizes, strict=True)]
        if x[-1] <= 0 or max(np.abs(Q).max() for Q in forms) < NOTHING:
            return None
        multipliers, free = np.split(multipliers_and_forms, [len(self.scales)])
        share = 1.0 if self.time is Time.CONTINUOUS else float(rate ** (2 * self.degree))
        if self.degree == 1:
            return replace(self.solution_of(forms), multipliers=share * multipliers)
        # Inequalities of maps have been divided by the weight of the form after the step.
        weights = [
            1.0 if edge.is_flow else 1 / f
            for edge, f in zip(self.edges, self.factors(rate), strict=True)
        ]
        # Where forms vanish, all edges are active.
        counts = np.cumsum([len(basis) for basis in self._vanishing])[:-1]
        vanishing = [
            weight * np.tensordot(part, basis, axes=1)
            for weight, part, basis in zip(
                weights, np.split(free, counts), self._vanishing, strict=True
            )
        ]
        return Solution(forms, share * multipliers, vanishing)

    def _form(self, edge: Inequality, solution: Solution, N: Array) -> Array:
        """Return the inequality of an edge without the term of the rate."""
        Q = solution.forms[edge.after][np.ix_(edge.left, edge.left)]
        form = -np.ldexp(edge.changed(Q), self.unit if edge.is_flow else 0) + N
        place = {fact: k for k, fact in enumerate(self.scales)}
        for fact, own in edge.facts:
            form = form + solution.multipliers[place[fact]] * own
        return np.asarray(form)

    def decrease(self, edge: Inequality, solution: Solution, N: Array, rate: float) -> Array:
        """Return the form of an edge that must be positive, here or in a drawing of the same shape.

        N is the form that vanishes; the rate is in 1/s, or per step.
        """
        Q = solution.forms[edge.before][np.ix_(edge.kept, edge.kept)]
        if edge.is_flow:
            weight = -2 * self.degree * float(np.ldexp(rate, self.unit))
        else:
            weight = 1 / edge.weight(rate, self.degree, self.time)
        return np.asarray(self._form(edge, solution, N) + weight * Q)

    def edges_at(self, system: SwitchedSystem) -> list[Inequality]:
        """Return the edges for another system of the same shape, in the same units."""
        all_edges, _ = inequalities(replace(self.drawing, system=system), self.scales)
        first = [self.stands_for.index(k) for k in range(len(self.edges))]
        return [all_edges[k] for k in first]

    def solution_of(self, forms: list[Array]) -> Solution:
        """Return quadratic forms, however they were found, as a solution without facts."""
        return Solution(forms, np.zeros(0), [np.zeros((1, 1))] * len(self.edges))

    def margins(self, solution: Solution, rate: float) -> Array:
        """Return the smallest eigenvalue of every inequality; it may be a little below zero.

        That is where a form need not decrease.
        """
        margins = np.zeros(len(self.edges))
        for members, edge in self._kinds:
            slack = 0.0
            if not edge.is_strict:
                Q = solution.forms[edge.before][np.ix_(edge.kept, edge.kept)]
                slack = SLACK * np.abs(Q).max()
            form = self.decrease(edge, solution, solution.vanishing[members[0]], rate)
            margins[members] = np.linalg.eigvalsh(form)[:, 0] + slack
        return margins

    def own_rate(self, solution: Solution) -> float:
        """Return the rate that a solution shows where every edge is a flow or some steps.

        A form that is not positive definite shows mere stability at most.
        """
        rates, stable = list[float](), rate_at(0.0, 1.0, self.time)
        for members, edge in self._kinds:
            Q, N = solution.forms[edge.before], solution.vanishing[members[0]]
            Q = Q[np.ix_(edge.kept, edge.kept)]
            try:
                inverse = np.linalg.inv(np.linalg.cholesky(Q))
            except np.linalg.LinAlgError:
                return stable
            form = inverse @ self._form(edge, solution, N) @ inverse.T
            smallest = float(np.linalg.eigvalsh(form)[:, 0].min())
            if edge.is_flow:
                rates.append(float(np.ldexp(smallest / (2 * self.degree), -self.unit)))
            elif edge.lasts:
                # Nothing may be left of a form, which no logarithm takes.
                contraction = max(-smallest * edge.share, np.finfo(float).tiny)
                power = 0.5 / (self.degree * edge.lasts)
                continuous = self.time is Time.CONTINUOUS
                rates.append(-power * log(contraction) if continuous else contraction**power)
        slowest = min if self.time is Time.CONTINUOUS else max
        return slowest(rates, default=stable)

    def roundings(
        self, solution: Solution, claim: Fraction, digits: Sequence[int], *, errors: bool = False
    ) -> Iterator[FormsOnGraph]:
        """Yield roundings of all forms to integers over one denominator.

        The claimed rate holds for the solution in floating point. `errors`: errors that were not
        solved for are covered, at a rate that leaves room.
        """
        drawing, coordinates = self.drawing, self.drawing.coordinates
        inverses = [np.linalg.inv(one.T) for one in coordinates]
        balanced = [V.T @ Q @ V for V, Q in zip(inverses, solution.forms, strict=True)]
        exponent = int(np.frexp(max(np.abs(Q).max() for Q in balanced))[1])
        top = max(int(one.exponents.max()) for one in coordinates)
        scales = np.array([*self.scales.values()])
        multipliers = np.ldexp(solution.multipliers * scales, -self.unit)
        found = dict(zip(self.scales, multipliers, strict=True))
        taus, worst = _taken_by_errors(self, solution) if errors else ({}, 0.0)
        found |= taus
        for loss_factor, bits in product(LOST_TO_ERRORS if errors else (0.0,), digits):
            rate = claim
            if errors:
                rate = round_rate(sqrt(float(claim) ** 2 + loss_factor * worst), Time.DISCRETE)
            if errors and rate >= 1:
                return
            if bits != digits[-1] and not errors:
                coarse = [_round_floats(Q, bits - exponent) for Q in balanced]
                own = [one.T.T @ Q @ one.T for one, Q in zip(coordinates, coarse, strict=True)]
                if not self.margins(replace(solution, forms=own), float(claim)).min() > 0:
                    continue
            log2 = bits + 2 * top
            whole = [
                round_form(Q, top - one.exponents, bits - exponent)
                for one, Q in zip(coordinates, balanced, strict=True)
            ]
            nodes = []
            for node, k in zip(drawing.graph.nodes, drawing.forms, strict=True):
                kept = entries_of(drawing, k, states_at(drawing, node))
                nodes.append(
                    Node(node.place, tuple(tuple(whole[k][i][j] for j in kept) for i in kept))
                )
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
                rate=rate,
                multipliers=facts,
            )
            if graph.stays and graph.stays.leaving and self.time is Time.CONTINUOUS:
                # Number of pieces of an enclosed stay.
                if (pieces := enough_pieces(drawing.system, graph)) is None:
                    continue
                graph = replace(graph, stays=replace(graph.stays, pieces=pieces))
            if self.degree > 1:
                forms = _round_vanishing(self, graph, solution, bits - exponent, top)
                graph = replace(graph, vanishing=forms)
            yield graph


def _round_vanishing(
    program: FormsProgram, graph: FormsOnGraph, solution: Solution, bits: int, top: int
) -> tuple[tuple[tuple[int, ...], ...], ...]:
    """Round forms so that they vanish exactly, in the units of the exact inequalities."""
    found, timed = [], [k for k, edge in enumerate(program.every) if edge.is_strict]
    for k, (_, step, _) in zip(timed, graph.edges_in_time(program.drawing.system), strict=True):
        edge = program.every[k]
        assert isinstance(step, Step)  # no polynomial has enclosed stays
        exponents = program.drawing.coordinates[edge.before].exponents[edge.kept]
        N = round_form(solution.vanishing[program.stands_for[k]], top - exponents, bits)
        factor, unit = _factor(step, program.degree, graph.rate), program.unit * edge.is_flow
        scaled = [[_shift_bits(factor * entry, -unit) for entry in row] for row in N]
        groups = products(program.variables(edge.size), program.degree)
        found.append(tuple(map(tuple, make_vanish(scaled, groups))))
    return tuple(found)


def _taken_by_errors(program: FormsProgram, solution: Solution) -> tuple[dict[Fact, float], float]:
    """Return multipliers of errors, and which share of a form they take in a step.

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
    return taus, worst


def _factor(step: Step, degree: int, rate: Fraction) -> int:
    """Return the factor of the exact inequality of a lifted step."""
    lifted_step = lifted(step, degree, rate)
    if not step.is_flow:
        return int(lifted_step.units[0]) ** 2
    return (2 * degree * rate * lifted_step.over).denominator * lifted_step.over


def _shift_bits(value: int, exponent: int) -> int:
    return value << exponent if exponent >= 0 else value >> -exponent


def _round_floats(Q: Array, bits: int) -> Array:
    """Round to so many bits after the binary point, in floating point."""
    return np.asarray(np.ldexp(np.rint(np.ldexp((Q + Q.T) / 2, bits)), -bits))
