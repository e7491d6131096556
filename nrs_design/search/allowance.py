"""How much time and memory a search may take: predicted before every step, watched during it.

What is begun is decided by predictions alone, at the speed of a nominal machine, so that a verdict
is the same on every machine that is not slower. The clock only stops what takes longer.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import perf_counter

from nrs_design.proof.noun import dataclass

GIGABYTE = 1e9


class NotAffordableError(Exception):
    """A step that is not begun, or is stopped, for lack of time or memory; says what would help."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Prediction for one step: time in s on a nominal machine, and memory in bytes."""

    seconds: float
    memory: float = 0.0


class Allowance:
    """What a search may still take.

    Parameters
    ----------
    seconds : float
        Budget of time.
    memory : float
        Largest predicted size of a single step, in bytes.
    clock : callable
        Tells the time in s.
    parent : Allowance, optional
        What this is a part of.
    """

    def __init__(
        self,
        seconds: float = inf,
        memory: float = inf,
        clock: Callable[[], float] = perf_counter,
        parent: Allowance | None = None,
    ) -> None:
        self.seconds, self.memory = seconds, memory
        self._clock, self._parent = clock, parent
        self._charged, self._begun = 0.0, clock()

    def part(self, share: float) -> Allowance:
        """Return an allowance for a share of the predicted time that is left."""
        return Allowance(share * self.unplanned, self.memory, self._clock, self)

    @property
    def total(self) -> float:
        """The whole budget that this is a part of, in s."""
        return self.seconds if self._parent is None else self._parent.total

    @property
    def unplanned(self) -> float:
        """Predicted time that is left, in s on a nominal machine."""
        return max(0.0, self.seconds - self._charged)

    @property
    def left(self) -> float:
        """Time that is left on the clock, in s."""
        own = self.seconds - (self._clock() - self._begun)
        return max(0.0, own if self._parent is None else min(own, self._parent.left))

    def charge(self, seconds: float) -> None:
        """Take predicted time off."""
        self._charged += seconds
        if self._parent is not None:
            self._parent.charge(seconds)

    def goes_on(self, seconds: float = 0.0) -> bool:
        """Charge one more step, and tell whether there is time for it."""
        self.charge(seconds)
        return self.unplanned > 0 and self.left > 0

    def check(self) -> None:
        """Stop a search whose time is over.

        Raises
        ------
        NotAffordableError
            If no time is left.
        """
        if not self.goes_on():
            whole = self._parent is None or not self._parent.goes_on()
            share = "" if whole else "its share of "
            raise NotAffordableError(
                f"stopped: {share}the budget of {self.total:g} s is used up (--budget)"
            )

    def affords(self, cost: Cost) -> bool:
        """Tell whether a step is predicted to fit, whatever the clock says."""
        return cost.memory <= self.memory and cost.seconds <= self.unplanned

    def take(self, cost: Cost, what: str) -> None:
        """Check that a step fits, and charge it; raises as `require` does."""
        self.require(cost, what)
        self.charge(cost.seconds)

    def require(self, cost: Cost, what: str) -> None:
        """Check that a step fits before anything is built for it.

        Raises
        ------
        NotAffordableError
            If it needs more memory than allowed, or more time than is left.
        """
        if cost.memory > self.memory:
            raise NotAffordableError(
                f"not tried: {what} would take about {cost.memory / GIGABYTE:.2g} GB of memory, "
                f"and {self.memory / GIGABYTE:.3g} GB are allowed (--memory)"
            )
        if cost.seconds > self.unplanned:
            raise NotAffordableError(
                f"not tried: {what} would take about {cost.seconds:.2g} s, and "
                f"{self.unplanned:.2g} s of the budget of {self.total:g} s are left (--budget)"
            )
        self.check()
