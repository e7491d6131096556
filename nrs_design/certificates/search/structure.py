"""Structure that makes a family smaller before any search: equal modes and triangular blocks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from nrs_design.switched.matrix import RationalMatrix
from nrs_design.switched.system import SwitchedSystem


def merge_equal_modes(system: SwitchedSystem) -> SwitchedSystem:
    """Keep the first of every set of equal modes."""
    first: dict[RationalMatrix, int] = {}
    for index, mode in enumerate(system.modes):
        first.setdefault(mode.A, index)
    return replace(system, modes=tuple(system.modes[index] for index in first.values()))


def triangular_blocks(system: SwitchedSystem) -> tuple[tuple[int, ...], ...]:
    """Order the states into blocks such that no block is driven by an earlier one.

    The blocks are the strongly connected components of the union of all patterns of A.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

    n = system.order
    pattern = np.zeros((n, n), dtype=bool)
    for mode in system.modes:
        pattern |= np.array([[entry != 0 for entry in row] for row in mode.A.numerators])
    count, label = connected_components(csr_matrix(pattern), connection="strong")
    blocks = [tuple(int(i) for i in np.flatnonzero(label == k)) for k in range(count)]
    drives = [[pattern[np.ix_(a, b)].any() for b in blocks] for a in blocks]
    return tuple(blocks[k] for k in _sources_first(np.array(drives)))


def _sources_first(driven_by: np.ndarray[tuple[int, int], np.dtype[np.bool_]]) -> list[int]:
    """Order blocks so that each is driven by itself and later ones only."""
    remaining, order = set(range(len(driven_by))), []
    while remaining:
        # A block that drives no other remaining block comes next.
        index = min(k for k in remaining if not any(driven_by[j, k] for j in remaining if j != k))
        order.append(index)
        remaining.remove(index)
    return order
