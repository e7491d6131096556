"""Coordinates for modes that are left after a while, in floating point (untrusted)."""

from __future__ import annotations

from collections.abc import Collection
from itertools import accumulate, repeat
from math import exp, log

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.switching import Edge
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import balance, round_coordinates
from nrs_design.search.drawing import FormCoordinates

Array = NDArray[np.float64]

# The mean of all switches may grow: so much of it is kept, and so often it is applied.
KEPT, SWEEPS = 0.9, 60
# What is flatter than this, relative to the longest axis, is not made round.
FLAT = 1e-9
# Of each number of pieces in turn it is predicted whether they are enough.
PIECES = (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096)
# Predictions leave out what is rounded: this is left for it.
SAFE = 1.02


def round_stays(system: SwitchedSystem, leaving: Collection[str]) -> dict[str, FormCoordinates]:
    """Return coordinates of each mode in which what a mean signal keeps of the state is round.

    Modes that are left, are so after a stay in the middle of its range; others stay until they
    decay.
    """
    edges = [(edge, _flow(system, edge, edge.source.name in leaving)) for edge in system.edges()]
    counts = {mode.name: 0 for mode in system.modes}
    for edge, _ in edges:
        counts[edge.source.name] += 1
    units = {mode.name: _unit(mode) for mode in system.modes}

    def mean(forms: dict[str, Array]) -> dict[str, Array]:
        found = {name: np.zeros_like(P) for name, P in forms.items()}
        for edge, E in edges:
            name = edge.source.name
            found[name] += E.T @ forms[edge.target.name] @ E / counts[name]
        return found

    grown, growths = units, list[float]()
    for _ in range(SWEEPS):
        grown = mean(grown)
        size = max(float(np.trace(P)) for P in grown.values())
        if not 0 < size < np.inf:
            break
        grown = {name: P / size for name, P in grown.items()}
        growths.append(log(size))
    # In the mean, as modes that follow each other may grow and decay in turn.
    growth = exp(sum(growths) / max(len(growths), 1))
    kept, forms = min(1.0, KEPT / growth), units
    for _ in range(SWEEPS):
        forms = {name: units[name] + kept * P for name, P in mean(forms).items()}
    return {name: _round(P) for name, P in forms.items()}


def _unit(mode: Mode) -> Array:
    """Return the square of the state in units in which the mode is balanced."""
    exponents = balance(np.array([mode.A.floats()]))
    return np.diag(np.ldexp(1.0, -2 * exponents))


def _round(P: Array) -> FormCoordinates:
    """Return coordinates in which a form is nearly that of the identity.

    Its diagonal is in the exponents.
    """
    exponents = -np.rint(np.log2(np.diag(P)) / 2).astype(np.int64)
    even = np.ldexp(P, exponents[:, None] + exponents)
    return FormCoordinates(exponents, round_coordinates(even + FLAT * np.eye(len(P))))


def _flow(system: SwitchedSystem, edge: Edge, left: bool) -> Array:
    from scipy.linalg import expm

    A, stay = np.array(edge.source.A.floats()), system.stays()[edge.source.name]
    time = float(stay.shortest)
    if left and stay.longest is not None:
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
