"""The lines that every exported file holds, whatever its format."""

from __future__ import annotations

from nrs_design.exporters.record import ExportRecord


def header_lines(record: ExportRecord) -> tuple[str, ...]:
    """Return the head of a file: origin, verdict, sample time, units, effects outside the proof.

    Every line is one sentence or one ``key: value``; none holds a line break.
    """
    proof = record.proof
    certificate = "none" if proof is None else proof.certificate_id
    verdict = "PROVED" if record.unproved is None else f"UNPROVED: {record.unproved}"
    return (
        f"nrs-design {record.package.version}, {record.schema_id}",
        f"spec: {record.spec.name}, sha256 {record.spec.sha256}",
        f"certificate: {certificate}",
        f"verdict: {verdict}",
        *(() if proof is None else (f"claim: {proof.claim}",)),
        f"sample time: {_sample_time(record)}",
        "units: SI; each gain has its unit beside it, which names that of the motor",
        *(f"outside the proof: {text}" for text in record.outside),
    )


def _sample_time(record: ExportRecord) -> str:
    if record.sample_time is None:
        return "none, the statement is about continuous time"
    text = f"{record.sample_time.exact} s"
    if record.delay is None:
        return text
    least, most = record.delay
    ages = str(least) if least == most else f"{least} to {most}"
    text = f"{text}, force sample {ages} sample{'' if most == 1 else 's'} old"
    return text if record.timing is None else f"{text}; {record.timing}"
