"""The rule for the gains of a spec, and runs of a spec by its file."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Certificate, Gains, Verdict
from nrs_design.errors import CertificateError, DesignError
from nrs_design.pipeline.certification import (
    Result,
    certify_design,
    is_of_gains,
    recorded_certification,
)
from nrs_design.pipeline.design import Designed, design_at_least_cost, interaction_of
from nrs_design.progress import Progress, silent
from nrs_design.search.method import Method
from nrs_design.spec import LoadedSpec

if TYPE_CHECKING:
    from nrs_design.search.certification import Limits

_ANEW = "make it anew with certify-switching --out"


@dataclass(frozen=True, slots=True)
class Recorded:
    """Where the certificate of a spec is recorded."""

    file: Path
    id: str | None = None  # Id in a lock file; None without one


def run_design(
    loaded: LoadedSpec, progress: Progress = silent, recorded: Gains | None = None
) -> Designed | None:
    """Build the plant of a spec and choose its gains; None for given matrices.

    This is the one rule for the gains of a spec: those of the least cost. Where goals of a proof
    choose the free ones, these are `recorded` in a certificate for this very spec, or the cheapest
    that are proved to meet the goals, if any.
    """
    designed = design_at_least_cost(loaded)
    if designed is None:
        return None
    from nrs_design.controllers.gains import apply_free_gains, steering_goals

    if not steering_goals(designed.spec):
        return designed
    if recorded is not None:
        return replace(designed, design=apply_free_gains(designed.spec, designed.design, recorded))
    from nrs_design.design.analysis import analyze_design
    from nrs_design.pipeline.certified_optimum import find_certified_optimum

    try:
        analysis = analyze_design(designed.spec, designed.plant, designed.design)
        found = find_certified_optimum(designed, analysis, progress)
    except DesignError:
        return designed
    return found.result.designed


def run_interaction(loaded: LoadedSpec, lacks: str, progress: Progress = silent) -> Designed:
    """Design an interaction; refuse other kinds of specs, as `interaction_of` does."""
    interaction_of(loaded, lacks)
    designed = run_design(loaded, progress)
    assert designed is not None
    return designed


def run_certification(
    loaded: LoadedSpec,
    *,
    method: Method = Method.AUTO,
    limits: Limits | None = None,
    progress: Progress = silent,
) -> Result:
    """Certify a spec; method and limits are by default those of the spec.

    A spec without a design is a `DesignError`, modes that make no switched system are an
    `AssemblyError`, and a search that the clock stopped is a `ClockError`.
    """
    progress("design")
    designed = run_design(loaded, progress)
    return certify_design(loaded, designed, method=method, limits=limits, progress=progress)


def run_recorded(loaded: LoadedSpec, file: Path, progress: Progress = silent) -> Result:
    """Take the verdict of a certificate file, checked exactly, instead of searching.

    One that does not hold for this spec, or has other gains, is a `CertificateError`.
    """
    progress(f"checking {file.name}")
    start = perf_counter()
    designed, certificate = read_recorded(loaded, file)
    certification = recorded_certification(certificate, file, perf_counter() - start)
    return Result(loaded, designed, certification, certificate)


def run_kept(loaded: LoadedSpec, recorded: Recorded, progress: Progress = silent) -> Result | None:
    """Return the recorded result of a spec, checked exactly; None if a search could show more."""
    from nrs_design.certificates.goals import certified_goals
    from nrs_design.certificates.verify import find_foreign, read_document
    from nrs_design.controllers.gains import steering_goals

    try:
        document = read_document(recorded.file)
        if recorded.id not in (None, document.get("id")) or find_foreign(document, loaded):
            return None
        result = run_recorded(loaded, recorded.file, progress)
    except CertificateError:
        return None
    verdict, goals = result.certification.verdict, certified_goals(loaded.spec, result.certificate)
    proved = verdict is Verdict.PROVED and all(goal.met for goal in goals)
    # A refutation of chosen gains says nothing about others.
    refuted = verdict is Verdict.REFUTED and not steering_goals(loaded.spec)
    return result if proved or refuted else None


def read_recorded(loaded: LoadedSpec, file: Path) -> tuple[Designed | None, Certificate]:
    """Return what a certificate file holds, checked exactly, with the design that it is about.

    A `CertificateError` as for `run_recorded`.
    """
    from nrs_design.certificates.verify import verify

    found = verify(file, loaded)
    if found.certificate is None or found.fault is not None:
        raise CertificateError(str(found.fault), path=file, remedy=_ANEW)
    designed = run_design(loaded, recorded=found.certificate.gains)
    if not is_of_gains(found.certificate.gains, designed):
        message = "it is about other gains than are designed here"
        raise CertificateError(message, path=file, remedy=_ANEW)
    return designed, found.certificate


def run_interaction_of(
    loaded: LoadedSpec, file: Path | None, lacks: str, progress: Progress = silent
) -> tuple[Designed, Certificate | None]:
    """Design an interaction; where a certificate file is given, with its gains, and what it holds.

    Other kinds of specs are refused, as by `interaction_of`, and files as by `run_recorded`.
    """
    if file is None:
        return run_interaction(loaded, lacks, progress), None
    interaction_of(loaded, lacks)
    designed, kept = read_recorded(loaded, file)
    assert designed is not None, "an interaction design"
    return designed, kept
