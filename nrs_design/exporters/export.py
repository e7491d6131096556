"""From a spec to an export record, by way of a proof."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from nrs_design.certificates.certificate import Certificate
from nrs_design.certificates.verify import verify
from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.exporters.record import ExportRecord, build_record, find_mismatch
from nrs_design.pipeline import Designed, Progress, run_certification, run_design, wrong_kind
from nrs_design.spec import InteractionDesignSpec, LoadedSpec


@dataclass(frozen=True, slots=True)
class Export:
    """What may be exported, or why nothing may.

    Parameters
    ----------
    verdict : {"proved", "refuted", "inconclusive", "rejected"}
        Rejected: the given certificate does not hold, or does not cover the design.
    record : ExportRecord or None
        Only with the verdict proved.
    certificate : Certificate or None
        The proof of the record.
    reason : str
        Why there is no record; empty if there is one.
    """

    verdict: str
    record: ExportRecord | None
    certificate: Certificate | None
    reason: str = ""


def export_design(
    loaded: LoadedSpec, certificate: Path | None = None, progress: Progress = lambda step: None
) -> Export:
    """Design a spec and return its export record, if the design is proved.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec.
    certificate : Path, optional
        A certificate to be re-checked; without it the design is certified afresh.
    progress : callable
        Told the name of each step.

    Raises
    ------
    DesignError
        If the spec gives matrices, which have no gains, or the design has no answer.
    CertificateError
        If the given file is not a certificate at all.
    """
    if not isinstance(loaded.spec, InteractionDesignSpec):
        raise wrong_kind(
            loaded,
            f"a spec of kind {loaded.spec.kind} has no gains to export",
            "use a spec of kind interaction-design",
        )
    if certificate is None:
        return _certified_afresh(loaded, progress)
    progress("design")
    designed = run_design(loaded)
    assert designed is not None
    progress("re-check")
    return _certified_by(certificate, designed)


def _certified_afresh(loaded: LoadedSpec, progress: Progress) -> Export:
    result = run_certification(loaded, progress=progress)
    verdict = str(result.certification.verdict)
    if result.design is None or result.certificate is None or verdict != "proved":
        return Export(verdict, None, None, f"the design is not proved: {verdict}")
    spec = loaded.spec
    assert isinstance(spec, InteractionDesignSpec)
    return _proved(spec, result.design, result.certificate)


def _certified_by(file: Path, designed: Designed) -> Export:
    checked = verify(file, designed.loaded, plant=designed.plant)
    if checked.certificate is None or checked.fault is not None:
        return Export("rejected", None, None, f"{file} is rejected: {checked.fault}")
    found = checked.certificate
    if found.verdict == "refuted":
        return Export("refuted", None, None, f"{file} refutes the design")
    fault = find_mismatch(designed.design, found)
    if fault is None and found.coordinates != designed.spec.coordinates:
        fault = f"is about {found.coordinates} coordinates, not those of the spec"
    if fault is not None:
        return Export("rejected", None, None, f"{file} {fault}")
    return _proved(designed.spec, designed.design, found)


def _proved(
    spec: InteractionDesignSpec, design: ControllerDesign, certificate: Certificate
) -> Export:
    record = build_record(design, certificate, spec.idle_states, spec.offset)
    return Export("proved", record, certificate)
