"""Covariance, intervals, ranges for a spec, and whiteness of residuals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

import numpy as np

from nrs_design.identification.numeric import Array, Rows
from nrs_design.spec.provenance import Coverage

CONFIDENCE = 0.95
_DIGITS = 5
# Below this p-value, residuals are taken as colored.
WHITE = 0.01
_LAGS = 20
# Fewer would leave no degrees of freedom, more would not be independent.
_BATCHES = 12
# Beyond these logarithms a number leaves the floats: the interval is then unlimited.
_HUGE = 690.0
_SINGULAR = 1e-14


@dataclass(frozen=True, slots=True)
class Estimate:
    """A parameter with its 95 % confidence interval."""

    value: float  # The estimate
    # low, high: ends of the interval; 0 and infinity where the data say nothing.
    low: float
    high: float

    @classmethod
    def build_from_log(cls, logarithm: float, half_width: float) -> Estimate:
        """Return the interval that is symmetric in the logarithm."""
        if not half_width < _HUGE - abs(logarithm):
            return cls(math.exp(logarithm), 0.0, math.inf)
        ends = math.exp(logarithm - half_width), math.exp(logarithm + half_width)
        return cls(math.exp(logarithm), *ends)

    def extend_to_zero(self, half_width: float) -> Estimate:
        """Return the interval that is symmetric in the value and ends at 0; half width over value.

        A parameter that is not told from 0 has no meaningful logarithm.
        """
        return Estimate(self.value, 0.0, self.value * (1 + half_width))

    def __str__(self) -> str:
        """Return value and interval in words, its ends rounded outwards."""
        wide = self.outward()
        return f"{self.value:.{_DIGITS}g} [{wide.low:.{_DIGITS}g}, {wide.high:.{_DIGITS}g}]"

    def outward(self, digits: int = _DIGITS) -> Estimate:
        """Return the estimate with ends rounded outwards to so many digits."""
        low = few_digits(self.low, digits, ROUND_FLOOR)
        return Estimate(self.value, float(low), float(few_digits(self.high, digits, ROUND_CEILING)))

    def covers(self, value: float) -> bool:
        """Tell whether a value lies in the interval."""
        return self.low <= value <= self.high

    def scaled(self, factor: float) -> Estimate:
        """Return the estimate of the parameter times a positive constant."""
        return Estimate(self.value * factor, self.low * factor, self.high * factor)


@dataclass(frozen=True, slots=True, eq=False)
class Uncertainty:
    """How well a fit knows its parameters."""

    covariance: Array  # Shape (p, p). Of the logarithms of the parameters.
    degrees: int  # Degrees of freedom of the intervals
    whiteness: float  # p-value of the test that the residuals are white

    @property
    def errors(self) -> Array:
        """Standard errors of the logarithms, which are relative standard errors, shape (p,)."""
        return np.sqrt(np.diag(self.covariance))

    def estimates(self, logarithms: Array, confidence: float = CONFIDENCE) -> tuple[Estimate, ...]:
        """Return the parameters with their intervals."""
        quantile = student_quantile(self.degrees, confidence)
        return tuple(
            Estimate.build_from_log(float(log), quantile * float(error))
            for log, error in zip(logarithms, self.errors, strict=True)
        )


def uncertainty(
    sensitivities: Array,
    residuals: Array,
    starts: Sequence[int] | None = None,
    scatter: Array | None = None,
) -> Uncertainty:
    """Estimate the covariance of a least-squares fit, of logarithms of parameters.

    White residuals give the classical ``s^2 (J'J)^-1``. Colored ones, which every real tissue
    leaves, would make that far too small: then the fit is repeated without each of some long
    batches, or of the records if there are several, which are nearly independent, and the scatter
    of the results gives the covariance (a jackknife). A given scatter is the covariance of ``J'e``
    for errors e that the residuals do not show.
    """
    n, p = sensitivities.shape
    whiteness = ljung_box(residuals)
    bread = _inverse(sensitivities)
    hidden = 0.0 if scatter is None else _propagated(bread, scatter)
    if whiteness >= WHITE:
        variance = float(residuals @ residuals) / (n - p)
        return Uncertainty(variance * bread + hidden, n - p, whiteness)
    edges = np.asarray(starts if starts is not None else np.arange(_BATCHES) * n // _BATCHES)
    covariance = _jackknife(sensitivities, residuals, edges, bread)
    degrees = max(len(edges) - p, 1)
    return Uncertainty(covariance + hidden, degrees, whiteness)


def ljung_box(residuals: Array) -> float:
    """Return the p-value of the Ljung-Box test that residuals are white; all zero is white."""
    from scipy.special import chdtrc

    n = len(residuals)
    lags = min(_LAGS, n // 5)
    centered = residuals - residuals.mean()
    power = float(centered @ centered)
    if power == 0.0 or lags < 1:
        return 1.0
    rho = np.array([centered[k:] @ centered[:-k] for k in range(1, lags + 1)]) / power
    statistic = n * (n + 2) * float(np.sum(rho**2 / (n - np.arange(1, lags + 1))))
    return float(chdtrc(lags, statistic))


def independent(residuals: Array) -> float:
    """Return how many independent errors tell as much about a mean as these.

    Neighbours that are alike, as in an autoregression of first order, count less.
    """
    power = float(residuals @ residuals)
    alike = float(residuals[1:] @ residuals[:-1]) / power if power else 0.0
    alike = max(alike, 0.0)
    return len(residuals) * (1 - alike) / (1 + alike)


def joint_level(count: int) -> float:
    """Return the level of each of `count` intervals that hold together with 95 %."""
    return 1 - (1 - CONFIDENCE) / count


def student_quantile(degrees: int, confidence: float = CONFIDENCE) -> float:
    """Return the factor from standard error to half the interval."""
    from scipy.special import stdtrit

    return float(stdtrit(degrees, 0.5 + confidence / 2))


def tolerance_factor(count: int, share: float, confidence: float) -> float:
    """Return how many standard deviations about the mean hold a share of a normal population.

    Each end is a one-sided tolerance limit, exact by the noncentral t distribution (Owen 1968):
    beyond it lies at most half of what may be missed. That both hold has at least the confidence
    asked for, as each fails with at most half the probability that one may.
    """
    from scipy.special import nctdtrit, ndtri

    noncentrality = float(ndtri(0.5 + share / 2)) * math.sqrt(count)
    return float(nctdtrit(count - 1, noncentrality, 0.5 + confidence / 2)) / math.sqrt(count)


def span(low: float, high: float, unit: str = "", digits: int = 4) -> str:
    """Write a range, or one number where both ends, rounded to nearest, are written alike."""
    ends = dict.fromkeys(f"{end:.{digits}g}" for end in (low, high))
    return f"{' to '.join(ends)} {unit}".rstrip()


def few_digits(value: float, digits: int, rounding: str) -> Decimal:
    """Round a number to so many significant digits."""
    return Context(prec=digits, rounding=rounding).create_decimal(Decimal(value))


def _jackknife(J: Array, residuals: Array, edges: Rows, bread: Array) -> Array:
    """Return the scatter of the parameters when each batch in turn is left out (first order)."""
    count, p = len(edges), J.shape[1]
    shifts = []
    for first, last in zip(edges, [*edges[1:], len(J)], strict=True):
        part = J[first:last]
        # The tiny addition keeps a batch that alone determines a parameter from dividing by zero.
        complement = (1 + 1e-9) * np.eye(p) - part.T @ part @ bread
        shifts.append(bread @ np.linalg.solve(complement, part.T @ residuals[first:last]))
    deviations = np.array(shifts)
    return np.asarray(deviations.T @ deviations * (count - 1) / count)


def _propagated(bread: Array, scatter: Array) -> Array:
    """Return ``bread scatter bread`` as a square, so that rounding leaves no negative variance."""
    values, vectors = np.linalg.eigh(scatter)
    root = bread @ (vectors * np.sqrt(np.maximum(values, 0.0)))
    return np.asarray(root @ root.T)


def _inverse(J: Array) -> Array:
    """Return ``(J'J)^-1``, large instead of undefined where a parameter has no effect."""
    size = np.sqrt(np.einsum("ij,ij->j", J, J))
    size = np.maximum(size, 1e-12 * size.max() + np.finfo(float).tiny)
    scaled = J / size
    values, vectors = np.linalg.eigh(scaled.T @ scaled)
    inverse: Array = (vectors / np.maximum(values, _SINGULAR)) @ vectors.T
    return inverse / np.outer(size, size)


def spread_ranges(
    coverage: Coverage, logarithms: Array, single: Sequence[Sequence[Estimate]]
) -> tuple[Estimate, ...]:
    """Return ranges for other specimens than those measured; one record does not tell them.

    ``tolerance``: a share of all specimens like those of the records. ``prediction``: the specimen
    of the next record. Both hold the interval of every measured record too. Several parameters make
    a box: each side has its share of the 5 % that may fail (Bonferroni), so that the box as a whole
    holds with 95 %.

    The scatter between the records is that of the specimens and of the fits together, which errs
    to the wide side. Logarithms, shape (n, p), are taken as normal.
    """
    n, p = logarithms.shape
    level = joint_level(p)
    if coverage == "tolerance":
        factor = tolerance_factor(n, share=level, confidence=level)
    else:
        factor = student_quantile(n - 1, level) * math.sqrt(1 + 1 / n)
    means, scatter = logarithms.mean(axis=0), logarithms.std(axis=0, ddof=1)
    halves = zip(means.tolist(), (factor * scatter).tolist(), strict=True)
    return hulls([Estimate.build_from_log(mean, half) for mean, half in halves], single)


def hulls(pooled: Sequence[Estimate], single: Sequence[Sequence[Estimate]]) -> tuple[Estimate, ...]:
    """Widen the interval of each parameter to those of single records."""
    return tuple(
        Estimate(mean.value, min(e.low for e in (mean, *row)), max(e.high for e in (mean, *row)))
        for mean, *row in zip(pooled, *single, strict=True)
    )
