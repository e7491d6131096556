"""The estimator on the robot: which of two environments is touched, while the axis moves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

from nrs_design.proof.bounds import upper_float
from nrs_design.spec.environment_estimator import EstimatorDecision, EstimatorSpec


@dataclass(frozen=True, slots=True)
class EstimatorState:
    """What the estimator remembers from one step to the next.

    Parameters
    ----------
    stiffer : bool
        Which environment it takes for the one that is touched.
    last : bool
        Which one the last segment spoke for.
    anchor : tuple of (float, float) or None
        Angle in rad and torque in N m at the begin of this segment; None before the first step.
    since : float
        Time since then in s.
    """

    stiffer: bool
    last: bool
    anchor: tuple[float, float] | None = None
    since: float = 0.0


@dataclass(frozen=True, slots=True)
class EnvironmentEstimator:
    """Tells two springs apart by torque over travel; two segments that agree decide.

    Parameters
    ----------
    limit : float
        Stiffness in N m/rad from which on it is the stiffer one.
    travel : float
        Least travel of a segment in rad.
    age : float
        Least duration of a segment in s: the age of the torque.
    """

    limit: float
    travel: float
    age: float

    @classmethod
    def of(cls, estimator: EstimatorSpec, decision: EstimatorDecision) -> Self:
        """Return the estimator that a spec declares, with what is derived for it."""
        age = upper_float(estimator.signals.torque.age.exact)
        return cls(float(decision.limit), upper_float(decision.travel), age)

    def start(self, *, stiffer: bool) -> EstimatorState:
        """Return the state at the start, with a guess."""
        return EstimatorState(stiffer, stiffer)

    def step(
        self, state: EstimatorState, elapsed: float, angle: float, torque: float
    ) -> EstimatorState:
        """Return the next state; its `stiffer` says which controller is to be active.

        Parameters
        ----------
        state : EstimatorState
            After the step before.
        elapsed : float
            Time since then in s.
        angle : float
            Of the axis, measured now, in rad.
        torque : float
            As the estimator sees it, in N m.
        """
        if state.anchor is None:
            return replace(state, anchor=(angle, torque))
        moved, since = angle - state.anchor[0], state.since + elapsed
        if abs(moved) < self.travel or since < self.age:
            return replace(state, since=since)
        found = (torque - state.anchor[1]) / moved >= self.limit
        decided = found if found == state.last else state.stiffer
        return EstimatorState(decided, found, (angle, torque))
