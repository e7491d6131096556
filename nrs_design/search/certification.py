"""Limits and results of a search: nouns that import no numerical library."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.certificates.certificate import AbstractChecked, CommonQuadraticStatus, Verdict
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.work import GIGABYTE


@dataclass(frozen=True, slots=True)
class Limits:
    """How far the searches go."""

    # Highest degree of a homogeneous polynomial function; None for as high as the budget allows.
    max_degree: int | None = None
    # Work, in units (`nrs_design.search.work`). Steps that are predicted not to fit are not begun.
    budget: float = 60.0
    memory: float = 2 * GIGABYTE  # Steps that are predicted to need more bytes are not begun
    optimize_rate: bool = True  # Look for the largest provable decay rate, not only for some
    more: bool = True  # Search for bounds and regions after a proof of stability
    # Goal in 1/s: a search goes on until this rate is proved, or out of reach.
    decay_rate: Fraction | None = None


@dataclass(frozen=True, slots=True)
class Attempt:
    """Name, outcome, time in s and work in units of one search.

    The time differs from run to run, and decides nothing.
    """

    step: str
    outcome: str
    seconds: float
    work: float = 0.0


@dataclass(frozen=True, slots=True)
class Certification(AbstractChecked):
    """The verdict on one system, with everything that was shown on the way."""

    system: SwitchedSystem  # Subject of the verdict
    verdict: Verdict  # Proved, refuted or inconclusive
    common_quadratic: CommonQuadraticStatus  # Whether a common quadratic function exists
    method: str  # The deciding rung, or the requested method
    # The deciding evidence first, if any. Each has passed the exact check.
    statements: tuple[AbstractEvidence, ...]
    attempts: tuple[Attempt, ...]  # Every rung in order
    # No proof can claim a faster decay (in floating point): the slowest mode's rate. None beyond
    # floating point.
    rate_limit: float | None = None

    @property
    def is_open(self) -> bool:
        """Whether the system is neither proved nor refuted, in any contact."""
        return self.verdict is Verdict.INCONCLUSIVE and self.refuted_in is None
