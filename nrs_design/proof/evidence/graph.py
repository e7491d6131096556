"""Forms on a graph: every step of the system leads from a form to one that is smaller.

What the pages claim of graphs is shown here.

*Along a path.* The facts of a step make each added term at most zero, so a map gives ``F_b(x+) <=
rho^2d F_a(x)`` and a flow ``F_a' <= -2 d alpha F_a`` (S-procedure). For any sequence of steps there
is a path through the graph (subset construction; Ahmadi, Jungers, Parrilo, Roozbehani 2014;
Philippe, Essick, Dullerud, Jungers 2016), so ``F(x(t)) <= rho^(2dt) F(x(0))`` with F of its first
and last node. All forms are positive definite: ``|x(t)| <= c rho^t |x(0)|``, one c for all
sequences.

*No factor in front.* Where every edge leads to every node of its target place, let V be the largest
of the forms at a place. A step from x has an edge from some node a to every node b, so ``V(x+) =
max F_b(x+) <= rho^2d F_a(x) <= rho^2d V(x)``. Other graphs, and places that are modes, have the
factor c: in a mode that must be left a value may grow meanwhile by no more than a factor, as the
stay is not longer than declared.

*Strict and not strict.* A step that takes time is strict, so that the rate itself holds. One that
takes none (a switch without dwell time, the surface between contact and free motion) may happen as
often as one likes in no time, so its form need only not rise. In continuous time there is one node
at each place: with two, a run that slides along a switch would need a path of infinitely many
edges.

*Averages.* Let ``M = sum p_i M_i`` with weights ``p_i >= 0`` of sum one. A flow is affine in M, so
one form falls for all of them. For a map with d = 1 let a_i be a node that takes the step of mode
i; F_b is convex, so ``F_b(M z) <= sum p_i F_b(M_i z) <= sum p_i (rho^2 F_(a_i)(x) + facts of
M_i)``. A multiplier belongs to (target, fact), and to no mode, so the crossings add up to ``2 m
delta (sum p_i c_i z)``, which is a fact of M; errors to ``m (sum p_i (q_i z)^2 - e^2)``, which is
at least ``m ((sum p_i q_i z)^2 - e^2)``. So ``F_b(M z) <= rho^2 V(x)`` for every b. With a
multiplier for each mode this would be false. Only the force of a flow that would pull has one for
each free mode: there the fact is the same for all.

*Contact and free motion.* Let delta be the last state, y the others, ``w = (y, max(delta, 0))``. In
continuous time a mode rules while ``delta > 0``, else a free mode, of y alone; both forms agree
where delta is zero, so V of w is continuous, and where delta stays at zero its derivative is zero
and both flows agree. An environment that would pull lags: a free mode rules the whole state, and as
the force is an average of those at the corners, ``delta (q x) <= 0`` at one corner q: a fact, and a
step for every corner. In discrete time, with N the rows of y of a map and c that of delta, a step
in contact leads to contact by (N, c), or to free motion by N with the fact ``delta (c x) <= 0``. A
step of a free mode stays free by N, or lands between 0 and ``c y``; F_b is convex there, so both
ends suffice. For d > 1 it need not be convex.

*Turns.* A step of a round leads from ``modes k`` to ``modes k+1``, and from the last to the first.
A mode need not be stable by itself.

*Cases.* In each of them all this holds with the places of its own: no step leads to another.

*Stays.* A mode is followed by its own steps until its shortest stay T is left; those T and the
switch are one step, ``G exp(A T)`` or ``G A^T`` (Geromel and Colaneri 2006; resets: thesis 5.13). A
mode of ``leaving`` is not followed by itself, may be unstable, and every length of its stay is a
step; in continuous time they are enclosed (`nrs_design.proof.stays`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from math import comb, lcm
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Self, TypeAlias

from nrs_design.proof.evidence.abstract import AbstractFunction, find_odd_form, is_square
from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.evidence.sentence import free_sentence, ruled_sentence
from nrs_design.proof.exact import (
    MAX_WORK,
    IntegerMatrix,
    Product,
    add,
    bit_length,
    is_positive_semidefinite,
    is_symmetric,
    is_too_large,
    multiply,
)
from nrs_design.proof.matrix import leading
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import (
    CONTACT,
    FREE,
    KEPT,
    ROUNDING,
    Acting,
    Stays,
    Step,
    grain_of,
    steps_of,
)
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem

if TYPE_CHECKING:
    from nrs_design.proof.stays import EnclosedStep

MAX_DEGREE = 64
MAX_MONOMIALS = 120
MAX_SETS = 1024
MAX_STEPS = 2**21
# What an edge takes at least, beside products of matrices, in the units of `MAX_WORK`.
LEAST_WORK = 64

# The place of a node where the modes are in force, in contact if that may be lost.
MODES = "modes"

Forms = Iterator[tuple[str, IntegerMatrix]]
AnyStep: TypeAlias = "Step | EnclosedStep"


class Node(NamedTuple):
    """A form on the state, or on its monomials, at a place."""

    place: str
    form: Matrix  # Integer numerators


class Arc(NamedTuple):
    """Steps from node to node, by their numbers; None stands for every node, or every mode."""

    source: int | None = None
    mode: str | None = None
    target: int | None = None


class Multiplier(NamedTuple):
    """The multiplier of a fact, for steps to one node, or to every node."""

    fact: str
    value: int
    target: int | None = None


# From every node to every node that a step may lead to.
ALL = (Arc(),)


@dataclass(frozen=True, slots=True)
class FormsOnGraph(AbstractFunction):
    """Every step of the system has an edge from each set of nodes that a run may be at.

    With F_a the form of node a on the monomials z of degree d, an edge from a to b is the
    inequality of `nrs_design.proof.steps` for the step, at the claimed rate to the power 2d.
    """

    kind: ClassVar[str] = "graph"

    nodes: tuple[Node, ...]
    denominator_log2: int  # All forms and multipliers are over two to this power
    rate: Fraction  # alpha in 1/s, or rho per step
    degree: int = 1  # The d: functions have degree 2d
    multipliers: tuple[Multiplier, ...] = ()
    # For every edge in order: integers N with z' N z = 0 for all x, added to its form; d > 1 only.
    vanishing: tuple[Matrix, ...] = ()
    edges: tuple[Arc, ...] = ALL
    # Places are modes, and this says how stays are followed; None: places are contact and free
    # motion, at each step of a round where modes take turns.
    stays: Stays | None = None

    @property
    def covers_rounding(self) -> bool:
        """Whether it has multipliers for it."""
        return any(item.fact.startswith(ROUNDING) for item in self.multipliers)

    @property
    def covers_lost_contact(self) -> bool:
        """Whether it has forms in free motion."""
        return self.stays is None and any(node.place.startswith(FREE) for node in self.nodes)

    @property
    def quadratic(self) -> tuple[IntegerMatrix, int] | None:
        """The form in contact, if it is the only one there and quadratic."""
        forms = [node.form for node in self.nodes if not node.place.startswith(FREE)]
        single = len(forms) == 1 and self.degree == 1 and self.stays is None
        return ([list(row) for row in forms[0]], self.denominator_log2) if single else None

    @property
    def covers_clock(self) -> bool:
        """Whether its places know of turns."""
        return self.stays is None

    @property
    def allows_unequal_modes(self) -> bool:
        """Whether each mode is a place of its own."""
        return self.stays is not None

    @property
    def bounds_at_once(self) -> bool:
        """Whether the largest of all forms at a place decreases in every step."""
        return self.stays is None and all(edge.target is None for edge in self.edges)

    @property
    def covers_mixtures(self) -> bool:
        """Whether convex combinations of modes decrease it, too: where it bounds at once."""
        return self.bounds_at_once

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """Whether it is convex, or has a constant factor anyway."""
        return self.degree == 1 or self.stays is not None

    @property
    def is_common_quadratic(self) -> bool:
        """Whether in contact it is one for all modes."""
        places = [node.place for node in self.nodes]
        return self.degree == 1 and self.stays is None and places in ([MODES], [MODES, FREE])

    def fits(self, switching: Switching) -> bool:
        """Tell whether the steps of these signals are those of its places.

        A constant parameter is anywhere between its ends, where places that are modes, or edges to
        some nodes only, say nothing.
        """
        if self.stays is not None:
            return not switching.fixed_ends
        return not (switching.resets or (switching.fixed_ends and not self.covers_mixtures))

    def find_unsayable(self, system: SwitchedSystem) -> str | None:
        """Say that nothing follows from no form."""
        return None if self.nodes else "it has no form"

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check places, sizes, rate and multipliers, and that no run is left without an edge."""
        return (
            self.find_rate_misfit(system.time)
            or self._find_odd_places(system)
            or self._find_odd_size(system)
            or self._find_odd_stays(system)
            or self._find_odd_shape(system)
            or self._find_too_many(system)
            or self._find_odd_multiplier(system)
            or self._find_gap(system)
            or self._find_odd_vanishing(system)
            or self._find_rise(system)
        )

    def _find_odd_stays(self, system: SwitchedSystem) -> str | None:
        if self.stays is None:
            return None
        from nrs_design.proof.stays import find_odd_stays

        bits = (self.rate**self.degree).denominator.bit_length()
        return find_odd_stays(system, self.stays, bits, self.degree)

    def _places(self, system: SwitchedSystem) -> dict[str, int]:
        """Return every place with the number of its states."""
        if self.stays is not None:
            return {mode.name: mode.A.shape[0] for mode in system.modes}
        sizes = {MODES: system.order}
        if self.covers_lost_contact:
            sizes[FREE] = system.order - 1
        if (clock := system.clock) is not None:
            turns = range(clock.length)
            sizes = {at_place(place, k): n for k in turns for place, n in sizes.items()}
        return sizes

    def _find_odd_places(self, system: SwitchedSystem) -> str | None:
        if self.covers_lost_contact and system.contact is None:
            return "the system does not say how contact is lost"
        if {node.place for node in self.nodes} != self._places(system).keys():
            return "there is not a form at every place of the system"
        return None

    def _find_odd_size(self, system: SwitchedSystem) -> str | None:
        d = self.degree
        if not 1 <= d <= MAX_DEGREE // 2:
            return f"degree {2 * d} is not between 2 and {MAX_DEGREE}"
        places = self._places(system)
        sizes = {place: comb(n + d - 1, d) for place, n in places.items()}
        if d > 1 and max(sizes.values()) > MAX_MONOMIALS:
            return f"there are more than {MAX_MONOMIALS} monomials of degree {d}"
        for place, form in self.nodes:
            if (odd := find_odd_form(form, self.denominator_log2, sizes[place])) is not None:
                return f"a form at {place}: {odd}"
        if d > 1:
            maps = [mode.A for mode in system.modes]
            maps += [reset.map for reset in system.switching.resets]
            matrices = [A.numerators for A in maps] + [((A.denominator,),) for A in maps]
            factors = 1 if system.time is Time.CONTINUOUS else 2 * d
            bits = max(bit_length(node.form) for node in self.nodes)
            bits += factors * max(map(bit_length, matrices))
            if max(sizes.values()) ** 3 * bits > MAX_WORK:
                return "its numbers are too large to check"
        return None

    def _find_odd_shape(self, system: SwitchedSystem) -> str | None:
        """Refuse shapes of which no argument is known."""
        flows, alone = system.time is Time.CONTINUOUS, len(self.nodes) == len(self._places(system))
        lost = self.covers_lost_contact
        if flows and not alone:
            return "in continuous time there is one form at each place"
        chosen = any(edge.target is not None for edge in self.edges)
        if chosen and not alone and (lost or self.covers_rounding):
            return "edges lead to all nodes of a place where contact is lost or arithmetic rounds"
        if self.stays is not None:
            if self.multipliers:
                return "a form of each mode has no multipliers"
            if flows and self.degree > 1:
                return "polynomials for each mode are for discrete time"
            return None
        if self.degree > 1 and lost and not flows:
            return "a polynomial for contact and free motion is for continuous time"
        pulls = system.contact is not None and system.contact.pulls
        if self.degree > 1 and (self.multipliers or (lost and pulls)):
            return "a polynomial has no multipliers, and covers no environment that could pull"
        return None

    def _find_too_many(self, system: SwitchedSystem) -> str | None:
        """Refuse more edges than can be checked in some seconds, before any is looked at."""
        contact, too_many = system.contact, "there are too many edges to check"
        if self.stays is None:
            free, pulls = (0, 0) if contact is None else (len(contact.free), len(contact.pulls))
            length = 1 if system.clock is None else system.clock.length
            if (2 * len(system.modes) + free * (3 + 2 * pulls)) * length > MAX_STEPS:
                return too_many
        at = Counter(node.place for node in self.nodes)
        size = max(len(node.form) for node in self.nodes)
        whole = LEAST_WORK if len(self.nodes) == len(at) else max(LEAST_WORK, size**3)
        work = 0
        for step in self._steps(system):
            known = len(self.multipliers) // 2 if step.facts else 0
            work += at[step.source] * at[step.target] * (whole + known)
        return too_many if work > MAX_WORK else None

    def _find_odd_multiplier(self, system: SwitchedSystem) -> str | None:
        if any(item.value < 0 for item in self.multipliers):
            return "a multiplier is negative"
        facts = {fact for step in self._steps(system) for fact in step.facts}
        keys = [(item.fact, item.target) for item in self.multipliers]
        nodes = range(len(self.nodes))
        fit = all(fact in facts and (to is None or to in nodes) for fact, to in keys)
        if len(set(keys)) < len(keys) or not fit:
            return "a multiplier belongs to no fact of the system, or a fact has two"
        return None

    def _multipliers_to(self, target: int) -> Mapping[str, int]:
        """Return the multipliers of the facts on steps to a node; the others are zero."""
        found = {item.fact: item.value for item in self.multipliers if item.target is None}
        return found | {item.fact: item.value for item in self.multipliers if item.target == target}

    def _steps(self, system: SwitchedSystem) -> tuple[AnyStep, ...]:
        """Return every step of the system; the certificate has none of its own."""
        if self.stays is not None:
            return steps_by_mode(system, self.stays, self.rate, self.degree)
        acting = Acting(rounding=self.covers_rounding)
        rate = Fraction(1) if self.degree > 1 else self.rate
        return steps_together(system, acting, rate, self.covers_lost_contact)

    def _edges(self, system: SwitchedSystem) -> Iterator[tuple[int, AnyStep, int]]:
        """Yield the edges of the graph: nodes before and after, and the step between them."""
        at, leaving = self._nodes_at(), dict[int | None, list[Arc]]()
        for arc in self.edges:
            leaving.setdefault(arc.source, []).append(arc)
        for step in self._steps(system):
            ends = at[step.target]
            known = frozenset(ends)
            for a in at[step.source]:
                arcs = leaving.get(None, []) + leaving.get(a, [])
                drawn = {arc.target for arc in arcs if arc.mode in {None, step.mode}}
                targets = ends if None in drawn else sorted(known & drawn)
                yield from ((a, step, b) for b in targets if a == b or not step.is_flow)

    def _nodes_at(self) -> dict[str, list[int]]:
        """Return the numbers of the nodes at every place."""
        at: dict[str, list[int]] = {}
        for k, node in enumerate(self.nodes):
            at.setdefault(node.place, []).append(k)
        return at

    def edges_in_time(self, system: SwitchedSystem) -> list[tuple[int, AnyStep, int]]:
        """Return the edges that take some time, in order."""
        return [edge for edge in self._edges(system) if edge[1].time]

    def _find_gap(self, system: SwitchedSystem) -> str | None:
        """Say that a run can reach nodes from which some step has no edge, or None."""
        if self.edges == ALL:
            return None  # From every node to every node: a node at every place is enough.
        after: dict[int, dict[int, list[int]]] = {}
        leaving: dict[str, list[AnyStep]] = {}
        for step in self._steps(system):
            after[id(step)] = {}
            leaving.setdefault(step.source, []).append(step)
        for a, step, b in self._edges(system):
            after[id(step)].setdefault(a, []).append(b)
        every = {frozenset(nodes) for nodes in self._nodes_at().values()}
        todo, work = list(every), 0
        while todo:
            nodes = todo.pop()
            for step in leaving.get(self.nodes[min(nodes)].place, ()):
                ends = [b for a in nodes for b in after[id(step)].get(a, ())]
                if not ends:
                    return f"the graph has no edge {step.where}"
                reached = frozenset(ends)
                if reached not in every:
                    every.add(reached)
                    todo.append(reached)
                work += LEAST_WORK // 8 * (len(nodes) + len(ends))
                if len(every) > MAX_SETS or work > MAX_WORK:
                    return "the graph has too many sets of nodes"
        return None

    def _find_odd_vanishing(self, system: SwitchedSystem) -> str | None:
        if self.degree == 1:
            return "quadratic forms have nothing that vanishes" if self.vanishing else None
        strict = [a for a, _, _ in self.edges_in_time(system)]
        if len(self.vanishing) != len(strict):
            return "there is not one vanishing form for each decrease"
        from nrs_design.proof.lift import vanishes

        places = self._places(system)
        for a, N in zip(strict, self.vanishing, strict=True):
            place, form = self.nodes[a]
            if not is_square(N, len(form)):
                return "a form that must vanish has the wrong size"
            if not vanishes(N, places[place], self.degree):
                return "a form that must vanish does not"
        return None

    def _find_rise(self, system: SwitchedSystem) -> str | None:
        """Check the steps that take no time: exact, equality allowed."""
        for a, step, b in self._edges(system):
            if step.time:
                continue
            form = self.inequality(step, a, b, system)
            if is_too_large(form):
                return f"the numbers {step.where} are too large to check"
            if not is_symmetric(form) or not is_positive_semidefinite(form):
                return f"V rises {step.where}"
        return None

    def forms(self, system: SwitchedSystem, multiply: Product = multiply) -> Forms:
        """Yield the form of every node, and the inequality of every edge over some time."""
        for node in self.nodes:
            yield f"a form at {node.place} is not symmetric and positive definite", node.form
        added = iter(self.vanishing)
        decided = set()
        for a, step, b in self.edges_in_time(system):
            shared = system.clock is not None or not isinstance(step, Step) or not step.facts
            if isinstance(step, Step) and self.degree == 1 and shared:
                # A landing at the surface often is what free motion is, and nodes may share a form.
                key = self._decides(step, a, b, system)
                if key in decided:
                    continue
                decided.add(key)
            form = self.inequality(step, a, b, system, multiply)
            yield (
                f"V does not decrease at the claimed rate {step.where}",
                form if self.degree == 1 else add(form, next(added)),
            )

    def _decides(self, step: Step, a: int, b: int, system: SwitchedSystem) -> Hashable:
        """TRUSTED: return what an inequality follows from, while its step lives."""
        before = self._restricted(a, step.states, system)
        after = self._restricted(b, len(step.rows), system)
        parts = (step.rows, step.units, step.errors, step.crossings, step.weights)
        facts = frozenset(self._multipliers_to(b).items()) if step.facts else None
        numbers = step.states, step.over, step.is_flow, step.time
        return before, after, facts, numbers, tuple(map(id, parts))

    def inequality(
        self, step: AnyStep, a: int, b: int, system: SwitchedSystem, multiply: Product = multiply
    ) -> IntegerMatrix:
        """Return the inequality of a step from node a to node b.

        Only a search has reason to ask for another way to multiply.
        """
        if not isinstance(step, Step):
            return step.form(self.nodes[a].form, self.nodes[b].form, self.rate)
        before = self._restricted(a, step.states, system)
        after = self._restricted(b, len(step.rows), system)
        facts, d = self._multipliers_to(b) if step.facts else {}, self.degree
        keeps = 2 * d * self.rate if step.is_flow else self.rate ** (2 * d * step.time)
        moved = step if d == 1 else lifted(step, d, self.rate)
        return moved.form(before, after, keeps, lambda fact: facts.get(fact, 0), multiply=multiply)

    def _restricted(self, node: int, states: int, system: SwitchedSystem) -> Matrix:
        """Return the form of a node where all but the first states are zero."""
        place, form = self.nodes[node]
        if len(form) == comb(states + self.degree - 1, self.degree):
            return form
        kept = list(range(states))
        if self.degree > 1:
            from nrs_design.proof.lift import monomials

            terms = enumerate(monomials(self._places(system)[place], self.degree))
            kept = [k for k, term in terms if not any(term[states:])]
        return tuple(tuple(form[i][j] for j in kept) for i in kept)

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution, and in which norm."""
        if self.stays is not None:
            return ruled_sentence(system, self.rate)
        each = Counter(node.place for node in self.nodes)
        count, once = max(each.values()), self.bounds_at_once
        lost = self.covers_lost_contact
        return free_sentence(
            system,
            self.rate,
            self.degree,
            count,
            lost=lost,
            once=once,
            # In continuous time, others rise at the surface.
            alike=system.time is Time.CONTINUOUS or count > 1 or self._is_alike(),
        )

    def _is_alike(self) -> bool:
        """Tell whether every quadratic form in free motion is that in contact, undeflected."""
        forms = dict(self.nodes)
        return all(
            list(form) == leading(forms.get(place.replace(FREE, MODES, 1), ()))
            for place, form in self.nodes
            if place.startswith(FREE)
        )

    def spread(self, merged: SwitchedSystem, system: SwitchedSystem) -> Self:
        """Repeat what belongs to a mode for its equals."""
        first = {mode.A: mode.name for mode in merged.modes}
        like = {mode.name: first[mode.A] for mode in system.modes}
        equals: dict[str, list[str]] = {}
        for name, one in like.items():
            equals.setdefault(one, []).append(name)
        nodes = self.nodes
        if self.stays is not None:
            forms = dict(self.nodes)
            nodes = tuple(Node(name, forms[one]) for name, one in like.items())
        edges = tuple(
            edge._replace(mode=name)
            for edge in self.edges
            for name in ([None] if edge.mode is None else equals.get(edge.mode, [edge.mode]))
        )
        carried = replace(self, nodes=nodes, edges=edges, vanishing=())
        if not self.vanishing:
            return carried
        key = {}
        places = [node.place for node in self.nodes]
        for (a, step, b), N in zip(self.edges_in_time(merged), self.vanishing, strict=True):
            ends = (a, b) if self.stays is None else (places[a], places[b])
            key[ends, step.mode, step.time] = N
        found = []
        for a, step, b in carried.edges_in_time(system):
            ends = (a, b) if self.stays is None else (like[nodes[a].place], like[nodes[b].place])
            found.append(key[ends, like.get(step.mode, step.mode), step.time])
        return replace(carried, vanishing=tuple(found))


def at_place(place: str, turn: int) -> str:
    """Return a place at a step of a round."""
    return f"{place} {turn}"


@lru_cache(maxsize=8)
def steps_together(
    system: SwitchedSystem, acting: Acting, rate: Fraction, lost: bool
) -> tuple[Step, ...]:
    """TRUSTED: return the steps of a system with contact and free motion as places.

    The modes are of one size, and may take turns; contact is kept unless it is `lost` and made. The
    rate that maps are to keep decides in which units they are counted.
    """
    grain = grain_of(rate**2)

    def placed(part: SwitchedSystem) -> tuple[Step, ...]:
        at = {KEPT: MODES, CONTACT: MODES, FREE: FREE}
        steps = steps_of(part, acting, grain, lost=lost)
        return tuple(replace(s, source=at[s.source], target=at[s.target]) for s in steps)

    if (clock := system.clock) is None:
        return placed(system)
    from nrs_design.proof.clock import on_turn

    parts = [placed(on_turn(system, clock, kind)) for kind in clock.kinds]
    at = "step" if clock.is_round else "state"
    return tuple(
        replace(
            step,
            where=f"{step.where}, at {at} {k}",
            source=at_place(step.source, k),
            target=at_place(step.target, target),
        )
        for k, kind, target in clock.turns()
        for step in parts[kind]
    )


@lru_cache(maxsize=8)
def steps_by_mode(
    system: SwitchedSystem, stays: Stays, rate: Fraction, degree: int
) -> tuple[AnyStep, ...]:
    """TRUSTED: return the steps of a system with the modes as places.

    The rate that maps are to keep decides in which units they are counted; the degree is that of
    the monomials.
    """
    from nrs_design.proof.stays import steps_of_stays

    def grain(steps: int) -> int:
        return grain_of(rate ** (2 * steps)) if degree == 1 else 1

    return tuple(steps_of_stays(system, stays, grain))


def lifted(step: Step, degree: int, rate: Fraction) -> Step:
    """TRUSTED: return a step without facts as one of the monomials of a degree.

    The rate that maps are to keep decides in which units they are counted.
    """
    from nrs_design.proof.lift import derivative_lift, power_lift

    if step.is_flow:
        rows, unit, over = derivative_lift(step.rows, degree), 1, step.over
    else:
        even, over = lcm(*step.units), 1
        whole = [
            [e * (even // u) for e, u in zip(row, step.units, strict=True)] for row in step.rows
        ]
        grain = grain_of(rate ** (2 * degree * step.time))
        rows = [[grain * entry for entry in row] for row in power_lift(whole, degree)]
        unit = grain * even**degree
    size = len(rows[0])
    return replace(step, states=size, units=(unit,) * size, rows=rows, over=over)
