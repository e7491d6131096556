"""From a spec to an export record, by way of a proof."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

from nrs_design.certificates.certificate import Certificate
from nrs_design.certificates.verify import verify
from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.errors import DesignError
from nrs_design.exporters.build import build_record, build_unproved, find_mismatch
from nrs_design.exporters.record import ExportRecord
from nrs_design.pipeline.certification import Result
from nrs_design.pipeline.design import Designed, interaction_of
from nrs_design.pipeline.runs import Recorded, run_certification, run_design, run_kept, run_recorded
from nrs_design.progress import Progress, silent
from nrs_design.proof.text import exact_text
from nrs_design.spec import InteractionDesignSpec, LoadedSpec


@dataclass(frozen=True, slots=True)
class Export:
    """What may be exported, or why nothing may."""

    # Verdict on the purpose of the files. Rejected: the given certificate does not hold, or does
    # not cover the design.
    verdict: str
    record: ExportRecord | None  # Record of a proved design or, on request, of an unproved one
    certificate: Certificate | None  # The proof of the record, or what refutes it
    reason: str = ""  # Reason without a proof; else empty
    design: ControllerDesign | None = None  # The gains of the record
    spec: InteractionDesignSpec | None = None  # Spec of the record
    designed: Designed | None = None  # The plant and the gains of a proved design

    @property
    def may_be_written(self) -> bool:
        """Whether there is something to write; matrices have a proof without a record."""
        return self.record is not None or self.verdict == "proved"

    def shipped(self) -> ExportRecord:
        """Return the record; a `DesignError` if nothing may be exported."""
        if self.record is None:
            raise DesignError(f"not exported: {self.reason}", remedy="export a proved design")
        return self.record


@dataclass(frozen=True, slots=True)
class Execution:
    """That a processor will run the export."""

    sample_time: Fraction | None = None  # In s; None takes that of the spec
    unproved: bool = False  # Export what is not proved, too, and say so in it


def export_design(
    loaded: LoadedSpec,
    certificate: Path | None = None,
    progress: Progress = silent,
    execution: Execution | None = None,
    recorded: Recorded | None = None,
) -> Export:
    """Design a spec and return its export record, if the design is proved.

    A given certificate is re-checked; without one the design is that of the recorded certificate
    that still holds, or is certified afresh. With an execution, for files that a processor runs,
    the proof must be about the sampled loop.
    """
    spec = interaction_of(loaded, "has no gains to export")
    if spec.sampling is not None and spec.sampling.round > 1:
        raise DesignError(
            "an export has one period for all operations of its law, and the proof with "
            "outer_period runs some of them at another",
            path=loaded.path,
            remedy="leave outer_period out to export; the report has the gains",
            at=("sampling", "outer_period"),
        )
    period = None if execution is None else _period(loaded, spec, execution.sample_time)
    export = (
        _certify_export(loaded, recorded, progress)
        if certificate is None
        else _recheck_export(loaded, certificate, progress)
    )
    export = replace(export, spec=spec)
    if execution is None or period is None or export.verdict == "rejected":
        return export
    return _executable(loaded, export, period, unproved=execution.unproved)


def export_proof(
    loaded: LoadedSpec,
    certificate: Path | None = None,
    progress: Progress = silent,
    recorded: Recorded | None = None,
) -> Export:
    """Return the export of formats that need a certificate only; of a design, with its record.

    A `CertificateError` if the given file is no certificate of this spec, or does not hold.
    """
    if loaded.spec.kind == "interaction-design":
        return export_design(loaded, certificate, progress, recorded=recorded)
    result = (
        _kept_or_anew(loaded, recorded, progress)
        if certificate is None
        else run_recorded(loaded, certificate, progress)
    )
    verdict = str(result.certification.verdict)
    reason = "" if verdict == "proved" else f"nothing is proved of the matrices: {verdict}"
    return Export(verdict, None, result.certificate, reason)


def _kept_or_anew(loaded: LoadedSpec, recorded: Recorded | None, progress: Progress) -> Result:
    recorded_result = None if recorded is None else run_kept(loaded, recorded, progress)
    return recorded_result or run_certification(loaded, progress=progress)


def _certify_export(loaded: LoadedSpec, recorded: Recorded | None, progress: Progress) -> Export:
    result = _kept_or_anew(loaded, recorded, progress)
    verdict = str(result.certification.verdict)
    assert result.designed is not None, "an interaction design"
    if result.certificate is None or verdict != "proved":
        contact = result.certification.refuted_in
        contact_note = "" if contact is None else f", and refuted {contact}"
        reason = f"the design is not proved: {verdict}{contact_note}"
        return Export(verdict, None, result.certificate, reason, result.design)
    return _proved(result.designed, result.certificate)


def _recheck_export(loaded: LoadedSpec, file: Path, progress: Progress) -> Export:
    progress("re-check")
    checked = verify(file, loaded)
    if checked.certificate is None or checked.fault is not None:
        remedy = "leave --certificate out to prove anew"
        return Export("rejected", None, None, f"{file} is rejected: {checked.fault} ({remedy})")
    progress("design")
    designed = run_design(loaded, recorded=checked.certificate.gains)
    assert designed is not None, "an interaction design"
    found, design = checked.certificate, designed.design
    if found.verdict == "refuted":
        return Export("refuted", None, found, f"{file} refutes the design", design)
    if found.verdict != "proved":
        contact_note = "" if found.refuted_in is None else f": it is refuted {found.refuted_in}"
        return Export("inconclusive", None, found, f"{file} proves nothing{contact_note}", design)
    fault = find_mismatch(design, found)
    if fault is not None:
        return Export("rejected", None, None, f"{file} {fault}")
    return _proved(designed, found)


def _proved(designed: Designed, certificate: Certificate) -> Export:
    spec, design = designed.spec, designed.design
    record = build_record(design, certificate, spec)
    return Export("proved", record, certificate, design=design, designed=designed)


def _period(
    loaded: LoadedSpec, spec: InteractionDesignSpec, requested: Fraction | None
) -> Fraction:
    """Return the sample time of the spec, or the requested one, in s."""
    declared_period = None if spec.sampling is None else spec.sampling.period.exact
    if requested is not None and declared_period is not None and requested != declared_period:
        raise DesignError(
            f"the spec samples every {exact_text(declared_period)} s, "
            f"not every {exact_text(requested)} s",
            path=loaded.path,
            remedy="leave --sample-time out, or change `sampling` in the spec",
        )
    period = declared_period or requested
    if period is None:
        raise DesignError(
            "nothing says when a processor runs the law",
            path=loaded.path,
            remedy="add `sampling: {period: 2 ms, delay: 1}` to the spec; or, without a proof, "
            "give --unproved --sample-time",
        )
    return period


def _executable(loaded: LoadedSpec, export: Export, period: Fraction, *, unproved: bool) -> Export:
    """Return an export for a processor: the proof must be about its sampled loop."""
    record, design = export.record, export.design
    if record is not None and record.sample_time is not None:
        return export
    if record is not None:
        reason = (
            "the certificate is about continuous time; nothing is proved of a law that runs every "
            f"{exact_text(period)} s"
        )
        export = replace(export, verdict="inconclusive", record=None, reason=reason)
    if not unproved or design is None:
        return export
    proof = None if record is None else record.proof
    found = build_unproved(loaded, design, export.reason, period, proof)
    return replace(export, record=found)
