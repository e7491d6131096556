"""One law fitted to one record: the simulated force against the measured one.

Offsets add to the force in proportion, so that they are eliminated: force, simulation and
derivatives are taken less their projection on the offsets (variable projection, Golub and Pereyra
1973), and the search is over the parameters of the law alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.datasets import TissueRecord
from nrs_design.identification.rounding import rounding_scatter
from nrs_design.identification.statistics import (
    CONFIDENCE,
    Estimate,
    Uncertainty,
    uncertainty,
)
from nrs_design.identification.tissue.doubts import doubts
from nrs_design.identification.tissue.offsets import (
    Offset,
    estimate_offsets,
    fits_zero,
    measured,
    offset_columns,
    offset_names,
)
from nrs_design.identification.tissue.starts import box, scan
from nrs_design.identification.tissue.trial import Trial, prepare
from nrs_design.models.contact import LINEAR_LAWS, AbstractContactLaw, HuntCrossley, Motion

Array = NDArray[np.float64]

STARTS = 3
# Samples that suffice to find the right valley.
_COARSE = 4_000
# Starts whose costs end within this factor of the best one have found the same valley.
_SAME = 1e-6
# How far the position of contact is sought from where it was found, in travels of the record.
_REACH = 0.5
# Of a difference in the logarithm of a parameter.
_STEP = 1e-6
_SHIFTS = (0.0, 0.01, -0.01, 0.04, -0.04, 0.15, -0.15, 0.4, -0.4)


@dataclass(frozen=True, slots=True, eq=False)
class RecordFit:
    """A law that fits a record best, and how well it is known.

    Parameters
    ----------
    trial : Trial
        The data as they were fitted.
    law : AbstractContactLaw
        With the fitted parameters.
    offsets : tuple of Offset
        Position of contact, tare and drift.
    fitted : ndarray, shape (n,)
        Force of law and offsets in all samples of the trial.
    uncertainty : Uncertainty
        Of the logarithms of the parameters.
    rmse : float
        Root of the mean squared force error, in N (N m).
    free : int
        Parameters and offsets that were fitted.
    agreeing, starts : int
        How many searches there were, and how many of them ended here.
    doubts : tuple of str
        Why the record may not determine the parameters.
    """

    trial: Trial
    law: AbstractContactLaw
    offsets: tuple[Offset, ...]
    fitted: Array
    uncertainty: Uncertainty
    rmse: float
    free: int
    agreeing: int
    starts: int
    doubts: tuple[str, ...]

    @property
    def record(self) -> TissueRecord:
        """The record as it was read."""
        return self.trial.record

    @property
    def estimates(self) -> tuple[Estimate, ...]:
        """The parameters with their 95 % intervals."""
        return self.estimates_at(CONFIDENCE)

    def estimates_at(self, confidence: float) -> tuple[Estimate, ...]:
        """Return the parameters with intervals of some confidence."""
        return self.uncertainty.estimates(np.log(self.law.values), confidence)

    @property
    def r2(self) -> float:
        """Part of the variance of the force that is explained."""
        return 1 - self.rmse**2 / float(np.var(self.trial.measured))

    @property
    def aic(self) -> float:
        """Akaike's criterion ``n log(SSE/n) + 2 (p + 1)``."""
        return self._fidelity + 2 * self._count

    @property
    def bic(self) -> float:
        """Schwarz's criterion ``n log(SSE/n) + (p + 1) log n``."""
        return self._fidelity + self._count * float(np.log(self._samples))

    @property
    def _samples(self) -> int:
        return int(self.trial.used.sum())

    @property
    def _fidelity(self) -> float:
        return 2 * self._samples * float(np.log(max(self.rmse, np.finfo(float).tiny)))

    @property
    def _count(self) -> int:
        """Parameters, offsets, and the variance of the noise."""
        return self.free + 1


def fit_record(kind: type[AbstractContactLaw], record: TissueRecord | Trial) -> RecordFit:
    """Fit a law by output error.

    Minimizes the squared difference of measured and simulated force over the logarithms of the
    parameters, with offsets of force and deflection. Simulation and derivatives are exact for a
    piecewise linear deflection; the force is never differentiated.

    Parameters
    ----------
    kind : type
        One of `nrs_design.models.contact.LAWS`.
    record : TissueRecord or Trial
        n samples; a record is prepared in the default way.
    """
    trial = record if isinstance(record, Trial) else prepare(record)
    bounds = box(kind, trial)
    problem = _Problem(kind, trial)
    coarse = _Problem(kind, trial.thinned(-(-len(trial.force) // _COARSE)))
    candidates = sorted(coarse.starts(), key=coarse.cost)
    ends = [_search(coarse, start, bounds) for start in candidates[:STARTS]]
    costs = np.array([coarse.cost(end) for end in ends])
    best = int(np.argmin(costs))
    point = ends[best]
    if coarse.trial is not trial:
        point = _search(problem, point, bounds)
    agreeing = int(np.sum(costs <= costs[best] * (1 + _SAME)))
    return _judge(problem, point, bounds, agreeing, len(ends))


def rmse(law: AbstractContactLaw, record: TissueRecord | Trial) -> float:
    """Return the root of the mean squared force error, with the best offsets for this law."""
    trial = record if isinstance(record, Trial) else prepare(record)
    problem = _Problem(type(law), trial)
    point = np.append(np.log(law.values), problem.no_shift)
    if fits_zero(type(law), trial):
        point = _place(problem, point)
    return float(np.sqrt(problem.cost(point)))


def _judge(
    problem: _Problem, point: Array, bounds: tuple[Array, Array], agreeing: int, starts: int
) -> RecordFit:
    trial, law = problem.trial, problem.law(point)
    constants, residuals = problem.solve(point)
    J = np.column_stack([problem.sensitivities(point), problem.constants(point)])
    known = _uncertainty(trial, J, residuals)
    p = len(law.values)
    shift = problem.shift(point) if len(point) > p else None
    offsets = estimate_offsets(
        law, trial, problem.names, constants[: len(problem.names)], shift, known
    )
    own = Uncertainty(known.covariance[:p, :p], known.degrees, known.whiteness)
    said = list(doubts(law, trial, own, bounds, residuals, J))
    if shift is not None and abs(point[p]) > _REACH * (1 - 1e-3):
        said.append("the position of contact is at the end of its box")
    return RecordFit(
        trial=trial,
        law=law,
        offsets=offsets,
        fitted=problem.simulate_all(point, constants),
        uncertainty=own,
        rmse=float(np.sqrt(np.mean(residuals**2))),
        free=J.shape[1],
        agreeing=agreeing,
        starts=starts,
        doubts=tuple(said),
    )


@dataclass(frozen=True)
class _Problem:
    """Least squares over one law and one trial; a point is logarithms, and the move of the zero."""

    kind: type[AbstractContactLaw]
    trial: Trial

    @cached_property
    def names(self) -> tuple[str, ...]:
        return offset_names(self.kind, self.trial)

    @cached_property
    def offsets(self) -> Array:
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
        return measured(self.trial)

    @cached_property
    def travel(self) -> float:
        return float(np.ptp(self.trial.motion.deflection))

    @property
    def no_shift(self) -> Array:
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
        tau = self.law(point).relaxation_time
        columns = np.zeros((len(self.trial.force), len(self._begins)))
        time = self.trial.motion.time
        for column, rows in zip(columns.T, self._begins, strict=True):
            column[rows] = np.exp(-(time[rows] - time[rows.start]) / tau) if tau else 0.0
        return columns[self.trial.used]

    def constants(self, point: Array) -> Array:
        """Return all that adds to the force in proportion: offsets, then states."""
        if not self._begins:
            return self.offsets
        return np.column_stack([self.offsets, self.states(point)])

    def basis(self, point: Array) -> Array:
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
        return self.kind(*np.exp(point[: len(self.kind.kinds)]).tolist())

    def shift(self, point: Array) -> float:
        moves = point[len(self.kind.kinds) :]
        return float(moves[0]) * self.travel if len(moves) else 0.0

    def motion(self, point: Array) -> Motion:
        shift = self.shift(point)
        return self.trial.shifted(shift) if shift else self.trial.motion

    def simulate(self, point: Array) -> Array:
        return self._pushing(self.law(point).simulate(self.motion(point)))[self.trial.used]

    def _pushing(self, values: Array) -> Array:
        """Return a force, or its derivatives, without what a surface that nothing touches has."""
        values[~self.trial.touching] = 0.0
        return values

    def sensitivities(self, point: Array) -> Array:
        """Return the derivatives by the logarithms, and by the move of the zero in m (rad)."""
        law, motion = self.law(point), self.motion(point)
        J = law.sensitivities(motion)
        if len(point) > len(self.kind.kinds):
            assert isinstance(law, HuntCrossley)
            J = np.column_stack([J, -law.slope(motion)])
        J = self._pushing(J)[self.trial.used]
        return J + self._fading(point) if self._begins else J

    def _fading(self, point: Array) -> Array:
        """Return what the states add to the derivatives: they fade at the rate of the law."""
        values = self.solve(point)[0][self.offsets.shape[1] :]
        middle = self.states(point) @ values
        columns = []
        for i in range(len(point)):
            moved = point.copy()
            moved[i] += _STEP
            columns.append((self.states(moved) @ values - middle) / _STEP)
        return np.column_stack(columns)

    def cost(self, point: Array) -> float:
        error = self.left(point)
        return float(error @ error) / len(error)

    def solve(self, point: Array) -> tuple[Array, Array]:
        """Return the best constants and the residuals."""
        rest, columns = self.force - self.simulate(point), self.constants(point)
        constants = np.linalg.lstsq(columns, rest, rcond=None)[0]
        return np.asarray(constants, float), np.asarray(rest - columns @ constants)

    def simulate_all(self, point: Array, constants: Array) -> Array:
        """Return the force in all samples, used or not, with its tare."""
        whole = _Problem(self.kind, self.trial.everything())
        force = whole.simulate(point) + whole.constants(point) @ constants
        tare = self.trial.preparation.tare
        return force if tare is None else force + self.trial.side * tare


def _uncertainty(trial: Trial, J: Array, residuals: Array) -> Uncertainty:
    deflection = trial.deflection
    moving = np.linalg.norm(deflection - deflection.mean())
    stiffness = float(np.linalg.norm(trial.measured - trial.measured.mean()) / moving)
    scatter = rounding_scatter(deflection, J, stiffness)
    return uncertainty(J, residuals, scatter=scatter)


def _place(problem: _Problem, point: Array) -> Array:
    """Return the point with the best position of contact for its law."""
    from scipy.optimize import minimize_scalar

    def at(shift: float) -> Array:
        return np.append(point[:-1], shift)

    grid = np.linspace(-_REACH, _REACH, 41)
    near = float(grid[int(np.argmin([problem.cost(at(shift)) for shift in grid]))])
    step = float(grid[1] - grid[0])
    found = minimize_scalar(
        lambda shift: problem.cost(at(float(shift))),
        bounds=(max(near - step, -_REACH), min(near + step, _REACH)),
        method="bounded",
    )
    return at(float(found.x))


def _search(problem: _Problem, start: Array, bounds: tuple[Array, Array]) -> Array:
    from scipy.optimize import least_squares

    p = len(problem.kind.kinds)
    scale = float(np.std(problem.force)) or 1.0
    reach = np.full(len(start) - p, _REACH)
    low, high = np.append(bounds[0], -reach), np.append(bounds[1], reach)
    # The search needs room around its start.
    room = 1e-6 * (high - low)

    def error(x: Array) -> Array:
        return -problem.left(x) / scale

    def slope(x: Array) -> Array:
        J = problem.slopes(x)
        J[:, p:] *= problem.travel
        return J / scale

    found = least_squares(
        error,
        np.clip(start, low + room, high - room),
        jac=slope,
        bounds=(low, high),
        xtol=1e-10,
        ftol=1e-12,
        gtol=1e-12,
    )
    return np.asarray(found.x)
