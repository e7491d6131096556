"""Provable numbers of a design in floating point, and their slopes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp, log
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import search_limits
from nrs_design.pipeline.free_gains import Array, FreeGains
from nrs_design.progress import Progress
from nrs_design.search.work import Allowance, Fuse, NotAffordableError

if TYPE_CHECKING:
    from nrs_design.design.trust_region import Evaluation
    from nrs_design.proof.system import SwitchedSystem
    from nrs_design.spec.goals import GoalsSpec

STEP = 1e-3  # How far a coordinate moves for a slope
NOTHING = -1e4  # The value where floating point finds no number
LEAST_RATE = 1e-2  # Least decay rate, 1/s
ROOM = (5e-4, 4e-3)  # Reserve for roundings: of a rate, and of a bound

# Of a system, about what is expected, and what it may take: what is found; None if nothing is.
Find = Callable[["SwitchedSystem", "float | None", Allowance], "ConstraintValue | None"]


@dataclass(frozen=True)
class ConstraintValue:
    """A number of a design, held against what is wanted."""

    value: float  # Not negative if met; one is the scale
    change: Callable[[SwitchedSystem], float]  # Change of the value for a system nearby
    said: str  # The number, for people


@dataclass(frozen=True)
class ProofConstraint:
    """A number that a proof is to show."""

    key: str  # Key of the goal
    title: str  # For people
    unit: str
    find: Find
    number: Callable[[float], float]  # Number for a value, in SI units


def rate_constraint(goal: float, scale: float) -> ProofConstraint:
    """Return the constraint on the best decay rate of one form for all modes, in 1/s.

    `wanted` has room for roundings; the scale is what a value of one is.
    """

    def number(value: float) -> float:
        return value * scale + goal

    def find(
        system: SwitchedSystem, expected: float | None, allowance: Allowance
    ) -> ConstraintValue | None:
        """Bracket the rate, from about what is expected."""
        from nrs_design.search.rate_slope import rate_slope

        guess = None if expected is None else number(expected)
        found = rate_slope(system, guess, allowance, wanted=goal)
        if found is None:
            return None
        return ConstraintValue(
            (found.rate - goal) / scale,
            lambda system: found.change(system) / scale,
            f"decay rate {found.rate:.4g} 1/s",
        )

    return ProofConstraint("decay_rate", "decay rate", "1/s", find, number)


def force_constraint(wanted: float) -> ProofConstraint:
    """Return the constraint on the least bound on the force, in N m, under all disturbances."""
    share: float | None = None  # Best share of the disturbances in the last solution

    def find(
        system: SwitchedSystem, expected: float | None, allowance: Allowance
    ) -> ConstraintValue | None:
        """Solve for a few shares, near the one that was the best."""
        nonlocal share
        from nrs_design.search.rate_slope import force_slope

        output = next(output for output in system.outputs if output.name == "force")
        found = force_slope(system, output, allowance, share)
        if found is None:
            return None
        share = found.share
        return ConstraintValue(
            log(wanted / found.level),
            lambda system: -found.change(system),
            f"force up to {found.level:.4g}",
        )

    return ProofConstraint(
        "peak_torque", "bound on the force", "N*m", find, lambda value: wanted * exp(-value)
    )


def constraints_of(
    goals: GoalsSpec | None, room: float = 0.0, room_of_bounds: float = 0.0
) -> tuple[ProofConstraint, ...]:
    """Return the constraints of the goals, the decay first.

    So much more is asked for of a rate, as a share, and so much less of a bound.
    """
    rate = None if goals is None else goals.decay_rate
    lowest = LEAST_RATE if rate is None else max(rate.si * (1 + room), LEAST_RATE)
    decay = rate_constraint(lowest, max(lowest, 1.0))
    if goals is None or goals.peak_torque is None:
        return (decay,)
    return decay, force_constraint(goals.peak_torque.si * (1 - room_of_bounds))


def evaluator(
    gains: FreeGains, constraints: Sequence[ProofConstraint], progress: Progress
) -> Callable[[Array, Array | None], Evaluation]:
    """Return what evaluates a design under several constraints, about what is expected of them.

    Its Jacobian is found only where it is asked for.
    """
    from nrs_design.design.trust_region import Evaluation

    limits = search_limits(gains.designed.spec)
    allowance = Allowance(limits.budget, limits.memory, Fuse.of(limits.budget))

    def value(
        constraint: ProofConstraint, system: SwitchedSystem, expected: float | None
    ) -> ConstraintValue:
        try:
            found = constraint.find(system, expected, allowance)
        except NotAffordableError as error:
            raise DesignError(
                f"no gains were found: {error}", remedy="allow more with certification.budget"
            ) from error
        return found or ConstraintValue(NOTHING, lambda system: 0.0, f"no {constraint.title}")

    def evaluate(x: Array, expected: Array | None) -> Evaluation:
        system = gains.system(x)
        guesses = [None] * len(constraints) if expected is None else [*map(float, expected)]
        found = [value(one, system, guess) for one, guess in zip(constraints, guesses, strict=True)]
        progress(f"{', '.join(one.said for one in found)} at cost {gains.cost(x):.5g}")

        def jacobian() -> Array:
            systems = []
            for i in range(len(x)):
                step = -STEP if x[i] + STEP > gains.high[i] else STEP
                neighbor = gains.system(x + step * np.eye(len(x))[i])
                systems.append([one.change(neighbor) / step for one in found])
            return np.array(systems).T

        return Evaluation(x, np.array([one.value for one in found]), jacobian)

    return evaluate
