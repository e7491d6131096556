"""The gradient iteration beside the LMI: one run of each, on the same system."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.progress import Progress, silent
from nrs_design.search.certification import Certification, Limits
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order
from nrs_design.search.method import Method

Decide = Callable[[Method, Limits], Certification]
# Updates and the largest v after them.
History = tuple[tuple[int, float], ...]


def compare_methods(
    decide: Decide, limits: Limits, progress: Progress = silent
) -> tuple[MethodRun, ...]:
    """Run the LMI once, and the iteration in all coordinates and orders.

    A `DesignError` if the methods do not apply to the system, or there is no mode to start with.
    """
    progress("lmi")
    try:
        known = decide(Method.LMI, replace(limits, gradient=Gradient()))
    except DesignError as error:
        raise DesignError(
            "LMI and gradient iteration look for one quadratic function for all modes, which does "
            "not apply to this kind of switching",
            remedy="use `nrs-design certify-switching`",
        ) from error
    runs = [MethodRun(Method.LMI, known, _seconds(known))]
    for coordinates, order in product(Coordinates, Order):
        progress(f"gradient, {coordinates}, {order}")
        runs.append(_run_gradient(decide, limits, coordinates, order))
    return tuple(runs)


def _run_gradient(
    decide: Decide, limits: Limits, coordinates: Coordinates, order: Order
) -> MethodRun:
    histories: list[list[tuple[int, float]]] = []

    def tell(updates: int, largest: float) -> None:
        if not updates:
            histories.append([])
        histories[-1].append((updates, largest))

    gradient = replace(limits.gradient, coordinates=coordinates, order=order, tell=tell)
    found = decide(Method.GRADIENT, replace(limits, gradient=gradient))
    told = tuple(map(tuple, histories))
    return MethodRun(Method.GRADIENT, found, _seconds(found), coordinates, order, told)


def _seconds(found: Certification) -> float:
    return sum(attempt.seconds for attempt in found.attempts)


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
