"""Coordinates for modes that are left after a while, in floating point (untrusted)."""

from __future__ import annotations

from collections.abc import Collection
from itertools import accumulate, repeat

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.switching import Edge
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import balance, round_coordinates
from nrs_design.search.branches import mean_forms
from nrs_design.search.drawing import FormCoordinates

Array = NDArray[np.float64]

# Numbers of pieces that are tried in turn.
PIECES = (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096)
# Predictions leave out what is rounded: this is left for it.
SAFE = 1.02


def round_stays(system: SwitchedSystem, leaving: Collection[str]) -> dict[str, FormCoordinates]:
    """Return coordinates of each mode in which the form of `mean_forms` is round.

    Modes that are left, are so after a stay in the middle of its range; others stay until they
    decay.
    """
    scales = {mode.name: balance(np.array([mode.A.floats()])) for mode in system.modes}
    number, edges = {name: k for k, name in enumerate(scales)}, [*system.edges()]
    # Maps of modes with fewer states are padded by zeros.
    n = max(map(len, scales.values()))
    maps = np.zeros((len(edges), n, n))
    for k, edge in enumerate(edges):
        before, after = scales[edge.source.name], scales[edge.target.name]
        E = _flow(system, edge, edge.source.name in leaving)
        maps[k, : len(after), : len(before)] = np.ldexp(E, before - after[:, None])
    sources = np.array([number[edge.source.name] for edge in edges])
    targets = np.array([number[edge.target.name] for edge in edges])
    forms = mean_forms(maps, sources, targets, len(number))
    return {
        name: FormCoordinates(scale, round_coordinates(P[: len(scale), : len(scale)]))
        for (name, scale), P in zip(scales.items(), forms, strict=True)
    }


def _flow(system: SwitchedSystem, edge: Edge, leaves: bool) -> Array:
    """Return the map of the state over a stay and the switch after it."""
    from scipy.linalg import expm

    A, stay = np.array(edge.source.A.floats()), system.stays()[edge.source.name]
    time = float(stay.shortest)
    if leaves and stay.longest is not None:
        time = float(stay.shortest + stay.longest) / 2
    else:
        slowest = -float(np.linalg.eigvals(A).real.max())
        time += 1 / slowest if slowest > 0 else 0.0
    E = np.asarray(expm(A * time))
    return E if edge.map is None else np.asarray(np.array(edge.map.floats()) @ E)


def enough_pieces(system: SwitchedSystem, graph: FormsOnGraph) -> int | None:
    """Predict into how many pieces stays have to be cut for their enclosures to show a decrease.

    In continuous time; None if too many would be needed.
    """
    assert graph.stays is not None
    largest = max(max(map(abs, row)) for node in graph.nodes for row in node.form)
    forms = {
        node.place: np.array(RationalMatrix(node.form, largest).floats()) for node in graph.nodes
    }
    edges = [edge for edge in system.edges() if edge.source.name in graph.stays.leaving]
    fine = 0
    for edge in edges:
        before, after = forms[edge.source.name], forms[edge.target.name]
        found = _pieces_of(system, edge, before, after, float(graph.rate), fine)
        if found is None:
            return None
        fine = found
    return PIECES[fine]


def _pieces_of(
    system: SwitchedSystem, edge: Edge, before: Array, after: Array, rate: float, first: int
) -> int | None:
    """Return the index of a sufficient number of pieces before a switch, from a first index."""
    from scipy.linalg import expm

    stay, n = system.stays()[edge.source.name], len(before)
    assert stay.longest is not None
    begin, width = float(stay.shortest), float(stay.longest - stay.shortest)
    if width == 0:
        return first
    T = round_coordinates(before)
    B = np.array(edge.source.A.floats()) + rate * np.eye(n)
    G = np.eye(n) if edge.map is None else np.array(edge.map.floats())
    C = np.linalg.inv(T) @ B @ T
    moved = np.abs(C)
    for k in range(first, len(PIECES)):
        half = width / PIECES[k] / 2
        step = expm(B * (2 * half))
        flows = accumulate(repeat(step, PIECES[k] - 1), np.matmul, initial=expm(B * (begin + half)))
        E = G @ np.array(list(flows)) @ T
        left = np.swapaxes(E, 1, 2) @ after @ E
        once = left @ C + C.T @ left
        twice = np.abs(once @ C + C.T @ once)
        # The exponential of a ball reaches so far from zero.
        near = expm(moved * half)
        error = (near.T @ twice @ near).sum(axis=2) * half**2 / 2
        ends = (expm(C * -half), expm(C * half))
        rests = (np.eye(n) * (1 - SAFE * error[:, :, None]) - N.T @ left @ N for N in ends)
        if all(float(np.linalg.eigvalsh(rest).min()) > 0 for rest in rests):
            return k
    return None
