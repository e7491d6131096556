"""Least squares over one law and one record, without its offsets.

Offsets, the position of contact, force in air and drift, add to the force in proportion, so that
they are eliminated: force, simulation and derivatives are taken less their projection on them
(variable projection, Golub and Pereyra 1973).

For a law that is linear in its deflection, position and force in air are constants that add to the
force: one in air and one in contact. Where a record has no air, only their sum shows.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from nrs_design.identification.numeric import Array, Flags, column_sizes, reject
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import (
    AbstractContactLaw,
    AbstractLinearLaw,
    AbstractNonlinearLaw,
)
from nrs_design.models.contact.hunt_crossley import LARGEST_EXPONENT, LEAST_EXPONENT
from nrs_design.models.contact.law import DAMPING, STIFFNESS
from nrs_design.models.contact.motion import Motion

# A coefficient that the linear fit would make zero or negative starts at this part of its scale.
_FLOOR = 1e-3
# Bounds of a stiffness relative to its scale. Bounds of a damping relative to stiffness times step,
# and to stiffness times duration.
_STIFFNESS_BOX = 1e4
_SHORTEST, _LONGEST = 1e-4, 1e3
# Difference in the logarithm of a parameter.
_STEP = 1e-6
# First guesses of the position of contact, in travels of the record.
_SHIFTS = (0.0, 0.01, -0.01, 0.04, -0.04, 0.15, -0.15, 0.4, -0.4)
ZERO, TARE, CONTACT, DRIFT = "zero", "tare", "contact", "drift"


def place_offsets(
    law: AbstractContactLaw, trial: Trial, fitted: dict[str, float], shift: float | None
) -> dict[str, float]:
    """Turn fitted constants into the position of contact, the tare and its drift, in SI.

    Without air, the position is the one at which the tare is zero, and there is no tare. A law that
    keeps no force has no position.
    """
    places = {name: trial.side * fitted[name] for name in (TARE, DRIFT) if name in fitted}
    if shift is not None:
        return {ZERO: trial.reference + trial.side * shift, **places}
    unit_motion = Motion(np.array([0.0, 1.0]), np.ones(2))
    if not (stiffness := float(law.simulate(unit_motion)[0])):
        return places
    if trial.contact is None:
        del places[TARE]
    constant = fitted.get(CONTACT, fitted[TARE])
    return {ZERO: trial.reference - trial.side * constant / stiffness, **places}


def scan(
    kind: type[AbstractContactLaw], trial: Trial, offsets: Array
) -> Iterator[AbstractContactLaw]:
    """Yield candidates for the start of a search.

    Every law is linear in its stiffnesses and dampings once its time constant or exponent is fixed:
    a scan over that one number, with a linear fit at each, finds all valleys of the cost.
    """
    basis = np.linalg.qr(offsets)[0]
    force = reject(basis, trial.measured)
    floor = _FLOOR * float(np.linalg.norm(force))

    def solve(*regressors: Array) -> tuple[float, ...]:
        """Fit positive coefficients: least squares, what comes out too small is lifted."""
        X = reject(basis, np.column_stack([regressor[trial.fit_mask] for regressor in regressors]))
        size = column_sizes(X)
        scaled = np.linalg.lstsq(X / size, force, rcond=None)[0]
        if (scaled < floor).any() and len(size) > 1:
            # Without the offending terms, as a nonnegative fit would have it.
            projections = (X / size).T @ force
            scaled = np.where(scaled < floor, 0.0, np.maximum(projections, floor))
        return tuple((np.maximum(scaled, floor) / size).tolist())

    return kind.guesses(trial.motion, solve)


def box(kind: type[AbstractContactLaw], trial: Trial) -> tuple[Array, Array]:
    """Return the bounds of the logarithms of the parameters.

    They are so wide that only a parameter which the record does not determine reaches them; the
    exponent is kept between 1.1 and 1.3 as in thesis 2.5.
    """
    k = trial.span / float(np.ptp(trial.deflection))
    stiffness = (k / _STIFFNESS_BOX, k * _STIFFNESS_BOX)
    damping = (k * trial.step * _SHORTEST, k * trial.duration * _LONGEST)
    depth = float(np.max(np.abs(trial.deflection)))
    power = depth ** (LEAST_EXPONENT - 1), depth**LARGEST_EXPONENT
    bounds = {
        STIFFNESS: stiffness,
        DAMPING: damping,
        "power stiffness": (stiffness[0] / power[0], stiffness[1] / power[0]),
        "power damping": (damping[0] / power[1], damping[1] / power[1]),
        "exponent": (LEAST_EXPONENT, LARGEST_EXPONENT),
    }
    low, high = np.log([bounds[kind] for kind in kind.kinds]).T
    return low, high


@dataclass(frozen=True)
class LeastSquaresProblem:
    """Least squares over one law and one trial."""

    kind: type[AbstractContactLaw]
    trial: Trial

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the offsets in the fit."""
        kind, trial = self.kind, self.trial
        keeps_force = issubclass(kind, AbstractLinearLaw) and kind.has_rest
        constants = (TARE, CONTACT) if keeps_force and trial.contact is not None else (TARE,)
        return (*constants, DRIFT) if trial.drift else constants

    @cached_property
    def offset_columns(self) -> Array:
        """Force that a unit of each offset adds to all samples, shape (n, m)."""
        trial = self.trial
        columns = {
            TARE: np.ones(len(trial.fit_mask)),
            CONTACT: trial.touching.astype(float),
            DRIFT: trial.motion.time - trial.motion.time[0],
        }
        return np.column_stack([columns[name] for name in self.names])

    @cached_property
    def offsets(self) -> Array:
        """The columns of the offsets in the used samples."""
        return self.offset_columns[self.trial.fit_mask]

    @cached_property
    def begins(self) -> tuple[slice, ...]:
        """Stretches with an unknown initial state, for a law with memory."""
        has_memory = issubclass(self.kind, AbstractLinearLaw) and self.kind.has_memory
        return self.trial.unrested if has_memory else ()

    @cached_property
    def travel(self) -> float:
        """Range of the deflection, m (rad)."""
        return float(np.ptp(self.trial.motion.deflection))

    @property
    def no_shift(self) -> Array:
        """The move of the zero at a start, a number if it is fitted and enters nonlinearly."""
        return np.zeros(int(not issubclass(self.kind, AbstractLinearLaw)))

    def starts(self) -> Iterator[Point]:
        """Yield points to start from, with the position of contact here and there."""
        for shift in _SHIFTS if len(self.no_shift) else (0.0,):
            trial = self.trial
            if shift:
                trial = replace(trial, motion=self.position.translate(shift * self.travel))
            for law in scan(self.kind, trial, self.offsets):
                yield Point(self, np.append(np.log(law.values), self.no_shift + shift))

    @cached_property
    def position(self) -> Motion:
        """The probe, in air too."""
        return Motion(self.trial.motion.time, self.trial.position)

    @cached_property
    def contact_samples(self) -> Flags:
        """Samples in contact; also the insertion, if the position of contact is fitted."""
        if not len(self.no_shift):
            return self.trial.touching
        return np.asarray(self.trial.touching | (self.position.velocity > 0))

    @cached_property
    def ages(self) -> Array:
        """Time in s since its stretch began, for every sample, used or not; 0 elsewhere."""
        time = self.trial.motion.time
        ages = np.zeros(len(time))
        for rows in self.begins:
            ages[rows] = time[rows] - time[rows.start]
        return ages


@dataclass(frozen=True, eq=False)
class Point:
    """A law with a position of contact; each derived quantity is computed once."""

    problem: LeastSquaresProblem  # With n used samples
    # Shape (p,). Logarithms of the parameters, and the move of the zero in travels of the record.
    values: Array

    @cached_property
    def law(self) -> AbstractContactLaw:
        """The law."""
        kind = self.problem.kind
        return kind(*np.exp(self.values[: len(kind.kinds)]).tolist())

    @property
    def shift(self) -> float:
        """The move of the zero in m (rad)."""
        moves = self.values[len(self.problem.kind.kinds) :]
        return float(moves[0]) * self.problem.travel if len(moves) else 0.0

    @cached_property
    def motion(self) -> Motion:
        """The deflection from the moved zero."""
        shift = self.shift
        return self.problem.position.translate(shift) if shift else self.problem.trial.motion

    @cached_property
    def force(self) -> Array:
        """Force of the law in the used samples, shape (n,)."""
        return self._pushing(self.law.simulate(self.motion))[self.problem.trial.fit_mask]

    def _pushing(self, values: Array) -> Array:
        """Return a force, or its derivatives, without what a surface that nothing touches has."""
        values[~self.problem.contact_samples] = 0.0
        return values

    @cached_property
    def states(self) -> Array:
        """Free response of each stretch with an unknown initial state, shape (n, s).

        The force of a relaxing element at the beginning is not known; it fades exponentially.
        """
        return self._fading[self.problem.trial.fit_mask]

    @cached_property
    def _fading(self) -> Array:
        """The same in all samples."""
        problem, tau = self.problem, self.law.relaxation_time
        states = np.zeros((len(problem.ages), len(problem.begins)))
        for column, rows in zip(states.T, problem.begins, strict=True):
            column[rows] = np.exp(-problem.ages[rows] / tau) if tau else 0.0
        return states

    @cached_property
    def constants(self) -> Array:
        """All that adds to the force in proportion: offsets, then states."""
        return np.column_stack([self.problem.offsets, self.states])

    @cached_property
    def _factors(self) -> tuple[Array, Array]:
        """An orthonormal basis of them, and a triangle."""
        basis, triangle = np.linalg.qr(self.constants)
        return np.asarray(basis), np.asarray(triangle)

    @cached_property
    def _error(self) -> Array:
        return self.problem.trial.measured - self.force

    @cached_property
    def best(self) -> Array:
        """The best constants; the smallest ones if the columns are dependent."""
        basis, triangle = self._factors
        cutoff = len(basis) * np.finfo(float).eps
        return np.asarray(np.linalg.pinv(triangle, rcond=cutoff) @ (basis.T @ self._error))

    @property
    def residuals(self) -> Array:
        """The error with the best constants, shape (n,)."""
        return np.asarray(self._error - self.constants @ self.best)

    @cached_property
    def misfit(self) -> Array:
        """Error orthogonal to all constants: the residuals, if the columns are independent."""
        return reject(self._factors[0], self._error)

    @cached_property
    def cost(self) -> float:
        """The mean squared error with the best constants."""
        return float(self.misfit @ self.misfit) / len(self.misfit)

    @property
    def slopes(self) -> Array:
        """The derivatives of the force at constants that follow (Kaufman 1975)."""
        return reject(self._factors[0], self.sensitivities)

    @cached_property
    def sensitivities(self) -> Array:
        """The derivatives by the logarithms, and by the move of the zero in m (rad)."""
        law, motion = self.law, self.motion
        J = law.sensitivities(motion)
        if len(self.values) > len(law.kinds):
            assert isinstance(law, AbstractNonlinearLaw)
            J = np.column_stack([J, -law.slope(motion)])
        J = self._pushing(J)[self.problem.trial.fit_mask]
        return J + self._growing() if self.problem.begins else J

    def _growing(self) -> Array:
        """Return the derivatives of the initial states, which decay at the rate of the law."""
        problem, tau = self.problem, self.law.relaxation_time
        if not tau:
            return np.zeros((len(self.force), len(self.values)))
        # A state exp(-t/tau) grows by t/tau exp(-t/tau) with the logarithm of tau.
        grows = (
            problem.ages[problem.trial.fit_mask]
            / tau
            * (self.states @ self.best[problem.offsets.shape[1] :])
        )
        laws = (Point(problem, self.values + step).law for step in _STEP * np.eye(len(self.values)))
        slopes = [math.log((law.relaxation_time or tau) / tau) / _STEP for law in laws]
        return np.outer(grows, slopes)

    @property
    def whole_force(self) -> Array:
        """The force in all samples, used or not, with its tare."""
        # Stretches without a used sample have no state of their own.
        constants = np.column_stack([self.problem.offset_columns, self._fading])
        return self._pushing(self.law.simulate(self.motion)) + constants @ self.best
