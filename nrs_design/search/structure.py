"""Structure that makes a family smaller before any search: equal modes and triangular blocks.

By hand, as every proof passes here: to load SciPy's `connected_components` takes longer than the
proof.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import SwitchedSystem

Pattern = NDArray[np.bool_]


def merge_equal_modes(system: SwitchedSystem) -> SwitchedSystem:
    """Return the system without duplicate modes; the same object if all modes differ.

    Equal modes may differ in what disturbs them, so disturbances and outputs are left behind; with
    what the arithmetic adds to them, they are not equal.
    """
    if system.roundings or system.enclosures:
        return system
    first: dict[RationalMatrix, int] = {}
    for index, mode in enumerate(system.modes):
        first.setdefault(mode.A, index)
    if len(first) == len(system.modes):
        return system
    modes = tuple(system.modes[index] for index in first.values())
    flights = system.flights
    if flights is not None:
        flights = flights.among(mode.name for mode in modes)
    return replace(system, modes=modes, channels=(), outputs=(), saturation=None, flights=flights)


def triangular_blocks(system: SwitchedSystem) -> tuple[tuple[int, ...], ...]:
    """Order the states into blocks such that no block is driven by an earlier one.

    The blocks are the strongly connected components of the union of all patterns of A.
    """
    n = system.order
    pattern = np.zeros((n, n), dtype=bool)
    for mode in system.modes:
        pattern |= np.array(mode.A.numerators, dtype=bool)
        if pattern.all():
            return (tuple(range(n)),)
    reaches = reachable(pattern)
    # A block of states that reach each other is named by its first state.
    first = np.argmax(reaches & reaches.T, axis=1)
    blocks = [tuple(int(i) for i in np.flatnonzero(first == k)) for k in sorted({*first})]
    drives = [[pattern[np.ix_(a, b)].any() for b in blocks] for a in blocks]
    return tuple(blocks[k] for k in _sources_first(np.array(drives)))


def reachable(pattern: Pattern) -> Pattern:
    """Return the transitive closure of a pattern, by squaring."""
    reaches = pattern | np.eye(len(pattern), dtype=bool)
    for _ in range(len(pattern).bit_length()):
        reaches = reaches @ reaches
    return reaches


def _sources_first(driven_by: Pattern) -> list[int]:
    """Order the blocks so that a block depends only on the block itself and on later blocks."""
    remaining, order = set(range(len(driven_by))), []
    while remaining:
        # A block that drives no other remaining block comes next.
        index = min(k for k in remaining if not any(driven_by[j, k] for j in remaining if j != k))
        order.append(index)
        remaining.remove(index)
    return order
