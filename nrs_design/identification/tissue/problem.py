"""Least squares over one law and one record, without its offsets.

Offsets add to the force in proportion, so that they are eliminated: force, simulation and
derivatives are taken less their projection on the offsets (variable projection, Golub and Pereyra
1973).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.tissue.offsets import (
    fits_zero,
    measured,
    offset_columns,
    offset_names,
)
from nrs_design.identification.tissue.starts import scan
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import LINEAR_LAWS, AbstractContactLaw, AbstractNonlinearLaw, Motion

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

# Of a difference in the logarithm of a parameter.
_STEP = 1e-6
# Where the position of contact is first sought, in travels of the record.
_SHIFTS = (0.0, 0.01, -0.01, 0.04, -0.04, 0.15, -0.15, 0.4, -0.4)


@dataclass(frozen=True)
class Problem:
    """Least squares over one law and one trial; a point is logarithms, and the move of the zero."""

    kind: type[AbstractContactLaw]
    trial: Trial

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Which offsets are fitted."""
        return offset_names(self.kind, self.trial)

    @cached_property
    def offsets(self) -> Array:
        """What a unit of each offset adds to the force, shape (n, m)."""
        return offset_columns(self.names, self.trial)

    @cached_property
    def _begins(self) -> tuple[slice, ...]:
        remembers = any(law is self.kind and law.remembers for law in LINEAR_LAWS.values())
        return self.trial.unrested if remembers else ()

    @cached_property
    def _basis(self) -> Array:
        return np.linalg.qr(self.offsets)[0]

    @cached_property
    def force(self) -> Array:
        """Measured force, less a tare that is given, shape (n,)."""
        return measured(self.trial)

    @cached_property
    def travel(self) -> float:
        """Range of the deflection, m (rad)."""
        return float(np.ptp(self.trial.motion.deflection))

    @property
    def no_shift(self) -> Array:
        """The move of the zero at a start: one number, or none for a law without it."""
        return np.zeros(int(fits_zero(self.kind, self.trial)))

    def starts(self) -> Iterator[Array]:
        """Yield points to start from, with the position of contact here and there."""
        for shift in _SHIFTS if len(self.no_shift) else (0.0,):
            trial = self.trial
            if shift:
                trial = replace(trial, motion=trial.shifted(shift * self.travel))
            for law in scan(self.kind, trial, self.offsets):
                yield np.append(np.log(law.values), self.no_shift + shift)

    def states(self, point: Array) -> Array:
        """Return what each stretch that does not begin at rest has left of its beginning, (n, s).

        The force of a relaxing element at the beginning is not known; it fades exponentially.
        """
        return self._all_states(point)[self.trial.used]

    def _all_states(self, point: Array) -> Array:
        tau = self.law(point).relaxation_time
        columns = np.zeros((len(self.trial.force), len(self._begins)))
        time = self.trial.motion.time
        for column, rows in zip(columns.T, self._begins, strict=True):
            column[rows] = np.exp(-(time[rows] - time[rows.start]) / tau) if tau else 0.0
        return columns

    def constants(self, point: Array) -> Array:
        """Return all that adds to the force in proportion: offsets, then states."""
        if not self._begins:
            return self.offsets
        return np.column_stack([self.offsets, self.states(point)])

    def basis(self, point: Array) -> Array:
        """Return an orthonormal basis of the constants."""
        return np.linalg.qr(self.constants(point))[0] if self._begins else self._basis

    def left(self, point: Array) -> Array:
        """Return the error with the best constants."""
        error = self.force - self.simulate(point)
        basis = self.basis(point)
        return np.asarray(error - basis @ (basis.T @ error))

    def slopes(self, point: Array) -> Array:
        """Return the derivatives of the force at constants that follow (Kaufman 1975)."""
        J, basis = self.sensitivities(point), self.basis(point)
        return np.asarray(J - basis @ (basis.T @ J))

    def law(self, point: Array) -> AbstractContactLaw:
        """Return the law at a point."""
        return self.kind(*np.exp(point[: len(self.kind.kinds)]).tolist())

    def shift(self, point: Array) -> float:
        """Return the move of the zero in m (rad)."""
        moves = point[len(self.kind.kinds) :]
        return float(moves[0]) * self.travel if len(moves) else 0.0

    def motion(self, point: Array) -> Motion:
        """Return the deflection from the moved zero."""
        shift = self.shift(point)
        return self.trial.shifted(shift) if shift else self.trial.motion

    def simulate(self, point: Array) -> Array:
        """Return the force of the law in the used samples, shape (n,)."""
        return self._pushing(self.law(point).simulate(self.motion(point)))[self.trial.used]

    @cached_property
    def _reached(self) -> Flags:
        """Samples in contact; where its position is sought, the way in to it, too."""
        trial = self.trial
        if not len(self.no_shift):
            return trial.touching
        way_in = np.gradient(trial.position, trial.motion.time) > 0
        return np.asarray(trial.touching | way_in)

    def _pushing(self, values: Array) -> Array:
        """Return a force, or its derivatives, without what a surface that nothing touches has."""
        values[~self._reached] = 0.0
        return values

    def sensitivities(self, point: Array) -> Array:
        """Return the derivatives by the logarithms, and by the move of the zero in m (rad)."""
        law, motion = self.law(point), self.motion(point)
        J = law.sensitivities(motion)
        if len(point) > len(self.kind.kinds):
            assert isinstance(law, AbstractNonlinearLaw)
            J = np.column_stack([J, -law.slope(motion)])
        J = self._pushing(J)[self.trial.used]
        return J + self._fading(point) if self._begins else J

    def _fading(self, point: Array) -> Array:
        """Return what the states add to the derivatives: they fade at the rate of the law."""
        values = self.solve(point)[0][self.offsets.shape[1] :]
        tau = self.law(point).relaxation_time
        if not tau:
            return np.zeros((len(self.force), len(point)))
        # A state exp(-t/tau) grows by t/tau exp(-t/tau) with the logarithm of tau.
        grows = self.states(point) * self._ages / tau @ values
        slopes = [
            math.log((self.law(moved).relaxation_time or tau) / tau) / _STEP
            for moved in point + _STEP * np.eye(len(point))
        ]
        return np.outer(grows, slopes)

    @cached_property
    def _ages(self) -> Array:
        """Time since each stretch began in the used samples, in s, shape (n, s)."""
        time = self.trial.motion.time
        starts = time[[rows.start for rows in self._begins]]
        return np.asarray(time[self.trial.used, None] - starts)

    def cost(self, point: Array) -> float:
        """Return the mean squared error with the best constants."""
        error = self.left(point)
        return float(error @ error) / len(error)

    def solve(self, point: Array) -> tuple[Array, Array]:
        """Return the best constants and the residuals."""
        rest, columns = self.force - self.simulate(point), self.constants(point)
        constants = np.linalg.lstsq(columns, rest, rcond=None)[0]
        return np.asarray(constants, float), np.asarray(rest - columns @ constants)

    def simulate_all(self, point: Array, constants: Array) -> Array:
        """Return the force in all samples, used or not, with its tare."""
        whole = Problem(self.kind, self.trial.everything())
        # Stretches without a used sample have no state of their own.
        columns = np.column_stack([whole.offsets, self._all_states(point)])
        force = whole.simulate(point) + columns @ constants
        tare = self.trial.preparation.tare
        return force if tare is None else force + self.trial.side * tare
