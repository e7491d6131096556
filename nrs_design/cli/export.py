"""``nrs-design export``: the gains that ship, for other programs; only with their proof."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.options import Json, Quiet, SpecFile
from nrs_design.cli.printing import note, print_json, progress, say
from nrs_design.errors import OutputError

if TYPE_CHECKING:
    from nrs_design.exporters.export import Export


class ExportFormat(StrEnum):
    """Formats by name."""

    JSON = "json"


def export(
    spec: SpecFile,
    format_: Annotated[
        ExportFormat, typer.Option("--format", help="Format of the file.")
    ] = ExportFormat.JSON,
    certificate: Annotated[
        Path | None,
        typer.Option(help="Certificate of this design; without it, the design is certified."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="File; default reports/NAME.export.json.")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Export the designed gains, exactly and as float32, together with what is proved of them.

    A design that is refuted (exit code 1) or inconclusive (3) is not exported.

    Example: nrs-design export specs/neuroboscope/soft-tissue.nrs.yaml --format json
    """
    from nrs_design.exporters.export import export_design
    from nrs_design.output import EXPORT, check_replaceable
    from nrs_design.ownership import check_certificate
    from nrs_design.spec import read_spec

    loaded = read_spec(spec)
    name = loaded.spec.name
    file = out or Path("reports") / f"{name}.export.{format_}"
    proof = certificate or file.parent / f"{name}.cert.json"
    if file.resolve() == proof.resolve():
        raise OutputError("is the certificate file", path=file, remedy="choose another --out")
    check_replaceable(file, EXPORT)
    check_certificate(spec, file.parent / f"{name}.cert.json")
    with progress(f"exporting {name}", quiet=quiet) as step:
        result = export_design(loaded, certificate, step)
    _write(result, file, None if certificate else proof, spec)
    if as_json:
        print_json("export", _summary(name, result, file, proof))
    elif result.record is None:
        # Nothing was written, which is an error of its own.
        note(f"{name}: not exported: {result.reason}")
    elif not quiet:
        say(f"{name}: PROVED, exported to {file}", verdict="proved")
        note(f"certificate: {proof}")
    raise typer.Exit(exit_codes.OF_VERDICT.get(result.verdict, exit_codes.REFUTED))


def _write(result: Export, file: Path, proof: Path | None, spec: Path) -> None:
    """Write the certificate first: there is never an export without its proof."""
    from nrs_design.certificates.certificate import dump
    from nrs_design.exporters.record import dump_record
    from nrs_design.output import CERTIFICATE, EXPORT, write_output
    from nrs_design.ownership import origin_of

    if result.record is None or result.certificate is None:
        return
    if proof is not None:
        text = dump(result.certificate, origin_of(spec, proof))
        write_output(proof, text, replaces=CERTIFICATE)
    write_output(file, dump_record(result.record), replaces=EXPORT)


def _summary(name: str, result: Export, file: Path, proof: Path) -> dict[str, Any]:
    record = result.record
    return {
        "spec": name,
        "verdict": result.verdict,
        "reason": result.reason or None,
        "file": str(file) if record else None,
        "certificate": str(proof) if record else None,
        "record": record.model_dump(mode="json", by_alias=True) if record else None,
    }
