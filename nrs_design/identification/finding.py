"""What every identification is: numbers from data files, and what speaks against them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from nrs_design.identification.tables.table import Source


class Finding(Protocol):
    """What records say about a tissue, an actuator or a delay."""

    @property
    def sources(self) -> Sequence[Source]:
        """The files."""

    @property
    def remarks(self) -> Sequence[str]:
        """What the numbers rest on; no reason to doubt them."""

    @property
    def doubts(self) -> Sequence[str]:
        """What speaks against the numbers: with one, the result is inconclusive."""

    @property
    def caveats(self) -> Sequence[str]:
        """What a proof that uses the numbers must know: the doubts, and what it leaves out."""


def is_synthetic(sources: Sequence[Source]) -> bool:
    """Tell whether a simulation made some of the data."""
    return any(source.synthetic for source in sources)
