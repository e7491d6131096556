"""How one method fared in a comparison: a noun."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nrs_design.search.certification import Certification
from nrs_design.search.gradient_settings import Coordinates, Order
from nrs_design.search.method import Method

# Updates and the largest v after them.
History = tuple[tuple[int, float], ...]


@dataclass(frozen=True, slots=True)
class MethodRun:
    """How one method fared."""

    method: Method  # ``lmi`` or ``gradient``
    certification: Certification  # Its verdict; whatever it found has passed the exact check
    seconds: float  # Time of the search and of the checks of its candidates
    coordinates: Coordinates | None = None  # Where the iteration ran; None for the LMI
    order: Order | None = None  # In which it took the modes; None for the LMI
    # The largest v over all modes against updates, for every block of the states that was searched
    # on its own.
    histories: tuple[History, ...] = ()

    @property
    def name(self) -> str:
        """Method, coordinates and order in words."""
        return ", ".join(filter(None, (self.method, self.coordinates, self.order)))

    @property
    def updates(self) -> int | None:
        """Updates that were made, or None for the LMI."""
        return sum(history[-1][0] for history in self.histories) if self.histories else None

    @property
    def outcome(self) -> str:
        """How the search ended, in words."""
        tried = [step for step in self.certification.attempts if str(self.method) in step.step]
        return "; ".join(dict.fromkeys(step.outcome for step in tried)) or "not needed"

    @property
    def condition(self) -> float | None:
        """Condition number of Q, in the states of the modes; None without a single Q."""
        evidence, system = self.certification.evidence, self.certification.system
        if evidence is None or not evidence.is_common_quadratic:
            return None
        # The first form of such evidence is its function, or that of its first block.
        _, Q = next(iter(evidence.forms(system)))
        if len(Q) < system.order:
            return None
        largest = max(abs(entry) for row in Q for entry in row)
        scaled = np.array([[entry / largest for entry in row] for row in Q])
        return float(np.linalg.cond(scaled))
