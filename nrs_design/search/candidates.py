"""What a search yields: evidence that nobody has checked yet."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Generic, TypeVar

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.search.family import Family

E = TypeVar("E", bound=AbstractEvidence, covariant=True)


@dataclass(frozen=True, slots=True)
class Candidate(Generic[E]):
    """Evidence as a search proposes it, and in words how the search ends if it is accepted."""

    evidence: E
    words: str = "found"


# Best candidates first. At the end the words on why there is none, or None if there could have been
# some: then whoever takes them knows why none was taken.
Candidates = Generator[Candidate[E], None, str | None]
Search = Callable[[Family], Candidates[AbstractEvidence]]

NO_MARGIN = "the solver found no solution with positive margins"
OUT_OF_RANGE = "the modes are beyond the range of floating point"
