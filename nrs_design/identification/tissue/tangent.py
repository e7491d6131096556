"""Tangents of a power law: stiffness and damping of small motions about a preload.

By its tangents, a power law enters a proof.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.identification.errors import DataError
from nrs_design.identification.statistics import Estimate, joint_level, spread_ranges
from nrs_design.identification.tissue.output_error import RecordFit
from nrs_design.identification.tissue.pool import ModelFit
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import AbstractContactLaw, AbstractNonlinearLaw, KelvinVoigt

# Significant digits of the operating point in a spec.
_DIGITS = 4


@dataclass(frozen=True, slots=True)
class Tangent:
    """A spring and a damper for every small motion about a range of preloads."""

    law: KelvinVoigt  # In the middle of the preloads
    ranges: tuple[Estimate, ...]  # Ranges of stiffness and damping over all preloads
    # low, high: preloads: deflections in m (rad).
    low: float
    high: float
    operating_point: float  # A deflection in their middle, of few digits, in m (rad)
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
    common_depth = min(float(trial.deflection.max()) for trial in trials)
    if not 0 < low <= high <= common_depth:
        raise DataError(
            f"preloads from {low:.6g} to {high:.6g} are not within the deflections up to "
            f"{common_depth:.6g} that every record reaches",
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
        Estimate(value, min(low_end.low, high_end.low), max(low_end.high, high_end.high))
        for value, low_end, high_end in zip(middle.values, *ends, strict=True)
    )
    operating_point = min(max(float(f"{(low + high) / 2:.{_DIGITS}g}"), low), high)
    stiffness, damping, exponent = _ranges_near(model, operating_point, with_exponent=True)
    return Tangent(middle, ranges, low, high, operating_point, (stiffness, damping, exponent))


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
    exponent_row = np.eye(len(law.values))[-1:]
    chain = np.vstack([law.tangent_sensitivities(depth), exponent_row])
    covariance = chain @ fit.uncertainty.covariance @ chain.T
    known = replace(fit.uncertainty, covariance=covariance)
    return known.estimates(np.log([*law.tangent(depth), law.values[-1]]), level)
