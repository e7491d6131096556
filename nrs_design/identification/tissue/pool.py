"""Fits of one law to several records, and its pooled parameters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

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
from nrs_design.models.contact import AbstractContactLaw
from nrs_design.spec.provenance import Coverage

# Fewer records than these, counted by weight, have no scatter.
_FEWEST = 1.5
_SLACK = 1e-9


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
    within_variance = 1 / float(weights.sum())
    weights *= within_variance
    mean = float(weights @ logs)
    variance = float(weights @ (logs - mean) ** 2) / (count - 1)
    if 1 / float(weights @ weights) < _FEWEST:
        # One record decides: there is no scatter to tell the error from.
        variance = max(variance, within_variance)
    error = math.sqrt(variance)
    return Estimate.build_from_log(mean, student_quantile(count - 1, confidence) * error)


def _variance_between_records(logs: Array, variances: Array) -> float:
    """Estimate the variance between records by the method of moments."""
    weights = 1 / variances
    total = float(weights.sum())
    mean = float(weights @ logs) / total
    excess = float(weights @ (logs - mean) ** 2) - (len(logs) - 1)
    slack = total - float(weights @ weights) / total
    # Without slack, one record has all the weight.
    return max(0.0, excess / slack) if slack > _SLACK * total else 0.0
