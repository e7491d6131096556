"""Laws of a tissue, fitted and compared."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from nrs_design.identification.facts.finding import Facts, estimate_numbers

if TYPE_CHECKING:
    from nrs_design.identification.statistics import Estimate
    from nrs_design.identification.tissue.identify import TissueIdentification
    from nrs_design.identification.tissue.output_error import RecordFit
    from nrs_design.identification.tissue.pool import ModelFit
    from nrs_design.identification.tissue.prony import Series
    from nrs_design.identification.tissue.tangent import Tangent
    from nrs_design.models.contact import AbstractContactLaw


def tissue_facts(
    found: TissueIdentification, arm: float | None = None, series: list[Series] | None = None
) -> Facts:
    """Return all laws and the chosen one; with a lever arm in m, that one at the pivot, too."""
    law, about = found.chosen.law, found.tangent
    listed = {} if series is None else {"prony": [_series_facts(item) for item in series]}
    return {
        "chosen": law.name,
        "reason": found.reason,
        "ranges": _parameters(law, found.chosen.ranges, found.rotational),
        "tangent": None if about is None else _tangent(about, found.rotational),
        "range_covers": found.chosen.coverage,
        "range_covers_words": found.covers,
        "box": found.chosen.box or None,
        "at_pivot": None
        if arm is None
        else dict(zip(law.parameters(), law.at_pivot(arm).values, strict=True)),
        "models": [_model(model, found.rotational) for model in found.models],
        **listed,
    }


def _parameters(law: AbstractContactLaw, estimates: Iterable[Estimate], rotational: bool) -> Facts:
    from nrs_design.identification.lever import named

    return {
        name: estimate_numbers(estimate) | {"unit": unit}
        for name, estimate, unit in named(law, estimates, rotational)
    }


def _tangent(about: Tangent, rotational: bool) -> Facts:
    *power, exponent = about.power
    law = _parameters(about.law, power, rotational) | {"phi": estimate_numbers(exponent)}
    return {
        "preload": [about.low, about.high],
        "ranges": _parameters(about.law, about.ranges, rotational),
        "about": about.about,
        "law": law,
    }


def _series_facts(series: Series) -> Facts:
    law = series.reduced
    return {
        "record": series.record,
        "rest": series.rest,
        "arms": list(series.arms),
        "times_s": list(series.times),
        "rmse": series.rmse,
        "bic": list(series.bic),
        "reduced": None
        if law is None
        else {"law": law.name, **dict(zip(law.parameters(), law.values, strict=True))},
    }


def _model(model: ModelFit, rotational: bool) -> Facts:
    return {
        "law": model.law.name,
        "parameters": _parameters(model.law, model.estimates, rotational),
        "relaxation_time_s": model.law.relaxation_time,
        "aic": model.aic,
        "bic": model.bic,
        "doubts": list(model.doubts),
        "records": [
            _record(fit, rotational) | {"rmse_pooled": pooled}
            for fit, pooled in zip(model.fits, model.rmse, strict=True)
        ],
    }


def _record(fit: RecordFit, rotational: bool) -> Facts:
    return {
        "parameters": _parameters(fit.law, fit.estimates, rotational),
        "rmse": fit.rmse,
        "aic": fit.aic,
        "bic": fit.bic,
        "offsets": {
            offset.name: estimate_numbers(offset.estimate)
            | {"fitted": offset.fitted, "provided": offset.provided or None}
            for offset in fit.offsets
        },
        "used": int(fit.trial.used.sum()),
        "samples": len(fit.record.force),
        "cuts": list(fit.trial.cuts),
        "remarks": list(fit.trial.remarks),
        "r2": fit.r2,
        "residual_over_range": fit.rmse / fit.trial.span,
        "whiteness_p": fit.uncertainty.whiteness,
        "starts": fit.starts,
        "agreeing": fit.agreeing,
    }
