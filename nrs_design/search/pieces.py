"""How finely stays of any length in a range must be cut, predicted in floating point."""

from __future__ import annotations

from itertools import accumulate, repeat

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.switching import Edge
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import round_coordinates

Array = NDArray[np.float64]

# Of each number of pieces in turn it is predicted whether they are enough.
PIECES = (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096)
# Predictions leave out what is rounded: this is left for it.
SAFE = 1.02


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
    """Return which number of pieces is enough for the stays before a switch, from one of them."""
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
