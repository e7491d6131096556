"""What a proof would show of a design, in floating point, and how that changes with the gains."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from math import log, sqrt
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import search_limits
from nrs_design.pipeline.free_gains import Array, FreeGains
from nrs_design.progress import Progress
from nrs_design.work import Allowance, Fuse, NotAffordableError

if TYPE_CHECKING:
    from nrs_design.design.trust_region import Evaluation
    from nrs_design.models.plant import Plant
    from nrs_design.proof.system import SwitchedSystem

# How far a coordinate moves for a slope.
STEP = 1e-3
# The value where floating point finds no number.
NOTHING = -1e4


@dataclass(frozen=True)
class ConstraintValue:
    """A number of a design, held against what is wanted."""

    value: float  # Not negative where it is met; one is what is wanted
    change: Callable[[SwitchedSystem], float]  # By how much it is larger for a system nearby
    said: str  # The number, for people


@dataclass
class AbstractProofConstraint(ABC):
    """A number that a proof is to show."""

    key: ClassVar[str]  # Of the goal
    title: ClassVar[str]  # For people
    unit: ClassVar[str]

    @abstractmethod
    def value(
        self, system: SwitchedSystem, expected: float | None, allowance: Allowance
    ) -> ConstraintValue | None:
        """Return the number; None if floating point finds none.

        Parameters
        ----------
        system : SwitchedSystem
            Of the design.
        expected : float or None
            About what the value is.
        allowance : Allowance
            Work and memory.

        Raises
        ------
        NotAffordableError
            If work or memory do not suffice.
        """

    @abstractmethod
    def number(self, value: float) -> float:
        """Return the number that a value stands for, in SI units."""

    @property
    @abstractmethod
    def one(self) -> float:
        """By how much more a number is asked for where the value is one less, in SI units."""


@dataclass
class RateConstraint(AbstractProofConstraint):
    """The best decay rate of one form for all modes."""

    key: ClassVar[str] = "decay_rate"
    title: ClassVar[str] = "decay rate"
    unit: ClassVar[str] = "1/s"

    wanted: float  # 1/s, with its room
    scale: float  # What a value of one is, 1/s

    def value(
        self, system: SwitchedSystem, expected: float | None, allowance: Allowance
    ) -> ConstraintValue | None:
        """Bracket the rate, from about what is expected.

        Parameters
        ----------
        system, expected, allowance
            As for `AbstractProofConstraint`.
        """
        from nrs_design.search.rate_slope import rate_slope

        guess = None if expected is None else self.number(expected)
        found = rate_slope(system, guess, allowance)
        if found is None:
            return None
        return ConstraintValue(
            (found.rate - self.wanted) / self.scale,
            lambda system: found.change(system) / self.scale,
            f"decay rate {found.rate:.4g} 1/s",
        )

    def number(self, value: float) -> float:
        """Return the rate in 1/s."""
        return value * self.scale + self.wanted

    @property
    def one(self) -> float:
        """The scale, 1/s."""
        return self.scale


@dataclass
class ForceConstraint(AbstractProofConstraint):
    """The least bound on the force under all disturbances."""

    key: ClassVar[str] = "peak_torque"
    title: ClassVar[str] = "bound on the force"
    unit: ClassVar[str] = "N*m"

    wanted: float  # N m, with its room
    share: float | None = field(default=None, init=False)  # That was the best last time

    def value(
        self, system: SwitchedSystem, expected: float | None, allowance: Allowance
    ) -> ConstraintValue | None:
        """Solve for a few shares, near the one that was the best.

        Parameters
        ----------
        system, expected, allowance
            As for `AbstractProofConstraint`.
        """
        from nrs_design.search.force_slope import force_slope

        output = next(output for output in system.outputs if output.name == "force")
        found = force_slope(system, output, allowance, self.share)
        if found is None:
            return None
        self.share = found.share
        level = found.level * sqrt(system.axes or 1)
        return ConstraintValue(
            log(self.wanted / level),
            lambda system: -found.change(system),
            f"force up to {level:.4g}",
        )

    def number(self, value: float) -> float:
        """Return the bound in N m."""
        return self.wanted * float(np.exp(-value))

    @property
    def one(self) -> float:
        """The bound itself, as values are logarithms, N m."""
        return self.wanted


@dataclass(frozen=True)
class DesignEvaluator:
    """Evaluates designs under several constraints."""

    gains: FreeGains
    constraints: tuple[AbstractProofConstraint, ...]
    progress: Progress
    allowance: Allowance

    @classmethod
    def of(
        cls, gains: FreeGains, constraints: tuple[AbstractProofConstraint, ...], progress: Progress
    ) -> DesignEvaluator:
        """Take work and memory from the spec.

        Parameters
        ----------
        gains, constraints, progress
            As for the class.
        """
        limits = search_limits(gains.designed.spec)
        allowance = Allowance(limits.budget, limits.memory, Fuse.of(limits.budget))
        return cls(gains, constraints, progress, allowance)

    def evaluate(
        self,
        x: Array,
        expected: Array | None,
        plant: Callable[[Array], Plant | None] = lambda x: None,
    ) -> Evaluation:
        """Evaluate a design; its Jacobian only where it is asked for.

        Parameters
        ----------
        x : ndarray
            The point; what is behind the gains is for the plant.
        expected : ndarray or None
            About what comes of it.
        plant : callable
            Gives the plant at a point, if it is not that of the spec.

        Raises
        ------
        DesignError
            If work or memory do not suffice.
        """
        from nrs_design.design.trust_region import Evaluation

        gains, n = self.gains, len(self.gains.coordinates)

        def system(x: Array) -> SwitchedSystem:
            return gains.system(x[:n], plant(x))

        here = system(x)
        found = [
            self._value(constraint, here, None if expected is None else float(expected[k]))
            for k, constraint in enumerate(self.constraints)
        ]
        said = ", ".join(one.said for one in found)
        self.progress(f"{said} at cost {gains.cost(x[:n]):.5g}")

        def jacobian() -> Array:
            moved = []
            for i in range(len(x)):
                step = -STEP if i < n and x[i] + STEP > gains.high[i] else STEP
                there = system(x + step * np.eye(len(x))[i])
                moved.append([one.change(there) / step for one in found])
            return np.array(moved).T

        return Evaluation(x, np.array([one.value for one in found]), jacobian)

    def _value(
        self, constraint: AbstractProofConstraint, system: SwitchedSystem, expected: float | None
    ) -> ConstraintValue:
        try:
            found = constraint.value(system, expected, self.allowance)
        except NotAffordableError as error:
            raise DesignError(
                f"no gains were found: {error}", remedy="allow more with certification.budget"
            ) from error
        return found or ConstraintValue(NOTHING, lambda system: 0.0, f"no {constraint.title}")
