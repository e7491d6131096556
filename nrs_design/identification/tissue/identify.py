"""Compare the laws of soft tissue on records, and choose one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from nrs_design.identification.datasets.records import AbstractIdentification, TissueRecord
from nrs_design.identification.errors import DataError
from nrs_design.identification.tissue.pool import ModelFit, fit_model
from nrs_design.identification.tissue.settings import Preparation
from nrs_design.identification.tissue.tangent import Tangent, check_preload, tangent_of
from nrs_design.identification.tissue.trial import prepare
from nrs_design.models.contact import LAWS, AbstractNonlinearLaw, HuntCrossley
from nrs_design.progress import Progress, silent
from nrs_design.spec.provenance import COVERS, Coverage


@dataclass(frozen=True, eq=False)
class TissueIdentification(AbstractIdentification[TissueRecord]):
    """All laws on the same records, and the choice among them."""

    models: tuple[ModelFit, ...]  # In the order of `LAWS`
    model: ModelFit  # The chosen law
    reason: str  # Reason of the choice
    tangent: Tangent | None = None  # Tangent of the chosen law at a preload

    @property
    def doubts(self) -> tuple[str, ...]:
        """What speaks against the chosen law."""
        return self.model.doubts

    @property
    def caveats(self) -> tuple[str, ...]:
        """What to know before a proof rests on the chosen law: a better law, and doubts."""
        best = min(self.models, key=lambda model: model.bic)
        if best is self.model:
            return self.model.doubts
        better = (
            f"{best.law.name} describes the records better than {self.model.law.name} "
            f"(BIC {self.model.bic - best.bic:.4g} less)"
        )
        return (better, *self.model.doubts)

    @property
    def covers(self) -> str:
        """Coverage of the ranges, in words."""
        if len(self.records) == 1:
            return "what this one record leaves open, with 95 % confidence, and no other specimen"
        return COVERS[self.model.coverage]

    @property
    def rotational(self) -> bool:
        """Whether the parameters are those of a rotation."""
        return self.records[0].rotational


def identify_tissue(
    records: Sequence[TissueRecord],
    law: str | None = None,
    preparation: Preparation | None = None,
    coverage: Coverage = "confidence",
    preload: tuple[float, float] | None = None,
    progress: Progress = silent,
    *,
    is_declared: bool = False,
) -> TissueIdentification:
    """Fit all laws to all records, linear or rotational, and choose; a named law is chosen anyway.

    About a preload, in m (rad), a power law is linearized. What cannot be fitted is refused as a
    `DataError` before anything is fitted. `declared`: the law is that of a spec, not the user's.
    """
    _check(records)
    if coverage != "confidence" and len(records) < 2:
        raise DataError(
            f"a range for {coverage} needs several records: a single record does not show the "
            "spread between specimens",
            remedy="give more records, or take --covers confidence",
        )
    trials = [prepare(record, preparation) for record in records]
    if preload is not None:
        check_preload(HuntCrossley if law is None else LAWS[law], trials, preload)
    models = []
    for name, kind in LAWS.items():
        progress(name)
        models.append(fit_model(kind, trials, coverage))
    model, reason = (
        _choose(models) if law is None else _keep_law(models, law, is_declared=is_declared)
    )
    tangent = None
    if preload is not None and isinstance(model.law, AbstractNonlinearLaw):
        tangent = tangent_of(model, preload)
    elif preload is not None:
        reason += " It is linear, and the same at every preload."
    return TissueIdentification(tuple(records), tuple(models), model, reason, tangent)


def _check(records: Sequence[TissueRecord]) -> None:
    if not records:
        raise DataError("there are no records", remedy="name at least one CSV file")
    if len({record.rotational for record in records}) > 1:
        odd = next(r for r in records if r.rotational != records[0].rotational)
        raise DataError(
            "linear and rotational records are mixed",
            path=odd.source.path,
            remedy="identify linear and rotational records separately",
        )
    records_by_hash: dict[str, TissueRecord] = {}
    for record in records:
        if record.source.sha256 in records_by_hash:
            twin = records_by_hash[record.source.sha256]
            raise DataError(
                f"has the same content as {twin.source.path}: a record counted twice would "
                "narrow the interval",
                path=record.source.path,
                remedy="name it once",
            )
        records_by_hash[record.source.sha256] = record


def _choose(models: Sequence[ModelFit]) -> tuple[ModelFit, str]:
    best = min(models, key=lambda model: model.bic)
    sound = [model for model in models if not model.doubts]
    if not sound:
        return best, f"{best.law.name} has the least BIC, but no law is free of doubts."
    model = min(sound, key=lambda model: model.bic)
    if model is best:
        return model, f"{model.law.name} has the least BIC, and no doubts."
    doubted = [model.law.name for model in models if model.bic < model.bic]
    return model, (
        f"{model.law.name} has the least BIC among the laws that the records determine; "
        f"{', '.join(doubted)} would have less, but with doubts."
    )


def _keep_law(models: Sequence[ModelFit], law: str, *, is_declared: bool) -> tuple[ModelFit, str]:
    model = next(model for model in models if model.law.name == law)
    best, _ = _choose(models)
    agrees = "as by the comparison" if best is model else f"the comparison prefers {best.law.name}"
    if not is_declared:
        return model, f"{law} was asked for; {agrees}."
    other = "" if best is model else f" (--model {best.law.name} would write that)"
    return model, f"{law} is the law of the spec, which is kept; {agrees}{other}."
