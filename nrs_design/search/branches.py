"""Branch and bound for the closed words that grow the most per step (untrusted).

As of Gripenberg (Linear Algebra and its Applications 234, 1996), on a graph: of the rotations of a
closed word there is one of which every beginning grows by as much per step as the word itself, in
any norms of the nodes. So beginnings that grow by less than the best word known lead nowhere new.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby, product

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.clock import on_turn
from nrs_design.proof.evidence.growth import Steps
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import round_coordinates, scale_states
from nrs_design.search.family import Family, distinct_modes, to_floats
from nrs_design.search.graph import jumps_of, spectral_radii, stay_bounds
from nrs_design.search.work import Allowance, Cost

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# Largest number of steps of a word, of products with equal length, and of all products.
MAX_LENGTH, MAX_PRODUCTS, MOST_PRODUCTS = 64, 20_000, 150_000
# Entries of the products of a length.
MAX_ENTRIES = 2_000_000
# Least relative gain of a better word.
BETTER = 1e-6
# Work for the norm and the eigenvalues of a product, and per multiplication in them.
PER_MATRIX, PER_PRODUCT = 1e-5, 6e-8
# Norms of the nodes: contraction of a mean word, and number of steps along the word.
KEPT, SWEEPS = 0.9, 40
FLAT = 1e-9
# Larger graphs are not searched.
MOST_NODES, MOST_EDGES = 4000, 200_000


def best_words(
    graph: StepGraph,
    allowance: Allowance,
    floor: float = 0.0,
    T: Array | None = None,
    longest: int = MAX_LENGTH,
) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield closed words of edges with their growth per step, in increasing order of growth.

    Words that grow by no more than the floor are not looked for; lengths for which work or memory
    do not suffice end the search. Norms are taken in coordinates T of every node, shape
    (nodes, n, n): by default those in which what a mean word keeps is round.
    """
    T = round_nodes(graph) if T is None else T
    inner = np.linalg.inv(T)[graph.targets] @ graph.maps @ T[graph.sources]
    if not np.isfinite(inner).all():
        return
    first_edges = np.searchsorted(graph.sources, np.arange(graph.count + 1))
    words = np.arange(len(inner))[:, None]
    products, bounds, total = inner, np.full(len(inner), np.inf), 0
    for length in range(1, longest + 1):
        total += len(words)
        size = inner.shape[1]
        cost = Cost(len(words) * (PER_MATRIX + PER_PRODUCT * size**3), 64 * products.size)
        if total > MOST_PRODUCTS or not allowance.affords(cost):
            return
        allowance.take(cost, f"looking at {len(words)} products of {length} modes")
        starts, ends = graph.sources[words[:, 0]], graph.targets[words[:, -1]]
        closed = np.flatnonzero(starts == ends)
        if len(closed):
            growth = spectral_radii(products[closed]) ** (1 / length)
            best = int(growth.argmax())
            if growth[best] > floor * (1 + BETTER):
                floor = float(growth[best])
                yield tuple(int(k) for k in words[closed[best]]), floor
        norms = np.nan_to_num(np.linalg.norm(products, 2, axis=(1, 2)), posinf=0.0)
        bounds = np.minimum(bounds, norms ** (1 / length))
        extendable = np.flatnonzero(bounds > floor * (1 + BETTER))
        after = first_edges[ends + 1] - first_edges[ends]
        widest = max(int(after[extendable].max(initial=1)), 1)
        capacity = max(1, min(MAX_PRODUCTS, MAX_ENTRIES // size**2) // widest)
        extendable = extendable[np.argsort(-bounds[extendable], kind="stable")[:capacity]]
        if not len(extendable) or not after[extendable].sum():
            return
        old = np.repeat(extendable, after[extendable])
        offsets = np.arange(len(old)) - np.repeat(
            np.cumsum(after[extendable]) - after[extendable], after[extendable]
        )
        edges = np.repeat(first_edges[ends[extendable]], after[extendable]) + offsets
        words = np.hstack([words[old], edges[:, None]])
        products, bounds = inner[edges] @ products[old], bounds[old]


def round_nodes(
    graph: StepGraph, find_coordinates: Callable[[Array], Array] = round_coordinates
) -> Array:
    """Return coordinates of every node in which the form of `mean_forms` is round."""
    forms = mean_forms(graph.maps, graph.sources, graph.targets, graph.count)
    return np.array([find_coordinates(P) for P in forms])


def mean_forms(maps: Array, sources: Indices, targets: Indices, count: int) -> Array:
    """Return for every node the form of the state that a mean walk keeps, shape (count, n, n).

    A walk goes along edges with these sources and targets, and maps of the state, shape (.., n, n).
    """
    n = maps.shape[1]
    leaving = np.bincount(sources, minlength=count).clip(1)
    unit = np.broadcast_to(np.eye(n), (count, n, n))

    def mean(forms: Array) -> Array:
        found = np.zeros_like(forms)
        np.add.at(found, sources, np.swapaxes(maps, 1, 2) @ forms[targets] @ maps)
        return np.asarray(found / leaving[:, None, None])

    growth_forms, logs = np.array(unit), list[float]()
    for _ in range(SWEEPS):
        growth_forms = mean(growth_forms)
        size = float(np.trace(growth_forms, axis1=1, axis2=2).max())
        if not 0 < size < np.inf:
            break
        growth_forms = growth_forms / size
        logs.append(np.log(size))
    # In the mean, as modes that follow each other may grow and decay in turn.
    retention = min(1.0, KEPT / float(np.exp(np.mean(logs)))) if logs else 1.0
    forms = np.array(unit)
    for _ in range(SWEEPS):
        forms = unit + retention * mean(forms)
    sizes = np.trace(forms, axis1=1, axis2=2)[:, None, None] / n
    return np.asarray(forms + FLAT * sizes * np.eye(n))


@dataclass(frozen=True)
class StepGraph:
    """Graph of steps: a node is a mode with a count of steps, an edge is a step.

    Edges are in the order of their sources.
    """

    names: tuple[str, ...]  # Names of the modes
    # Data of each edge: nodes, mode of the step, reset before the step (-1: no switch), and map of
    # the state.
    sources: Indices
    targets: Indices
    modes: Indices
    ways: Indices
    maps: Array  # Shape (edges, n, n)
    count: int  # Number of nodes
    has_choice: bool  # Some switch has more than one reset

    @classmethod
    def of(cls, system: SwitchedSystem, matrices: Array) -> StepGraph | None:
        """Return the graph of a system; None for other kinds of systems and for large graphs.

        The modes may be scaled; they are those of the system itself if there are resets.
        """
        names = tuple(mode.name for mode in system.modes)
        if system.time is not Time.DISCRETE or system.clock is not None:
            return None
        if system.switching.is_arbitrary:
            return cls.free(names, matrices)
        shortest, longest = stay_bounds(system)
        jumps = jumps_of(system)
        # Steps in a mode are counted up to where nothing changes any more.
        last = np.where(np.isinf(longest), shortest, longest)
        if last.sum() > MOST_NODES:
            return None
        first = np.concatenate([[0], np.cumsum(last)]).astype(np.int64)
        rows: list[tuple[int, int, int, int]] = []
        maps: list[Array] = []
        for k, A in enumerate(matrices):
            for node in range(first[k], first[k + 1] - 1):
                rows.append((node, node + 1, k, -1))
                maps.append(A)
            if np.isinf(longest[k]):
                rows.append((int(first[k + 1]) - 1, int(first[k + 1]) - 1, k, -1))
                maps.append(A)
        for jump in jumps:
            entered = matrices[jump.target] @ jump.map
            begin = first[jump.source] + int(shortest[jump.source]) - 1
            for node in range(begin, first[jump.source + 1]):
                rows.append((node, int(first[jump.target]), jump.target, jump.way))
                maps.append(entered)
            if len(rows) > MOST_EDGES:
                return None
        if not rows:
            return None
        columns = np.array(rows, dtype=np.int64)
        order = np.argsort(columns[:, 0], kind="stable")
        sources, targets, modes, ways = columns[order].T
        has_choice = any(jump.way for jump in jumps)
        each = np.array(maps)[order]
        return cls(names, sources, targets, modes, ways, each, int(first[-1]), has_choice)

    @classmethod
    def free(cls, names: Sequence[str], matrices: Array) -> StepGraph:
        """Return the graph of modes of which any may follow any."""
        none, every = np.zeros(len(names), dtype=np.int64), np.arange(len(names))
        return cls(tuple(names), none, none, every, none, matrices, 1, has_choice=False)

    @classmethod
    def of_clock(
        cls, clock: Clock, names: Sequence[str], matrices: Array, kinds: Sequence[int]
    ) -> StepGraph:
        """Return the graph of an automaton, with a node for each state."""
        turns, own = clock.turns(), enumerate(kinds)
        rows = [(a, b, k) for (a, kind, b), (k, one) in product(turns, own) if one == kind]
        sources, targets, modes = np.array(rows, dtype=np.int64).T
        # Every step is a stay of its own.
        ways = np.zeros_like(modes)
        count, maps = clock.length, matrices[modes]
        return cls(tuple(names), sources, targets, modes, ways, maps, count, has_choice=False)

    def sequence(self, word: Sequence[int]) -> tuple[Steps, tuple[int, ...]]:
        """Return a closed word as the stays of a signal, with the resets that it takes."""
        word = list(word)
        jumps = [k for k, edge in enumerate(word) if self.ways[edge] >= 0]
        if not jumps:
            return ((self.names[self.modes[word[0]]], Fraction(1)),), ()
        # A signal begins with its first mode.
        first = min(jumps, key=lambda k: int(self.modes[word[k]]))
        word = word[first:] + word[:first]
        if not self.has_choice and (self.ways >= 0).all():
            # Every step is a stay of its own.
            runs = [(mode, len([*run])) for mode, run in groupby(self.modes[word].tolist())]
            return tuple((self.names[mode], Fraction(count)) for mode, count in runs), ()
        starts = [k for k, edge in enumerate(word) if self.ways[edge] >= 0]
        ends = [*starts[1:], len(word)]
        steps = tuple(
            (self.names[self.modes[word[a]]], Fraction(b - a))
            for a, b in zip(starts, ends, strict=True)
        )
        ways = [int(self.ways[word[a]]) for a in starts]
        return steps, (*ways[1:], ways[0]) if self.has_choice else ()


def turns_graph(family: Family, clock: Clock) -> StepGraph:
    """Return the steps that an automaton allows, of modes that differ by no more than rounding."""
    modes = [
        (mode.name, A, kind)
        for kind in clock.kinds
        for mode, A in distinct_modes(on_turn(family.system, clock, kind).modes)
    ]
    texts, matrices, kinds = zip(*modes, strict=True)
    scaled = scale_states(np.array(matrices), family.exponents)
    return StepGraph.of_clock(clock, texts, scaled, kinds)


def matrices_of_kinds(family: Family, clock: Clock) -> list[Array]:
    """Return the scaled modes of each kind, shape (m, n, n)."""
    parts = (on_turn(family.system, clock, kind).modes for kind in clock.kinds)
    return [scale_states(to_floats([mode.A for mode in own]), family.exponents) for own in parts]
