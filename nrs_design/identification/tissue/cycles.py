"""Loading cycles of a record, told apart by large turns of the deflection."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from nrs_design.identification.numeric import Array

# A turn counts where the deflection comes back by this part of its range.
_TURN = 0.3


def find_cycles(deflection: Array) -> tuple[slice, ...]:
    """Return the rows of each cycle, from the rest before a load to the end of its unload.

    Together they are all rows; there is one at least.
    """
    lows = _lows(deflection, _TURN * float(np.ptp(deflection)))
    edges = [0, *lows, len(deflection)]
    return tuple(slice(a, b) for a, b in pairwise(edges))


def _lows(values: Array, least: float) -> list[int]:
    """Return the rows between a large fall and a large rise, where it is lowest."""
    lows: list[int] = []
    at_low, at_high, rising = 0, 0, True
    values_list = values.tolist()
    for row, value in enumerate(values_list):
        if rising:
            at_high = row if value >= values_list[at_high] else at_high
            if values_list[at_high] - value > least:
                rising, at_low = False, row
        else:
            # The last of equal rows: a cycle begins with its load.
            at_low = row if value <= values_list[at_low] else at_low
            if value - values_list[at_low] > least:
                lows.append(at_low)
                rising, at_high = True, row
    return lows
