"""One semidefinite program for forms on any graph that is drawn (untrusted).

Margin form: maximize t subject to ``0 <= Q <= I`` for every form and the inequality of every edge
with at least t to spare. The edges are those of the evidence, in floating point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import chain
from math import exp, isfinite

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import AnyStep, Multiplier, Node, lifted
from nrs_design.proof.lift import monomials
from nrs_design.proof.mode import Time
from nrs_design.proof.stays import EnclosedStep
from nrs_design.proof.steps import Step
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import balance, scale_states
from nrs_design.search.cones import ConeKind, FormsCones, FormTerm
from nrs_design.search.family import NEARLY
from nrs_design.search.float_step import FloatStep
from nrs_design.search.interior_point import FormsPoint, maximize
from nrs_design.search.lifted import make_vanish, products, vanishing_basis
from nrs_design.search.lmi import FEWEST_STEPS, time_unit
from nrs_design.search.pieces import enough_pieces
from nrs_design.search.rounding import numerators, round_form, round_rate
from nrs_design.search.sdp import STEPS, Maximum, begin, maximize_margin, unpack
from nrs_design.work import Allowance, Cost

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
# The name of a fact, and the node after the step if there are several that it is known of.
Fact = tuple[str, int | None]

# What is rounded takes a little more than in the first order.
LOST_TO_ERRORS = 1.25
# Times at which a stay of any length in a range is looked at: for each time of its mode, so many,
# and one more; no fewer than for the first of these times, and no more than for the last.
SAMPLES, SHORTEST, LONGEST = 16, 1.0, 16.0
# With so many edges a program begins.
FIRST_EDGES, FEW_EACH = 8, 2
# An edge outside the program keeps at least this share of the margin of those in it.
NEARLY_ALL = 0.8
# Work for the first edges from which on a general solver is not asked. Our own method takes more of
# them at once, and is content with less of those outside.
DEAR, FIRST_OF_DEAR, BARELY = 0.05, 64, 0.1
# Forms reach up to the identity where there are any; all of them below this are zero.
NOTHING = 1e-4
# What floating point hides where a form need not decrease, relative to its size.
SLACK = 1e-9


@dataclass(frozen=True)
class FormCoordinates:
    """Of a form: ``x = 2^d T z``."""

    exponents: Indices  # The d
    T: Array  # It keeps apart the states that are zero at some place of the form

    @property
    def whole(self) -> Array:
        """Return ``2^d T``."""
        return np.asarray(np.ldexp(self.T, self.exponents[:, None]))


@dataclass(frozen=True)
class Drawing:
    """A graph of which the forms are to be found."""

    system: SwitchedSystem
    graph: FormsOnGraph  # Of its forms only the places count, of its multipliers only the facts
    forms: tuple[int, ...]  # For each node, which form it has: whole, or without the deflection
    coordinates: tuple[FormCoordinates, ...]  # Of each form

    def like(self, node: int) -> list[int]:
        """Return the nodes with the form of one at its place."""
        nodes = zip(self.forms, (node.place for node in self.graph.nodes), strict=True)
        same = self.forms[node], self.graph.nodes[node].place
        return [k for k, other in enumerate(nodes) if other == same]

    @property
    def is_finite(self) -> bool:
        """Whether floating point holds coordinates and modes."""
        return all(np.isfinite(one.whole).all() for one in self.coordinates) and all(
            np.isfinite(mode.A.floats()).all() for mode in self.system.modes
        )


@dataclass(frozen=True)
class Error:
    """What a step adds to the state, ``|e| <= |q z|``; both in the coordinates of the forms."""

    fact: Fact
    column: Array
    q: Array


@dataclass(frozen=True)
class Inequality:
    """The inequality of an edge, in the coordinates of its forms."""

    before: int  # Which form, and which of its entries, that of the state before it is
    kept: Indices
    after: int
    left: Indices
    M: Array  # From the state before it
    # Facts with the forms that their multipliers have.
    facts: tuple[tuple[Fact, Array], ...]
    errors: tuple[Error, ...]  # Their multipliers are not solved for
    is_flow: bool
    lasts: float  # Steps, or time in s of an enclosed stay
    is_strict: bool
    share: float = 1.0  # What the form after a map counts besides

    def weight(self, rate: float, degree: int, time: Time) -> float:
        """Return what the form after a map counts, if that before it counts one.

        The rate is alpha in 1/s, or rho per step; the degree is that of the monomials.
        """
        if time is Time.CONTINUOUS:
            return exp(2 * rate * self.lasts)
        return self.share * float(rate ** (-2 * degree * self.lasts))

    @property
    def size(self) -> int:
        """Number of entries of z."""
        return int(self.M.shape[1])

    def changed(self, Q: Array) -> Array:
        """Return ``M' Q M`` of a map, ``Q M + M' Q`` of a flow, for one form or several."""
        if not self.is_flow:
            return np.asarray(self.M.T @ Q @ self.M)
        half = Q @ self.M
        return np.asarray(half + np.swapaxes(half, -1, -2))


@dataclass(frozen=True)
class Solution:
    """Forms, multipliers and forms that vanish for each edge, in floating point."""

    forms: list[Array]
    multipliers: Array
    vanishing: list[Array]
    margin: float  # That they were solved for, of the edges that counted


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
        drawn, self.scales = _edges(drawing)
        self.every = [timed(edge) for edge in drawn]
        self.edges, self.stands_for = _distinct(self.every)
        count = len(self.edges)
        # Where forms have few edges each, nearly all of these are needed.
        whole = self.degree > 1 or count <= FEW_EACH * len(self.sizes)
        few = count if whole else min(count, FIRST_EDGES)
        # The edges that solutions are sought for; what one violates is added, and stays.
        self.active = _spaced(count, few)
        flows = [np.abs(edge.M).max() for edge in self.edges if edge.is_flow]
        if flows and self.degree > 1:
            # The unit of the modes themselves: lifted entries, and margins with them, grow with
            # the degree.
            given = np.array([mode.A.floats() for mode in drawing.system.modes])
            flows = [float(np.abs(scale_states(given, balance(given))).max())]
        self.unit = time_unit(np.array(max(flows))[None], self.time) if flows else 0
        self._last: FormsPoint | None = None  # What our own method found last
        self.is_dear = self._is_dear()
        if self.is_dear:
            self.active = _spaced(count, max(few, min(count, FIRST_OF_DEAR)))

    def _is_dear(self) -> bool:
        """Tell whether a general solver takes long, even for few edges, and our own method less.

        Ours begins where every inequality has room, and knows quadratic forms only.
        """
        if self.degree > 1 or not all(edge.is_strict for edge in self.edges):
            return False
        cones = self.cones(self.active, 1.0)
        work = cones.cost_of_solver()[0].work
        return work > DEAR and STEPS * cones.cost().work < work

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
                variables = self._variables(edge.size)
                found[key] = vanishing_basis(variables, self.degree, -exponents)
        return [found[edge.before, edge.size] for edge in self.edges]

    def _variables(self, size: int) -> int:
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
        while True:
            solution = self._solve_for(self.active, rate, allowance)
            if solution is None or len(self.active) == len(self.edges):
                return solution
            margins, known = self._margins(solution, rate), set(self.active)
            strict = np.array([edge.is_strict for edge in self.edges])
            share = BARELY if self.is_dear else NEARLY_ALL
            enough = share * min((margins[k] for k in known if strict[k]), default=0.0)
            tight = ~(margins > np.where(strict, max(enough, 0.0), 0.0))
            added = [k for k in np.argsort(margins) if tight[k] and k not in known]
            if not added:
                return solution
            self.active = sorted([*known, *added[: len(known)]])

    def _solve_for(
        self, active: Sequence[int], rate: float, allowance: Allowance
    ) -> Solution | None:
        """Solve for some of the edges, with the method of our own from where the last one ended."""
        if not self.is_dear:
            found = self._maximum(active, rate, allowance)
            return None if found is None else self._read(found.x, rate)
        cones = self.cones(active, rate)
        step = cones.cost()
        allowance.require(
            Cost(FEWEST_STEPS * step.work, step.memory), f"{len(active)} inequalities"
        )
        point = maximize(cones, self._last, lambda: allowance.goes_on(step.work))
        if point.margin <= 0:
            return None
        self._last = point
        return self._solution(point, rate)

    def _maximum(self, active: Sequence[int], rate: float, allowance: Allowance) -> Maximum | None:
        cones = self.cones(active, rate)
        begun = begin(allowance, *cones.cost_of_solver())
        return maximize_margin(*cones.for_solver(), begun)

    def solve_dual(self, rate: float, allowance: Allowance) -> DualSolution | None:
        """Solve at a rate, for the dual variables as well; None without a margin."""
        if self.solve(rate, allowance) is None:
            return None
        # Enough of the edges, as the solution has found, in the order of their rows.
        active = [k for members in self._kinds(self.active) for k in members]
        found = self._maximum(active, rate, allowance)
        solution = None if found is None else self._read(found.x, rate)
        if found is None or solution is None:
            return None
        sizes = [self.edges[k].size for k in active]
        lengths = [n * (n + 1) // 2 for n in sizes]
        # The rows of the edges are the last ones.
        parts = np.split(found.z[len(found.z) - sum(lengths) :], np.cumsum(lengths)[:-1])
        duals = {k: unpack(part, n) for k, part, n in zip(active, parts, sizes, strict=True)}
        return DualSolution(solution, duals)

    def _kinds(self, active: Sequence[int]) -> list[list[int]]:
        """Group edges in which the same forms, multipliers and forms that vanish enter."""
        groups: dict[object, list[int]] = {}
        for k in active:
            edge = self.edges[k]
            entries = tuple(edge.kept), tuple(edge.left), tuple(fact for fact, _ in edge.facts)
            own = k if len(self._vanishing[k]) else None
            key = edge.before, edge.after, edge.size, edge.is_flow, edge.is_strict, entries, own
            groups.setdefault(key, []).append(k)
        return list(groups.values())

    def cones(self, active: Sequence[int], rate: float) -> FormsCones:
        """Return the inequalities of some edges at a rate; those of a kind come together."""
        factors, place = self.factors(rate), {fact: k for k, fact in enumerate(self.scales)}
        kinds, free = list[ConeKind](), 0
        for members in self._kinds(active):
            first, edges = self.edges[members[0]], [self.edges[k] for k in members]
            weights = np.array([factors[k] for k in members])[:, None, None]
            E = np.zeros((1, first.size, self.sizes[first.before]))
            E[0, np.arange(len(first.kept)), first.kept] = 1.0
            M = np.zeros((len(edges), first.size, self.sizes[first.after]))
            M[:, :, first.left] = np.array([edge.M.T for edge in edges])
            if first.is_flow:
                N = -np.ldexp(M, self.unit) - weights / 2 * E
                terms = FormTerm(first.before, E, N), FormTerm(first.before, N, E)
            else:
                terms = FormTerm(first.before, E, E), FormTerm(first.after, -weights * M, M)
            facts = [
                (place[fact], np.array([edge.facts[i][1] for edge in edges]))
                for i, (fact, _) in enumerate(first.facts)
            ]
            vanishing = self._vanishing[members[0]]
            facts += [(len(place) + free + k, N[None]) for k, N in enumerate(vanishing)]
            free += len(vanishing)
            kinds.append(ConeKind(terms, tuple(facts), first.is_strict, len(edges), first.size))
        return FormsCones(self.sizes, len(place), kinds, free)

    def factors(self, rate: float) -> list[float]:
        """Return what the rate makes of the inequality of each edge: twice that of a flow.

        Of a map it is what the form after it counts.
        """
        return [
            2 * self.degree * float(np.ldexp(rate, self.unit))
            if edge.is_flow
            else edge.weight(rate, self.degree, self.time)
            for edge in self.edges
        ]

    def _read(self, x: Array, rate: float) -> Solution | None:
        """Take apart what the solver returned; None if there is no margin."""
        parts = np.split(x[:-1], np.cumsum([n * (n + 1) // 2 for n in self.sizes]))
        forms = [unpack(part, n) for part, n in zip(parts, self.sizes, strict=False)]
        if x[-1] <= 0 or max(np.abs(Q).max() for Q in forms) < NOTHING:
            return None
        return self._solution(FormsPoint(forms, parts[-1], float(x[-1])), rate)

    def _solution(self, point: FormsPoint, rate: float) -> Solution:
        """Return what was found in the units of the edges."""
        # Inequalities of maps have been divided by what is left of the form after a step.
        keeps = [
            1.0 if edge.is_flow else 1 / f
            for edge, f in zip(self.edges, self.factors(rate), strict=True)
        ]
        multipliers, free = np.split(point.multipliers, [len(self.scales)])
        # Where forms vanish, all edges are active, each of a kind of its own.
        counts = np.cumsum([len(basis) for basis in self._vanishing])[:-1]
        vanishing = [
            keep * np.tensordot(part, basis, axes=1)
            for keep, part, basis in zip(
                keeps, np.split(free, counts), self._vanishing, strict=True
            )
        ]
        share = 1.0 if self.time is Time.CONTINUOUS else float(rate ** (2 * self.degree))
        return Solution(point.forms, share * multipliers, vanishing, point.margin)

    def _form(self, edge: Inequality, solution: Solution, N: Array) -> Array:
        """Return the inequality of an edge without what counts for the rate."""
        Q = solution.forms[edge.after][np.ix_(edge.left, edge.left)]
        form = -np.ldexp(edge.changed(Q), self.unit if edge.is_flow else 0) + N
        place = {fact: k for k, fact in enumerate(self.scales)}
        for fact, own in edge.facts:
            form = form + solution.multipliers[place[fact]] * own
        return np.asarray(form)

    def decrease(self, edge: Inequality, solution: Solution, N: Array, rate: float) -> Array:
        """Return what must be positive of an edge, its own or that of a like drawing.

        N is the form that vanishes; the rate is in 1/s, or per step.
        """
        Q = solution.forms[edge.before][np.ix_(edge.kept, edge.kept)]
        if edge.is_flow:
            keeps = -2 * self.degree * float(np.ldexp(rate, self.unit))
        else:
            keeps = 1 / edge.weight(rate, self.degree, self.time)
        return np.asarray(self._form(edge, solution, N) + keeps * Q)

    def edges_at(self, system: SwitchedSystem) -> list[Inequality]:
        """Return the edges for another system of the same shape, in the same units."""
        every, _ = _edges(replace(self.drawing, system=system), self.scales)
        first = [self.stands_for.index(k) for k in range(len(self.edges))]
        return [every[k] for k in first]

    def _margins(self, solution: Solution, rate: float) -> Array:
        """Return the smallest eigenvalue of every inequality; it may be a little below zero.

        That is where a form need not decrease.
        """
        margins = []
        for edge, N in zip(self.edges, solution.vanishing, strict=True):
            slack = 0.0
            if not edge.is_strict:
                Q = solution.forms[edge.before][np.ix_(edge.kept, edge.kept)]
                slack = SLACK * np.abs(Q).max()
            form = self.decrease(edge, solution, N, rate)
            margins.append(float(np.linalg.eigvalsh(form)[0]) + slack)
        return np.array(margins)

    def own_rate(self, solution: Solution) -> float:
        """Return the rate that a solution shows where every edge is a flow or some steps."""
        rates = []
        for edge, N in zip(self.edges, solution.vanishing, strict=True):
            Q = solution.forms[edge.before][np.ix_(edge.kept, edge.kept)]
            inverse = np.linalg.inv(np.linalg.cholesky(Q))
            form = inverse @ self._form(edge, solution, N) @ inverse.T
            least = float(np.linalg.eigvalsh(form)[0])
            if edge.is_flow:
                rates.append(float(np.ldexp(least / (2 * self.degree), -self.unit)))
            elif edge.lasts:
                kept = max(-least, 0.0) * edge.share
                rates.append(kept ** (0.5 / (self.degree * edge.lasts)))
        return min(rates) if self.time is Time.CONTINUOUS else max(rates)

    def roundings(
        self,
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
        drawing, coordinates = self.drawing, self.drawing.coordinates
        inverses = [np.linalg.inv(one.T) for one in coordinates]
        balanced = [V.T @ Q @ V for V, Q in zip(inverses, solution.forms, strict=True)]
        exponent = int(np.frexp(max(np.abs(Q).max() for Q in balanced))[1])
        top = max(int(one.exponents.max()) for one in coordinates)
        scales = np.array([*self.scales.values()])
        multipliers = np.ldexp(solution.multipliers * scales, -self.unit)
        found = dict(zip(self.scales, multipliers, strict=True))
        if errors:
            taus, claim = self._allow_for(solution, claim)
            if claim >= 1:
                return
            found |= taus
        for bits in digits:
            if bits != digits[-1] and not errors:
                coarse = [_rounded(Q, bits - exponent) for Q in balanced]
                own = [one.T.T @ Q @ one.T for one, Q in zip(coordinates, coarse, strict=True)]
                if not self._margins(replace(solution, forms=own), float(claim)).min() > 0:
                    continue
            log2 = bits + 2 * top
            whole = [
                round_form(Q, top - one.exponents, bits - exponent)
                for one, Q in zip(coordinates, balanced, strict=True)
            ]
            nodes = []
            for node, k in zip(drawing.graph.nodes, drawing.forms, strict=True):
                kept = _entries(drawing, k, _states(drawing, node))
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
                rate=claim,
                multipliers=facts,
            )
            if graph.stays and graph.stays.leaving and self.time is Time.CONTINUOUS:
                # How finely stays of any length are enclosed.
                if (pieces := enough_pieces(drawing.system, graph)) is None:
                    continue
                graph = replace(graph, stays=replace(graph.stays, pieces=pieces))
            if self.degree > 1:
                forms = self._round_vanishing(graph, solution, bits - exponent, top)
                graph = replace(graph, vanishing=forms)
            yield graph

    def _round_vanishing(
        self, graph: FormsOnGraph, solution: Solution, bits: int, top: int
    ) -> tuple[tuple[tuple[int, ...], ...], ...]:
        """Round forms so that they vanish exactly, in the units of the exact inequalities."""
        found, timed = [], [k for k, edge in enumerate(self.every) if edge.is_strict]
        for k, (_, step, _) in zip(timed, graph.edges_in_time(self.drawing.system), strict=True):
            edge = self.every[k]
            assert isinstance(step, Step)  # polynomials are enclosed by nobody
            exponents = self.drawing.coordinates[edge.before].exponents[edge.kept]
            N = round_form(solution.vanishing[self.stands_for[k]], top - exponents, bits)
            factor, unit = _factor(step, self.degree, graph.rate), self.unit * edge.is_flow
            scaled = [[_shift(factor * entry, -unit) for entry in row] for row in N]
            groups = products(self._variables(edge.size), self.degree)
            found.append(tuple(map(tuple, make_vanish(scaled, groups))))
        return tuple(found)

    def _allow_for(self, solution: Solution, claim: Fraction) -> tuple[dict[Fact, float], Fraction]:
        """Return multipliers of errors, and what is left of a rate if a form loses what they take.

        In the norm of the forms, an error of size ``s`` times that of the state takes ``2 s`` of
        V; with the multiplier ``|C| / |q|`` half of it is taken by either term.
        """
        pushed, sizes = dict[Fact, float](), dict[Fact, float]()
        loss: dict[int, set[Fact]] = {}
        for edge in self.every:
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


def _spaced(count: int, few: int) -> list[int]:
    """Return so many of the first numbers, at about equal distances."""
    return sorted({k * (count - 1) // max(few - 1, 1) for k in range(few)})


def _states(drawing: Drawing, node: Node) -> int:
    """Return how many states there are at the place of a node."""
    if drawing.graph.stays is not None:
        return next(m.A.shape[0] for m in drawing.system.modes if m.name == node.place)
    return drawing.system.order - node.place.startswith("free")


def _entries(drawing: Drawing, form: int, states: int) -> list[int]:
    """Return the entries of a form that are left where all but the first states are zero."""
    if drawing.graph.degree == 1:
        return list(range(states))
    n = drawing.system.order
    if len(drawing.coordinates[form].T) == len(monomials(states, drawing.graph.degree)):
        return list(range(len(drawing.coordinates[form].T)))
    terms = enumerate(monomials(n, drawing.graph.degree))
    return [k for k, term in terms if not any(term[states:])]


def _edges(
    drawing: Drawing, scales: Mapping[Fact, float] | None = None
) -> tuple[list[Inequality], dict[Fact, float]]:
    """Return all edges, and of what size the multipliers of the facts are that are solved for.

    Sizes that are given are kept.
    """
    system, graph = drawing.system, drawing.graph
    wholes = [one.whole for one in drawing.coordinates]
    inverses = [np.linalg.inv(whole) for whole in wholes]
    listed = [*graph.edges_in_time(system), *_at_once(drawing)]
    names, edges = _named(drawing, listed), list[Inequality]()
    moves, known = list[tuple[int, Step, int]](), dict[int, FloatStep]()
    for a, step, b in listed:
        if isinstance(step, EnclosedStep):
            before, after = drawing.forms[a], drawing.forms[b]
            kept, left = (np.arange(len(wholes[k])) for k in (before, after))
            for lasts, flow in _stays(step):
                M = inverses[after] @ flow @ wholes[before]
                edges.append(Inequality(before, kept, after, left, M, (), (), False, lasts, True))
            continue
        moves.append((a, step, b))
        if id(step) not in known:
            known[id(step)] = FloatStep.of(
                step if graph.degree == 1 else lifted(step, graph.degree, Fraction(1))
            )
    sizes: dict[Fact, float] = {}
    for a, step, b in moves:
        last = _entries(drawing, drawing.forms[a], step.states)[-1]
        size = float(wholes[drawing.forms[a]][last, last] ** 2)
        for name, _ in known[id(step)].crossings:
            sizes[names[b][name]] = max(size, sizes.get(names[b][name], 0.0))
    scales = scales or {
        fact: 1 / size if size > 0 and isfinite(1 / size) else 1.0 for fact, size in sizes.items()
    }
    for a, step, b in moves:
        before, after, floats = drawing.forms[a], drawing.forms[b], known[id(step)]
        kept = np.array(_entries(drawing, before, step.states), dtype=np.int64)
        left = np.array(_entries(drawing, after, len(step.rows)), dtype=np.int64)
        S, n = wholes[before][np.ix_(kept, kept)], len(kept)
        own = inverses[after][np.ix_(left, left)]
        M = np.asarray(own @ np.hstack([floats.M[:, :n] @ S, floats.M[:, n:]]), dtype=float)
        facts = list[tuple[Fact, Array]]()
        for name, c in floats.crossings:
            fact, form = names[b][name], np.zeros((n, n))
            form[n - 1] = scales[fact] * S[-1, -1] * (c[:n] @ S)
            facts.append((fact, form + form.T))
        errors = tuple(Error(names[b][name], M[:, i], q[:n] @ S) for name, i, q in floats.errors)
        lasts = step.time if system.time is Time.DISCRETE else 0.0
        edges.append(
            Inequality(
                before,
                kept,
                after,
                left,
                M[:, :n],
                tuple(facts),
                errors,
                step.is_flow,
                lasts,
                step.time > 0,
            )
        )
    return edges, dict(scales)


def _named(drawing: Drawing, listed: Sequence[tuple[int, AnyStep, int]]) -> list[dict[str, Fact]]:
    """Return for each node what the facts of steps to it are called."""
    first = [drawing.like(k)[0] for k in range(len(drawing.graph.nodes))]
    targets: dict[str, set[int]] = {}
    for _, step, b in listed:
        for name in step.facts:
            targets.setdefault(name, set()).add(first[b])
    return [
        {name: (name, None if len(known) == 1 else b) for name, known in targets.items()}
        for b in first
    ]


def _at_once(drawing: Drawing) -> Iterator[tuple[int, Step, int]]:
    """Yield the switches that take no time, which are not among the edges in time."""
    graph, system = drawing.graph, drawing.system
    if graph.stays is None:
        return  # At the surface a form agrees with itself without the deflection.
    from nrs_design.proof.stays import steps_of_stays

    number = {node.place: k for k, node in enumerate(graph.nodes)}
    for step in steps_of_stays(system, graph.stays, lambda _: 1):
        if isinstance(step, Step) and not step.time:
            yield number[step.source], step, number[step.target]


def _stays(step: EnclosedStep) -> Iterator[tuple[float, Array]]:
    """Yield what a stay makes of the state, for some of its lengths."""
    from scipy.linalg import expm

    A = np.array(step.edge.source.A.floats())
    G = np.eye(len(A)) if step.edge.map is None else np.array(step.edge.map.floats())
    first, last = float(step.begin), float(step.end)
    times = min(max(float(np.linalg.norm(A)) * (last - first), SHORTEST), LONGEST)
    for lasts in np.linspace(first, last, round(SAMPLES * times) + 1 if last > first else 1):
        yield float(lasts), G @ np.asarray(expm(A * lasts))


def _distinct(edges: list[Inequality]) -> tuple[list[Inequality], list[int]]:
    """Leave out edges that differ by the last digits of a number; say which stand for them."""
    kept: list[Inequality] = []
    groups: dict[object, list[tuple[int, Array]]] = {}
    found = []
    for edge in edges:
        facts = tuple(fact for fact, _ in edge.facts)
        sizes = len(edge.kept), len(edge.left)
        key = edge.before, edge.after, sizes, facts, edge.is_flow, edge.lasts, edge.is_strict
        numbers = np.concatenate([edge.M.ravel(), *(form.ravel() for _, form in edge.facts)])
        near = NEARLY * np.abs(numbers).max(initial=0.0)
        # Edges that are near have nearly the same sum, so they are looked for in three places only.
        width = np.ldexp(1.0, int(np.frexp(near)[1])) * max(len(numbers), 1)
        share = float(numbers @ np.cos(np.arange(len(numbers))) / width)
        place = int(share // 1) if isfinite(share) else 0
        beside = (groups.get((key, width, place + i), ()) for i in (-1, 0, 1))
        others = chain.from_iterable(beside)
        same = (k for k, other in others if np.abs(other - numbers).max() <= near)
        k = min(same, default=len(kept))
        if k == len(kept):
            kept.append(edge)
            groups.setdefault((key, width, place), []).append((k, numbers))
        found.append(k)
    return kept, found


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
