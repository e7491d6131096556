"""One law fitted to several records: each by itself, and all together; and its tangents.

By stiffness and damping of small motions about a preload, a power law enters a proof.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.identification.errors import DataError
from nrs_design.identification.numeric import Array
from nrs_design.identification.statistics import (
    CONFIDENCE,
    Estimate,
    hulls,
    joint_level,
    spread_ranges,
    student_quantile,
)
from nrs_design.identification.tissue.output_error import RecordFit, fit_record
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import AbstractContactLaw, AbstractNonlinearLaw, KelvinVoigt
from nrs_design.spec.provenance import Coverage

# Fewer records than these, counted by weight, have no scatter.
_FEWEST = 1.5
_SLACK = 1e-9
# Of a deflection that a spec names.
_DIGITS = 4


@dataclass(frozen=True, slots=True, eq=False)
class ModelFit:
    """A law with its parameters over all records."""

    fits: tuple[RecordFit, ...]  # One for each record
    law: AbstractContactLaw  # With the pooled parameters
    # Pooled parameters with 95 % intervals that contain the spread between records.
    estimates: tuple[Estimate, ...]
    coverage: Coverage  # Coverage of the ranges

    @property
    def ranges(self) -> tuple[Estimate, ...]:
        """What a proof should cover: see `nrs_design.identification.statistics`."""
        level = joint_level(len(self.estimates))
        single = [fit.intervals(level) for fit in self.fits]
        if self.coverage != "confidence":
            logs = np.log([fit.law.values for fit in self.fits])
            return spread_ranges(self.coverage, logs, single)
        return hulls(pool(self.fits, level), single)

    @property
    def bic(self) -> float:
        """Sum over the records, each with parameters of its own."""
        return sum(fit.bic for fit in self.fits)

    @property
    def doubts(self) -> tuple[str, ...]:
        """Doubts of all records, with the name of the record."""
        return tuple(f"{fit.record.name}: {text}" for fit in self.fits for text in fit.doubts)


def fit_model(
    kind: type[AbstractContactLaw], trials: Sequence[Trial], coverage: Coverage = "confidence"
) -> ModelFit:
    """Fit a law to every record, and pool the parameters."""
    fits = tuple(fit_record(kind, trial) for trial in trials)
    pooled = pool(fits)
    law = kind(*(estimate.value for estimate in pooled))
    return ModelFit(fits, law, pooled, coverage)


def pool(fits: Sequence[RecordFit], confidence: float = CONFIDENCE) -> tuple[Estimate, ...]:
    """Pool the parameters of several fits of one law.

    Records of one tissue differ by more than their noise. Each logarithm is a weighted mean, the
    weight of a record being the inverse of its variance plus the variance between records
    (DerSimonian and Laird 1986); the interval comes from the scatter about that mean and Student's
    distribution with one degree of freedom less than there are records (Hartung and Knapp 2001).
    """
    if len(fits) == 1:
        return fits[0].intervals(confidence)
    logs = np.log([fit.law.values for fit in fits])
    variances = np.array([np.diag(fit.uncertainty.covariance) for fit in fits])
    return tuple(_pool(x, s, confidence) for x, s in zip(logs.T, variances.T, strict=True))


def _pool(logs: Array, variances: Array, confidence: float) -> Estimate:
    count = len(logs)
    weights = 1 / (variances + _variance_between_records(logs, variances))
    within = 1 / float(weights.sum())
    weights *= within
    mean = float(weights @ logs)
    variance = float(weights @ (logs - mean) ** 2) / (count - 1)
    if 1 / float(weights @ weights) < _FEWEST:
        # One record decides: there is no scatter to tell the error from.
        variance = max(variance, within)
    error = math.sqrt(variance)
    return Estimate.from_log(mean, student_quantile(count - 1, confidence) * error)


def _variance_between_records(logs: Array, variances: Array) -> float:
    """Estimate the variance between records by the method of moments."""
    weights = 1 / variances
    total = float(weights.sum())
    mean = float(weights @ logs) / total
    excess = float(weights @ (logs - mean) ** 2) - (len(logs) - 1)
    slack = total - float(weights @ weights) / total
    # Without slack, one record has all the weight.
    return max(0.0, excess / slack) if slack > _SLACK * total else 0.0


@dataclass(frozen=True, slots=True)
class Tangent:
    """A spring and a damper for every small motion about a range of preloads."""

    law: KelvinVoigt  # In the middle of the preloads
    ranges: tuple[Estimate, ...]  # Ranges of stiffness and damping over all preloads
    # low, high: preloads: deflections in m (rad).
    low: float
    high: float
    about: float  # A deflection in their middle, of few digits, in m (rad)
    # The power law itself: stiffness and damping at that deflection, and the exponent.
    power: tuple[Estimate, Estimate, Estimate]


def check_preload(
    kind: type[AbstractContactLaw], trials: Sequence[Trial], preload: tuple[float, float]
) -> None:
    """Refuse, before a fit, a preload in m (rad) that the tangent of a law cannot be taken at."""
    if not issubclass(kind, AbstractNonlinearLaw):
        raise DataError(
            f"{kind.name} is linear: its stiffness is the same at every preload",
            remedy="leave out --preload, or choose --model hunt-crossley",
        )
    low, high = preload
    reached = min(float(trial.deflection.max()) for trial in trials)
    if not 0 < low <= high <= reached:
        raise DataError(
            f"preloads from {low:.6g} to {high:.6g} are not within the deflections up to "
            f"{reached:.6g} that every record reaches",
            remedy="give --preload LOW..HIGH within them, counted from the contact",
        )


def tangent_of(model: ModelFit, preload: tuple[float, float]) -> Tangent:
    """Return the tangent of a power law over a range of deflections in m (rad).

    Stiffness and damping of a power law grow with the deflection, so that the ends of the preloads
    give the ends of the range.
    """
    law, (low, high) = model.law, preload
    assert isinstance(law, AbstractNonlinearLaw)
    ends = [_ranges_near(model, depth) for depth in (low, high)]
    middle = KelvinVoigt(*law.tangent((low + high) / 2))
    ranges = tuple(
        Estimate(value, min(at_low.low, at_high.low), max(at_low.high, at_high.high))
        for value, at_low, at_high in zip(middle.values, *ends, strict=True)
    )
    about = min(max(float(f"{(low + high) / 2:.{_DIGITS}g}"), low), high)
    stiffness, damping, exponent = _ranges_near(model, about, with_exponent=True)
    return Tangent(middle, ranges, low, high, about, (stiffness, damping, exponent))


def _ranges_near(
    model: ModelFit, depth: float, *, with_exponent: bool = False
) -> Sequence[Estimate]:
    """Return stiffness and damping at one deflection, with what the model's ranges hold.

    With the exponent beside them, each has a smaller share of the 5 % that may fail.
    """
    count = 2 + with_exponent
    level = joint_level(count)
    single = [_estimates(fit, depth, level)[:count] for fit in model.fits]
    if len(single) == 1:
        return single[0]
    logs = np.log([[e.value for e in row] for row in single])
    # For few records, a prediction interval is a safe choice for the mean.
    coverage = "prediction" if model.coverage == "confidence" else model.coverage
    return spread_ranges(coverage, logs, single)


def _estimates(fit: RecordFit, depth: float, level: float) -> tuple[Estimate, ...]:
    law = fit.law
    assert isinstance(law, AbstractNonlinearLaw)
    # By the logarithms of the parameters; the exponent is the last of them.
    alone = np.eye(len(law.values))[-1:]
    chain = np.vstack([law.tangent_sensitivities(depth), alone])
    covariance = chain @ fit.uncertainty.covariance @ chain.T
    known = replace(fit.uncertainty, covariance=covariance)
    return known.estimates(np.log([*law.tangent(depth), law.values[-1]]), level)
