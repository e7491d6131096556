"""A graph of which forms are to be found, and the inequalities of its edges (untrusted).

They are those of the evidence, in floating point.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import chain
from math import exp, inf, isfinite

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import AnyStep, Node, lifted
from nrs_design.proof.lift import monomials
from nrs_design.proof.mode import Time
from nrs_design.proof.stays import EnclosedStep
from nrs_design.proof.steps import Step
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.family import NEARLY, to_floats
from nrs_design.search.sdp import packed_congruence

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
# The name of a fact, and the node after the step if there are several that it is known of.
Fact = tuple[str, int | None]

# Sampled lengths of a stay for each time constant of the mode. The number of time constants is
# limited to the range from SHORTEST to LONGEST.
SAMPLES, SHORTEST, LONGEST = 16, 1.0, 16.0


@dataclass(frozen=True)
class FormCoordinates:
    """Coordinates of a form: ``x = 2^d T z``."""

    exponents: Indices  # The d
    T: Array  # Separates states that are zero at some node of the form

    @property
    def whole(self) -> Array:
        """Return ``2^d T``."""
        return np.asarray(np.ldexp(self.T, self.exponents[:, None]))


@dataclass(frozen=True)
class Drawing:
    """A graph of which the forms are to be found."""

    system: SwitchedSystem
    graph: FormsOnGraph  # Without values of forms and multipliers
    forms: tuple[int, ...]  # Index of the form of each node
    coordinates: tuple[FormCoordinates, ...]  # Coordinates of each form

    def like(self, node: int) -> list[int]:
        """Return the nodes with the form of one at its place."""
        nodes = zip(self.forms, (node.place for node in self.graph.nodes), strict=True)
        key = self.forms[node], self.graph.nodes[node].place
        return [k for k, other in enumerate(nodes) if other == key]

    @property
    def is_finite(self) -> bool:
        """Whether floating point holds coordinates and modes."""
        modes = [mode.A for mode in self.system.modes]
        sizes = {A.shape for A in modes}
        alike = (to_floats([A for A in modes if A.shape == size]) for size in sizes)
        return all(
            np.isfinite(matrices).all()
            for matrices in (*alike, *(c.whole for c in self.coordinates))
        )


@dataclass(frozen=True)
class Error:
    """Error that a step adds to the state, ``|e| <= |q z|``, in the coordinates of the forms."""

    fact: Fact
    column: Array
    q: Array


@dataclass(frozen=True)
class Inequality:
    """The inequality of an edge, in the coordinates of its forms."""

    before: int  # Index of the form before the step, and entries of the form
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
    share: float = 1.0  # Further factor of the form after a map

    def weight(self, rate: float, degree: int, time: Time) -> float:
        """Return the weight of the form after a map, relative to the form before the map.

        The rate is alpha in 1/s, or rho per step; the degree is that of the monomials.
        """
        if time is Time.CONTINUOUS:
            return exp(2 * rate * self.lasts)
        return self.share * float(rate ** (-2 * degree * self.lasts))

    @property
    def kind(self) -> tuple[object, ...]:
        """All but the numbers: which forms enter, and how."""
        places = self.before, self.kept.tobytes(), self.after, self.left.tobytes()
        facts = tuple(fact for fact, _ in self.facts)
        return *places, facts, self.is_flow, self.lasts, self.is_strict, self.share

    @property
    def size(self) -> int:
        """Number of entries of z."""
        return int(self.M.shape[1])

    def images(
        self,
        starts: Sequence[int],
        sizes: Sequence[int],
        weight_before: float,
        weight_after: float,
        unit: int = 0,
    ) -> list[tuple[int, Array]]:
        """Return the blocks of the inequality for packed forms, without facts.

        Of a map ``keeps Q - counts M' Q M``, of a flow ``-(Q M + M' Q) - counts Q``, where M is
        multiplied with two to the power of the unit.
        """
        E = np.zeros((self.size, sizes[self.before]))
        E[np.arange(len(self.kept)), self.kept] = 1.0
        M = np.zeros((self.size, sizes[self.after]))
        M[:, self.left] = self.M.T
        if self.is_flow:
            N = -np.ldexp(M, unit) - weight_after / 2 * E
            return [(starts[self.before], packed_congruence(E, N) + packed_congruence(N, E))]
        before = starts[self.before], packed_congruence(weight_before * E, E)
        return [before, (starts[self.after], packed_congruence(-weight_after * M, M))]

    def changed(self, Q: Array) -> Array:
        """Return ``M' Q M`` of a map, ``Q M + M' Q`` of a flow, for forms or M of any number."""
        if not self.is_flow:
            return np.asarray(np.swapaxes(self.M, -1, -2) @ Q @ self.M)
        half = Q @ self.M
        return np.asarray(half + np.swapaxes(half, -1, -2))


@dataclass(frozen=True)
class Solution:
    """Forms, multipliers and forms that vanish for each edge, in floating point."""

    forms: list[Array]
    multipliers: Array
    vanishing: list[Array]


def states_at(drawing: Drawing, node: Node) -> int:
    """Return how many states there are at the place of a node."""
    if drawing.graph.stays is not None:
        return next(m.A.shape[0] for m in drawing.system.modes if m.name == node.place)
    return drawing.system.order - node.place.startswith("free")


def entries_of(drawing: Drawing, form: int, states: int) -> list[int]:
    """Return the entries of a form that are left where all but the first states are zero."""
    if drawing.graph.degree == 1:
        return list(range(states))
    n = drawing.system.order
    if len(drawing.coordinates[form].T) == len(monomials(states, drawing.graph.degree)):
        return list(range(len(drawing.coordinates[form].T)))
    terms = enumerate(monomials(n, drawing.graph.degree))
    return [k for k, term in terms if not any(term[states:])]


def inequalities(
    drawing: Drawing, scales: Mapping[Fact, float] | None = None
) -> tuple[list[Inequality], dict[Fact, float]]:
    """Return all edges, and the scales of the multipliers of the facts.

    Sizes that are given are kept.
    """
    system, graph = drawing.system, drawing.graph
    wholes = [one.whole for one in drawing.coordinates]
    inverses = [np.linalg.inv(whole) for whole in wholes]
    all_edges = [*graph.edges_in_time(system), *_find_instant_switches(drawing)]
    names, edges = _name_facts(drawing, all_edges), list[Inequality]()
    moves, known = list[tuple[int, Step, int]](), dict[int, FloatStep]()
    for a, step, b in all_edges:
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
        last = entries_of(drawing, drawing.forms[a], step.states)[-1]
        size = float(wholes[drawing.forms[a]][last, last] ** 2)
        for name, _ in known[id(step)].crossings:
            sizes[names[b][name]] = max(size, sizes.get(names[b][name], 0.0))
    scales = scales or {
        fact: 1 / size if size > 0 and isfinite(1 / size) else 1.0 for fact, size in sizes.items()
    }

    @cache
    def cut(form: int, states: int) -> tuple[Indices, Array, Array]:
        """Return the entries that are left of a form, and its coordinates with their inverse."""
        entries = np.array(entries_of(drawing, form, states), dtype=np.int64)
        square = np.ix_(entries, entries)
        return entries, wholes[form][square], np.asarray(inverses[form][square], dtype=float)

    for a, step, b in moves:
        before, after, floats = drawing.forms[a], drawing.forms[b], known[id(step)]
        (kept, S, _), (left, _, own) = cut(before, step.states), cut(after, len(step.rows))
        n = len(kept)
        M = own @ np.hstack([floats.M[:, :n] @ S, floats.M[:, n:]])
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


def _name_facts(
    drawing: Drawing, all_edges: Sequence[tuple[int, AnyStep, int]]
) -> list[dict[str, Fact]]:
    """Return for each node what the facts of steps to it are called."""
    first = [drawing.like(k)[0] for k in range(len(drawing.graph.nodes))]
    targets: dict[str, set[int]] = {}
    for _, step, b in all_edges:
        for name in step.facts:
            targets.setdefault(name, set()).add(first[b])
    return [
        {name: (name, None if len(known) == 1 else b) for name, known in targets.items()}
        for b in first
    ]


def _find_instant_switches(drawing: Drawing) -> Iterator[tuple[int, Step, int]]:
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
    """Yield the map of the state over a stay, for some of its lengths."""
    from scipy.linalg import expm

    A = np.array(step.edge.source.A.floats())
    G = np.eye(len(A)) if step.edge.map is None else np.array(step.edge.map.floats())
    first, last = float(step.begin), float(step.end)
    times = min(max(float(np.linalg.norm(A)) * (last - first), SHORTEST), LONGEST)
    for lasts in np.linspace(first, last, round(SAMPLES * times) + 1 if last > first else 1):
        yield float(lasts), G @ np.asarray(expm(A * lasts))


def distinct(edges: list[Inequality]) -> tuple[list[Inequality], list[int]]:
    """Return edges that differ by more than rounding, and for each edge the index of its equal."""
    representatives: list[Inequality] = []
    groups: dict[object, list[tuple[int, Array]]] = {}
    found = []
    for edge in edges:
        key = edge.kind
        numbers = np.concatenate([edge.M.ravel(), *(form.ravel() for _, form in edge.facts)])
        tolerance = NEARLY * np.abs(numbers).max(initial=0.0)
        # Edges that are near have nearly the same sum, so they are looked for in three places only.
        width = np.ldexp(1.0, int(np.frexp(tolerance)[1])) * max(len(numbers), 1)
        share = float(numbers @ _mixing_weights(len(numbers)) / width)
        place = int(share // 1) if isfinite(share) else 0
        neighbours = (groups.get((key, width, place + i), ()) for i in (-1, 0, 1))
        others = chain.from_iterable(neighbours)
        same = (k for k, other in others if np.abs(other - numbers).max() <= tolerance)
        k = min(same, default=len(representatives))
        if k == len(representatives):
            representatives.append(edge)
            groups.setdefault((key, width, place), []).append((k, numbers))
        found.append(k)
    return representatives, found


@cache
def _mixing_weights(count: int) -> Array:
    """Return numbers between -1 and 1 of which no few add up to nothing."""
    return np.cos(np.arange(count))


@dataclass(frozen=True)
class FloatStep:
    """A step in the units of the system, and the facts that hold in it, by name."""

    M: Array
    errors: tuple[tuple[str, int, Array], ...]  # Entry e of z and row q: ``e^2 <= (q z)^2``
    crossings: tuple[tuple[str, Array], ...]  # Row c: ``delta (c z) <= 0``
    products: tuple[tuple[str, Array, Array], ...]  # Rows l and r: ``(l z) (r z) >= 0``

    @classmethod
    def of(cls, step: Step) -> FloatStep:
        """Convert a step."""
        units = step.units

        def floats(entries: Sequence[int], denominator: int = 1) -> Array:
            row = [_divide(e, unit * denominator) for e, unit in zip(entries, units, strict=False)]
            return np.array(row + [0.0] * (len(units) - len(row)))

        try:
            # In one go where the integers allow.
            M = np.array(step.rows, np.int64) / (np.array(units, np.int64) * float(step.over))
        except (OverflowError, ValueError):
            M = np.array([floats(entries, step.over) for entries in step.rows])
        return cls(
            M,
            tuple((name, i, floats(q, denominator)) for name, i, q, denominator in step.errors),
            tuple((name, floats(c, below)) for name, c, below in step.crossings),
            tuple((name, floats(left), floats(right)) for name, left, right in step.products),
        )


def _divide(numerator: int, denominator: int) -> float:
    try:
        return numerator / denominator
    except OverflowError:
        return inf
