"""A theorem for Coq: what is defined, what is computed, what is stated, and why it follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Theorem:
    """The text of a file, but for its head."""

    library: tuple[str, ...]  # Parts of the library, in order
    definitions: Sequence[str]  # The system and the certificate
    check: str  # What must be computed to be true
    statement: str  # The theorem
    proof: str  # A term, with `checked` for what was computed
    states: tuple[str, ...]  # In the order in which it counts them
    left_out: tuple[str, ...] = ()  # What the statement leaves out against the claim
