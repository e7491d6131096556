"""Budgets of work and memory: work is counted, with equal counts on every machine.

A unit of work is about a second of the machine that the benchmarks name. What is begun, and where a
search ends, is decided by counts alone: factorizations, steps of a solver, matrices, boxes, each
weighted by its size. So what comes of a budget does not depend on how fast the machine is, nor on
what else it does. The clock is but a fuse: it may end all in an error, and shapes no answer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from time import monotonic

from nrs_design.errors import ClockError

GIGABYTE = 1e9
# Fuse of a budget: seconds for each unit of work, and a constant number of seconds.
SECONDS_PER_UNIT, SECONDS_MORE = 10.0, 60.0


class NotAffordableError(Exception):
    """A step that is not begun, or is stopped, for lack of work or memory; says what would help."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Prediction for one step, from sizes alone."""

    work: float  # In units
    memory: float = 0.0  # In bytes
    # Work of each solver step beyond the predicted number of steps, in units.
    per_step: float = 0.0


class Fuse:
    """A clock in s that ends in an error what takes many times as long as it should."""

    def __init__(self, seconds: float = inf, clock: Callable[[], float] | None = None) -> None:
        self._seconds, self._clock = seconds, clock or monotonic
        self._begun = self._clock()

    @classmethod
    def of(cls, budget: float, clock: Callable[[], float] | None = None) -> Fuse:
        """Return the fuse of a budget of work."""
        return cls(SECONDS_PER_UNIT * budget + SECONDS_MORE, clock)

    @property
    def left(self) -> float:
        """Time until it blows, in s."""
        return max(0.0, self._seconds - (self._clock() - self._begun))

    def check(self) -> None:
        """End what takes too long by a `ClockError`."""
        if not self.left:
            raise ClockError(
                f"the clock stopped this after {self._seconds:g} s, before its budget of work was "
                "used up: nothing was decided, and on another machine, or without other load, the "
                "outcome may differ",
                remedy="run it again while less else runs, or with a larger --budget: each unit of "
                f"it allows {SECONDS_PER_UNIT:g} s",
            )


class Allowance:
    """What may still be done: work in units, and memory of a single step in bytes.

    What was done is `charged`. Whenever something is, the fuse is looked at; by default it never
    blows.
    """

    def __init__(
        self,
        work: float = inf,
        memory: float = inf,
        fuse: Fuse | None = None,
        parent: Allowance | None = None,
    ) -> None:
        self.work, self.memory, self.fuse = work, memory, fuse or Fuse()
        self.charged, self._parent = 0.0, parent

    def part(self, share: float) -> Allowance:
        """Return an allowance for a share of the work that is left."""
        return Allowance(share * self.left, self.memory, self.fuse, self)

    @property
    def total(self) -> float:
        """The whole budget that this is a part of."""
        return self.work if self._parent is None else self._parent.total

    @property
    def left(self) -> float:
        """Remaining work, limited by the remaining work of the parent."""
        remainder = max(0.0, self.work - self.charged)
        return remainder if self._parent is None else min(remainder, self._parent.left)

    def charge(self, work: float) -> None:
        """Take work off; raises as `Fuse.check` does."""
        self.fuse.check()
        self._add(work)

    def _add(self, work: float) -> None:
        self.charged += work
        if self._parent is not None:
            self._parent._add(work)

    def goes_on(self, work: float = 0.0) -> bool:
        """Charge one more step, and tell whether there was enough for it."""
        self.charge(work)
        return self.left > 0

    def check(self) -> None:
        """Stop a search whose work is used up by a `NotAffordableError`."""
        if not self.goes_on():
            whole = self._parent is None or not self._parent.goes_on()
            share = "" if whole else "its share of "
            raise NotAffordableError(
                f"stopped: {share}the budget of {self.total:g} is used up (--budget)"
            )

    def affords(self, cost: Cost) -> bool:
        """Tell whether a step is predicted to fit."""
        return cost.memory <= self.memory and cost.work <= self.left

    def take(self, cost: Cost, what: str) -> None:
        """Check that a step fits, and charge it; raises as `require` does."""
        self.require(cost, what)
        self.charge(cost.work)

    def require(self, cost: Cost, what: str) -> None:
        """Check that a step fits before anything is built for it; else a `NotAffordableError`."""
        if cost.memory > self.memory:
            raise NotAffordableError(
                f"not tried: {what} would take about {cost.memory / GIGABYTE:.2g} GB of memory, "
                f"and {self.memory / GIGABYTE:.3g} GB are allowed (--memory)"
            )
        if cost.work > self.left:
            raise NotAffordableError(
                f"not tried: {what} would take about {cost.work:.2g} of work, and "
                f"{self.left:.2g} of the budget of {self.total:g} are left (--budget)"
            )
        self.check()
