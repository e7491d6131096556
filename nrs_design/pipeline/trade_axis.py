"""An objective as one more coordinate behind the gains, to be as large as can be proved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from math import exp, log
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.design.objective import Objective
from nrs_design.errors import DesignError
from nrs_design.pipeline.free_gains import Array, FreeGains
from nrs_design.pipeline.proof_constraints import (
    ROOM,
    ProofConstraint,
    constraints_of,
    force_constraint,
)
from nrs_design.pipeline.stability_map import as_stiff
from nrs_design.pipeline.trade_point import noises

if TYPE_CHECKING:
    from nrs_design.models.plant import Plant
    from nrs_design.pipeline.design import Designed
    from nrs_design.spec.quantity_fields import RangedQuantity

# Upper ends of stiffness are looked for up to so many times the declared ones.
WIDEST = 64.0
# Logarithm of the least factor between the ends of a stiffness.
LEAST_WIDTH = 1e-3
# Rates are looked for up to this one, 1/s.
FASTEST = 1e4
# Bounds on force and noise are looked for up to this factor on those of one SI unit.
LARGEST = 1e6


@dataclass(frozen=True)
class TradeAxis:
    """How much of an objective is asked for, as a coordinate y.

    That is the logarithm of the factor on the upper ends of stiffness; the rate over its scale;
    minus the logarithm of a bound on the force, or of the noise.
    """

    objective: Objective
    low: float
    high: float
    constraints: tuple[ProofConstraint, ...]
    taken: tuple[float, ...]  # What y takes from the value of each constraint
    # The plant at y, if it is not that of the spec.
    plant: Callable[[float], Plant | None] = field(default=lambda y: None)
    # Constraints on gains and y that are quick: not negative where they are met.
    quick: Callable[[Array, float], list[float]] = field(default=lambda x, y: [])

    @property
    def stretches(self) -> bool:
        """Whether y changes the plant."""
        return self.objective is Objective.STIFFNESS

    def start(self, values: Array) -> float:
        """Return where y begins, from the values of the constraints at y = 0.

        Parameters
        ----------
        values : ndarray
            Of the free optimum.
        """
        if self.objective is Objective.PEAK_TORQUE:
            return float(np.clip(values[self.taken.index(1.0)], self.low, self.high))
        return float(np.clip(0.0, self.low, self.high))


def trade_axis(gains: FreeGains, objective: Objective) -> TradeAxis:
    """Return the coordinate of an objective.

    Parameters
    ----------
    gains : FreeGains
        With the spec, whose goals are asked for as well.
    objective : Objective
        Not the delay, whose ages are counted.

    Raises
    ------
    DesignError
        If the spec lacks what it is about.
    """
    goals = gains.designed.spec.goals
    asked = constraints_of(goals, *ROOM)
    nothing = (0.0,) * len(asked)
    match objective:
        case Objective.STIFFNESS:
            return _stiffness(gains, asked)
        case Objective.DECAY_RATE:
            most = FASTEST / asked[0].one
            return TradeAxis(objective, -most, most, asked, (1.0, *nothing[1:]))
        case Objective.PEAK_TORQUE:
            check_objective(gains.designed, objective)
            limit = None if goals is None else goals.peak_torque
            low = -log(LARGEST) if limit is None else -log(limit.si * (1 - ROOM[1]))
            own = (asked[0], force_constraint(1.0))
            return TradeAxis(objective, low, log(LARGEST), own, (0.0, 1.0))
        case Objective.NOISE:
            check_objective(gains.designed, objective)

            def quieter(x: Array, y: float) -> list[float]:
                return [-log(noise) - y for noise in noises(gains.designed, gains.gains(x))]

            ends = -log(LARGEST), log(LARGEST)
            return TradeAxis(objective, *ends, asked, nothing, quick=quieter)
        case Objective.DELAY:
            raise ValueError("ages of the force are counted, and no coordinate")


def _stiffness(gains: FreeGains, asked: tuple[ProofConstraint, ...]) -> TradeAxis:
    touched = gains.designed.plant.among(gains.designed.design.contacts)
    contacts = tuple((e.name, e.stiffness.low, e.stiffness.high) for e in touched)
    # The nominal stiffness, which the cost is of, stays within, and a range keeps its two ends, as
    # modes are one for each.
    softest = max(float(e.stiffness.nominal / e.stiffness.high) for e in touched)
    low = log(softest) + LEAST_WIDTH

    def plant(y: float) -> Plant:
        return as_stiff(gains.designed.plant, contacts, Fraction(exp(max(y, low))))

    taken = (0.0,) * len(asked)
    return TradeAxis(Objective.STIFFNESS, low, log(WIDEST), asked, taken, plant)


def check_objective(designed: Designed, objective: Objective) -> None:
    """Refuse an objective that a spec says nothing about.

    Parameters
    ----------
    designed : Designed
        The spec.
    objective : Objective
        What is to be traded for.

    Raises
    ------
    DesignError
        If it is.
    """
    spec = designed.spec
    if objective is Objective.STIFFNESS:
        stretchable(designed)
    if objective in (Objective.DELAY, Objective.NOISE) and spec.sampling is None:
        raise DesignError(
            f"{objective} is of samples of the force, and the spec has none",
            remedy="add `sampling: {period: 2 ms, delay: [0, 1]}`, or leave it out of --objectives",
            at=("controllers",),
        )
    if objective is Objective.PEAK_TORQUE and (
        spec.disturbances is None or not spec.disturbances.bounds()
    ):
        raise DesignError(
            "peak-torque is a bound under disturbances, and the spec names none",
            remedy="add `disturbances: {command: 8 deg/s}`, or leave it out of --objectives",
            at=("controllers",),
        )


def stretchable(designed: Designed) -> tuple[tuple[str, RangedQuantity], ...]:
    """Return the contacts, each with what the spec says of its stiffness.

    Raises
    ------
    DesignError
        If one of them has no single stiffness.
    """
    touched = designed.plant.among(designed.design.contacts)
    given = []
    for environment in touched:
        spec = designed.spec.environments.get(environment.name)
        stiffness = getattr(spec, "stiffness", None)
        if environment.parts or environment.preloaded or stiffness is None:
            raise DesignError(
                f"the environment {environment.name} has no stiffness of its own to stretch",
                remedy="use contacts of one spring, touched one at a time and without a preload",
                at=("environments", environment.name),
            )
        given.append((environment.name, stiffness))
    return tuple(given)
