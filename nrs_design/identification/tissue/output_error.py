"""One law fitted to one record: the simulated force against the measured one.

The search is over the parameters of the law alone; `problem` eliminates the offsets.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.numeric import TINY, Array, search
from nrs_design.identification.rounding import rounding_scatter
from nrs_design.identification.statistics import (
    CONFIDENCE,
    Estimate,
    Uncertainty,
    student_quantile,
    uncertainty,
)
from nrs_design.identification.tissue.doubts import doubts, reaches_zero
from nrs_design.identification.tissue.problem import LeastSquaresProblem, Point, box, place_offsets
from nrs_design.identification.tissue.trial import Trial, prepare
from nrs_design.models.contact import AbstractContactLaw

STARTS = 3
# Samples that suffice to find the right valley.
COARSE = 2_000
# Relative changes of the cost at which a search ends.
_ROUGHLY, _EXACTLY = 1e-9, 1e-12
# Half width of the search for the position of contact, in travels of the record.
_ZERO_RANGE = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class RecordFit:
    """A law that fits a record best, and how well it is known."""

    trial: Trial  # The prepared data
    law: AbstractContactLaw  # With the fitted parameters
    offsets: dict[str, float]  # Position of contact, tare and drift, as far as they show
    fitted: Array  # Shape (n,). Force of law and offsets in all samples of the trial.
    uncertainty: Uncertainty  # For the logarithms of the parameters
    rmse: float  # Root of the mean squared force error, in N (N m)
    free: int  # Parameters and offsets that were fitted
    doubts: tuple[str, ...]  # Why the record may not determine the parameters

    @property
    def record(self) -> TissueRecord:
        """The record as it was read."""
        return self.trial.record

    @property
    def estimates(self) -> tuple[Estimate, ...]:
        """The parameters with their 95 % intervals."""
        return self.intervals(CONFIDENCE)

    def intervals(self, confidence: float) -> tuple[Estimate, ...]:
        """Return the parameters with intervals of some confidence.

        They are symmetric in the logarithm; that of a stiffness which the 95 % interval does not
        tell from 0 is so in the value, which is nearly normal, and ends at 0.
        """
        known = self.uncertainty
        estimates = known.estimates(np.log(self.law.values), confidence)
        half = student_quantile(known.degrees, confidence)
        return tuple(
            estimate.extend_to_zero(half * float(error)) if zero else estimate
            for estimate, error, zero in zip(
                estimates, known.errors, reaches_zero(self.law, known), strict=True
            )
        )

    @property
    def r2(self) -> float:
        """Part of the variance of the force that is explained."""
        return 1 - self.rmse**2 / float(np.var(self.trial.measured))

    @property
    def bic(self) -> float:
        """Schwarz's criterion, with the variance of the noise among the parameters."""
        count = int(self.trial.fit_mask.sum())
        fidelity = 2 * count * float(np.log(max(self.rmse, TINY)))
        return fidelity + (self.free + 1) * float(np.log(count))


def fit_record(kind: type[AbstractContactLaw], record: TissueRecord | Trial) -> RecordFit:
    """Fit a law by output error.

    Minimizes the squared difference of measured and simulated force over the logarithms of the
    parameters, with offsets of force and deflection. Simulation and derivatives are exact for a
    piecewise linear deflection; the force is never differentiated.
    """
    trial = record if isinstance(record, Trial) else prepare(record)
    bounds = box(kind, trial)
    problem = LeastSquaresProblem(kind, trial)
    coarse = LeastSquaresProblem(kind, trial.thinned(COARSE))
    candidates = sorted(coarse.starts(), key=lambda start: start.cost)
    ends = [_search(start, bounds, _ROUGHLY) for start in candidates[:STARTS]]
    best = min(ends, key=lambda end: end.cost)
    point = _search(Point(problem, best.values), bounds, _EXACTLY)
    return _judge(point, bounds)


def _judge(point: Point, bounds: tuple[Array, Array]) -> RecordFit:
    names, trial, law = point.problem.names, point.problem.trial, point.law
    residuals = point.residuals
    J = np.column_stack([point.sensitivities, point.constants])
    known = _uncertainty(trial, J, residuals)
    p = len(law.values)
    shift = point.shift if len(point.values) > p else None
    fitted = dict(zip(names, point.best.tolist(), strict=False))
    law_uncertainty = Uncertainty(known.covariance[:p, :p], known.degrees, known.whiteness)
    texts = list(doubts(law, trial, law_uncertainty, bounds, residuals, J))
    if shift is not None and abs(point.values[p]) > _ZERO_RANGE * (1 - 1e-3):
        texts.append("the position of contact is at the end of its box")
    return RecordFit(
        trial=trial,
        law=law,
        offsets=place_offsets(law, trial, fitted, shift),
        fitted=point.whole_force,
        uncertainty=law_uncertainty,
        rmse=float(np.sqrt(np.mean(residuals**2))),
        free=J.shape[1],
        doubts=tuple(texts),
    )


def _uncertainty(trial: Trial, J: Array, residuals: Array) -> Uncertainty:
    deflection = trial.deflection
    moving = np.linalg.norm(deflection - deflection.mean())
    stiffness = float(np.linalg.norm(trial.measured - trial.measured.mean()) / moving)
    scatter = rounding_scatter(deflection, J, stiffness)
    return uncertainty(J, residuals, scatter=scatter)


def _search(start: Point, bounds: tuple[Array, Array], accuracy: float) -> Point:
    problem = start.problem
    p = len(problem.kind.kinds)
    zero_range = np.full(len(start.values) - p, _ZERO_RANGE)
    low, high = np.append(bounds[0], -zero_range), np.append(bounds[1], zero_range)
    # The search needs room around its start.
    room = 1e-6 * (high - low)
    last = [start]

    def point(x: Array) -> Point:
        # The search requests derivatives at the point of the last errors.
        if not np.array_equal(x, last[0].values):
            last[0] = Point(problem, x.copy())
        return last[0]

    def slopes(x: Array) -> Array:
        J = point(x).slopes
        J[:, p:] *= problem.travel
        return J

    first = np.clip(start.values, low + room, high - room)
    found, _ = search(
        lambda x: point(x).misfit, slopes, first, bounds=(low, high), converged=accuracy
    )
    return point(found)
