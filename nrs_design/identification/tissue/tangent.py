"""The stiffness and damping of small motions about a preload: how a power law enters a proof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.errors import DataError
from nrs_design.identification.statistics import Estimate, Uncertainty, joint_level
from nrs_design.identification.tissue.output_error import RecordFit
from nrs_design.identification.tissue.pool import ModelFit
from nrs_design.identification.tissue.ranges import hull, spread_ranges
from nrs_design.models.contact import AbstractNonlinearLaw, KelvinVoigt

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Tangent:
    """A spring and a damper for every small motion about a range of preloads.

    Parameters
    ----------
    law : KelvinVoigt
        In the middle of the preloads.
    ranges : tuple of Estimate
        Of stiffness and damping over all preloads.
    low, high : float
        Preloads: deflections in m (rad).
    """

    law: KelvinVoigt
    ranges: tuple[Estimate, ...]
    low: float
    high: float


def tangent(model: ModelFit, preload: tuple[float, float]) -> Tangent:
    """Return the tangent of a power law over a range of deflections.

    Stiffness and damping of a power law grow with the deflection, so that the ends of the preloads
    give the ends of the range.

    Parameters
    ----------
    model : ModelFit
        Of the power law.
    preload : tuple of float
        Least and largest deflection in m (rad).

    Raises
    ------
    DataError
        If the law is linear, or the preloads are beyond what the records reach.
    """
    law, (low, high) = model.law, preload
    if not isinstance(law, AbstractNonlinearLaw):
        raise DataError(
            f"{law.name} is linear: its stiffness is the same at every preload",
            remedy="leave out --preload, or choose --model hunt-crossley",
        )
    reached = min(float(fit.trial.deflection.max()) for fit in model.fits)
    if not 0 < low <= high <= reached:
        raise DataError(
            f"preloads from {low:.6g} to {high:.6g} are not within the deflections up to "
            f"{reached:.6g} that every record reaches",
            remedy="give --preload LOW..HIGH within them, counted from the contact",
        )
    ends = [_ranges_at(model, depth) for depth in (low, high)]
    middle = KelvinVoigt(*law.tangent((low + high) / 2))
    ranges = tuple(
        Estimate(value, min(at_low.low, at_high.low), max(at_low.high, at_high.high))
        for value, at_low, at_high in zip(middle.values, *ends, strict=True)
    )
    return Tangent(middle, ranges, low, high)


def _ranges_at(model: ModelFit, depth: float) -> Sequence[Estimate]:
    """Return stiffness and damping at one deflection, with what the model's ranges hold."""
    level = joint_level(2)
    single = [_estimates(fit, depth, level) for fit in model.fits]
    logs = np.log([[e.value for e in row] for row in single])
    if len(single) == 1:
        return single[0]
    # The mean of few records is sure by what would hold the next one, too.
    coverage = "prediction" if model.coverage == "confidence" else model.coverage
    spread = spread_ranges(coverage, logs, single)
    return [hull(e, [row[i] for row in single]) for i, e in enumerate(spread)]


def _estimates(fit: RecordFit, depth: float, level: float) -> tuple[Estimate, ...]:
    law = fit.law
    assert isinstance(law, AbstractNonlinearLaw)
    chain = law.tangent_sensitivities(depth)
    covariance = chain @ fit.uncertainty.covariance @ chain.T
    known = Uncertainty(covariance, fit.uncertainty.degrees, fit.uncertainty.whiteness)
    return known.estimates(np.log(law.tangent(depth)), level)
