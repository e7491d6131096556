"""Decide a table of nested questions with few decisions.

A row allows for all that the rows before it allow for, a column for all that the columns before it
do. So a proof holds for every cell before it, and a refutation for every cell after it.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable
from itertools import product

from nrs_design.certificates.certificate import Verdict

Cell = tuple[int, int]


def decide_staircase(
    rows: int, columns: int, decide: Callable[[Cell], Verdict]
) -> dict[Cell, Verdict]:
    """Decide every cell that a search can; the others are inconclusive.

    Parameters
    ----------
    rows, columns : int
        How many there are.
    decide : callable
        Gives the verdict on a cell (row, column); asked once at most for each.

    Returns
    -------
    dict
        A verdict for every cell.
    """
    asked: dict[Cell, Verdict] = {}

    def verdict(cell: Cell) -> Verdict:
        known = _follows(cell, asked)
        if known is None:
            known = asked[cell] = decide(cell)
        return known

    for row in range(rows):
        cells = [(row, column) for column in range(columns)]
        proved = bisect_left(cells, True, key=lambda cell: verdict(cell) is not Verdict.PROVED)
        bisect_left(cells, True, lo=proved, key=lambda cell: verdict(cell) is Verdict.REFUTED)
    everywhere = product(range(rows), range(columns))
    return {cell: _follows(cell, asked) or Verdict.INCONCLUSIVE for cell in everywhere}


def _follows(cell: Cell, asked: dict[Cell, Verdict]) -> Verdict | None:
    """Return what is known of a cell from those that were decided."""
    row, column = cell
    for (other_row, other_column), found in asked.items():
        if found is Verdict.PROVED and row <= other_row and column <= other_column:
            return found
        if found is Verdict.REFUTED and row >= other_row and column >= other_column:
            return found
    return asked.get(cell)
