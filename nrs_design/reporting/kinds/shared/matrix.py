"""The matrix of a quadratic function as a table, and what its figure shows."""

from __future__ import annotations

from nrs_design.reporting.document import Block, Table
from nrs_design.reporting.formatting import number
from nrs_design.simulation.norms import Array

SCALED = (
    "Q(i,j) / sqrt(Q(i,i) Q(j,j)): the diagonal becomes one and the states lose their units. An "
    "entry near 1 or -1 says that two states act together in V."
)
_WRITTEN = 8


def matrix_table(title: str, Q: Array, states: tuple[str, ...]) -> list[Block]:
    """Return a matrix as a table, or nothing if it is too large for a page.

    Parameters
    ----------
    title : str
        Caption.
    Q : ndarray, shape (n, n)
        The matrix.
    states : tuple of str
        Names of rows and columns.
    """
    if len(Q) > _WRITTEN:
        return []
    names = states[: len(Q)]
    rows = tuple((name, *(number(v, 5) for v in row)) for name, row in zip(names, Q, strict=True))
    return [Table(title, ("", *names), rows)]
