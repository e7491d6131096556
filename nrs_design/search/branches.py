"""Branch and bound for the closed words that grow the most per step (untrusted).

As of Gripenberg (Linear Algebra and its Applications 234, 1996), on a graph: of the rotations of a
closed word there is one of which every beginning grows by as much per step as the word itself, in
any norms of the nodes. So beginnings that grow by less than the best word known lead nowhere new.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from nrs_design.search.balance import round_coordinates
from nrs_design.search.graph import spectral_radii
from nrs_design.search.step_graph import StepGraph
from nrs_design.work import Allowance, Cost

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# Steps of a word, products of a length, and all of them.
MAX_LENGTH, MAX_PRODUCTS, MOST_PRODUCTS = 64, 20_000, 150_000
# Entries of the products of a length.
MAX_ENTRIES = 2_000_000
# A word is better if it grows by this share more.
BETTER = 1e-6
# Work for the norm and the eigenvalues of a product, and per multiplication in them.
PER_MATRIX, PER_PRODUCT = 1e-5, 6e-8
# Norms of the nodes: what a mean word keeps is round, and so often it is followed.
KEPT, SWEEPS = 0.9, 40
FLAT = 1e-9


def best_words(
    graph: StepGraph,
    allowance: Allowance,
    floor: float = 0.0,
    T: Array | None = None,
    longest: int = MAX_LENGTH,
) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield closed words of edges with their growth per step, each larger than all before it.

    Words that grow by no more than the floor are not looked for; lengths for which work or memory
    do not suffice end the search. Norms are taken in coordinates T of every node, shape
    (nodes, n, n): by default those in which what a mean word keeps is round.
    """
    T = _round(graph) if T is None else T
    inner = np.linalg.inv(T)[graph.targets] @ graph.maps @ T[graph.sources]
    if not np.isfinite(inner).all():
        return
    begins = np.searchsorted(graph.sources, np.arange(graph.count + 1))
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
        kept = np.flatnonzero(bounds > floor * (1 + BETTER))
        after = begins[ends + 1] - begins[ends]
        widest = max(int(after[kept].max(initial=1)), 1)
        most = max(1, min(MAX_PRODUCTS, MAX_ENTRIES // size**2) // widest)
        kept = kept[np.argsort(-bounds[kept], kind="stable")[:most]]
        if not len(kept) or not after[kept].sum():
            return
        old = np.repeat(kept, after[kept])
        within = np.arange(len(old)) - np.repeat(np.cumsum(after[kept]) - after[kept], after[kept])
        edges = np.repeat(begins[ends[kept]], after[kept]) + within
        words = np.hstack([words[old], edges[:, None]])
        products, bounds = inner[edges] @ products[old], bounds[old]


def _round(graph: StepGraph) -> Array:
    """Return coordinates of every node in which what a mean word keeps of the state is round."""
    return np.array([round_coordinates(P) for P in round_forms(graph)])


def round_forms(graph: StepGraph) -> Array:
    """Return for every node the form of what a mean word keeps of the state; (count, n, n)."""
    n = graph.maps.shape[1]
    leaving = np.bincount(graph.sources, minlength=graph.count).clip(1)
    unit = np.broadcast_to(np.eye(n), (graph.count, n, n))

    def mean(forms: Array) -> Array:
        found = np.zeros_like(forms)
        after = np.swapaxes(graph.maps, 1, 2) @ forms[graph.targets] @ graph.maps
        np.add.at(found, graph.sources, after)
        return np.asarray(found / leaving[:, None, None])

    grown, logs = np.array(unit), list[float]()
    for _ in range(SWEEPS):
        grown = mean(grown)
        size = float(np.trace(grown, axis1=1, axis2=2).max())
        if not 0 < size < np.inf:
            break
        grown = grown / size
        logs.append(np.log(size))
    kept = min(1.0, KEPT / float(np.exp(np.mean(logs)))) if logs else 1.0
    forms = np.array(unit)
    for _ in range(SWEEPS):
        forms = unit + kept * mean(forms)
    sizes = np.trace(forms, axis1=1, axis2=2)[:, None, None] / n
    return np.asarray(forms + FLAT * sizes * np.eye(n))
