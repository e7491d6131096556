"""One linear mode, in continuous or in discrete time."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from nrs_design.proof.matrix import RationalMatrix


class Time(StrEnum):
    """Continuous (``x' = A x``) or discrete (``x+ = A x``) time."""

    CONTINUOUS = "continuous"
    DISCRETE = "discrete"


@dataclass(frozen=True, slots=True)
class Mode:
    """One linear mode: its name and its exact state matrix, shape (n, n)."""

    name: str
    A: RationalMatrix
