"""``nrs-design export``: the gains that ship, for other programs; only with their proof."""

from __future__ import annotations

import os
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.printing import note, progress, say
from nrs_design.cli.tables import print_table
from nrs_design.errors import NrsDesignError, OutputError
from nrs_design.exporters import Format, format_names, format_of, known_format

if TYPE_CHECKING:
    from nrs_design.exporters.export import Execution, Export
    from nrs_design.pipeline.runs import Recorded


# Another command writes this format, because it proves another law.
ROS2: dict[str, Any] = {
    "name": "ros2",
    "purpose": "impedance controllers as parameters of admittance_controller of ROS 2",
    "needs": "a proof of that controller's law (ros2 export)",
    "files": ["NAME.CONTROLLER.ros2.yaml"],
}


@command("export")
def export(
    spec: Annotated[
        Path | None, typer.Argument(metavar="SPEC", help="Spec file (*.nrs.yaml).")
    ] = None,
    format_: Annotated[
        str, typer.Option("--format", help=f"Format: {', '.join(format_names())}; see --list.")
    ] = "json",
    list_: Annotated[
        bool, typer.Option("--list", help="List the formats, what each is for and what it needs.")
    ] = False,
    certificate: Annotated[
        Path | None,
        typer.Option(
            help="Certificate of this design; without it, the one that nrs.lock or the folder "
            "records, if it holds; else the design is certified."
        ),
    ] = None,
    out: Annotated[
        Path, typer.Option(help="Folder; for a format of one file also that file, with its ending.")
    ] = Path("reports"),
    sample_time: Annotated[
        str | None,
        typer.Option(help="Sample time of a program, such as '2 ms', where the spec says none."),
    ] = None,
    unproved: Annotated[
        bool,
        typer.Option(
            "--unproved",
            help="Export a program, too, whose sampled loop is not proved; its files say so, and "
            "the exit code stays that of the verdict.",
        ),
    ] = False,
) -> Answer:
    """Export the designed gains, exactly and as float32, together with what is proved of them.

    A design that is refuted (exit code 1) or inconclusive (3) is not exported. A program that a
    processor runs needs a proof of the sampled loop at its sample time.

    Example: nrs-design export specs/neuroboscope/soft-tissue.nrs.yaml --format json

    Example: nrs-design export --list
    """
    if list_:
        return _list()
    if spec is None:
        raise NrsDesignError("no spec is named", remedy="name one, or list the formats with --list")
    if format_ == "ros2":
        raise NrsDesignError(
            f"{format_} is not a format of this command", remedy="use `nrs-design ros2 export`"
        )
    execution = _execution(known_format(format_), sample_time, unproved=unproved)
    return _export_design(spec, format_, certificate, out, execution)


def _list() -> Answer:
    entries = [
        {
            "name": name,
            "purpose": format_of(name).purpose,
            "needs": format_of(name).needs,
            "files": [f"NAME{ending}" for ending in format_of(name).files],
        }
        for name in format_names()
    ] + [ROS2]
    rows = [(entry["name"], entry["purpose"], entry["needs"]) for entry in entries]
    return Answer(
        lambda: {"formats": entries}, lambda: print_table("", ("format", "what for", "needs"), rows)
    )


def _execution(file_format: Format, sample_time: str | None, *, unproved: bool) -> Execution | None:
    """Return how a program is run; other formats have no such options."""
    from nrs_design.exporters.export import Execution

    if file_format.executable:
        period = None if sample_time is None else _seconds(sample_time)
        return Execution(period, unproved)
    if unproved or sample_time is not None:
        raise NrsDesignError(
            "--unproved and --sample-time are for programs, and this format is not one",
            remedy="leave them out; `nrs-design export --list` lists the formats",
        )
    return None


def _seconds(text: str) -> Fraction:
    from nrs_design.spec import kinds
    from nrs_design.spec.quantity import parse_quantity

    seconds = parse_quantity(text, kinds.DURATION).exact
    if seconds <= 0:
        raise NrsDesignError(f"the sample time {text!r} is not positive", remedy="such as '2 ms'")
    return seconds


def _export_design(
    spec: Path, format_: str, certificate: Path | None, out: Path, execution: Execution | None
) -> Answer:
    from nrs_design.api.exported import Exported
    from nrs_design.certificates.ownership import check_certificate
    from nrs_design.exporters.export import export_design, export_proof
    from nrs_design.exporters.write import check_places, places, write_export
    from nrs_design.pipeline.design import placed

    loaded, file_format = take_spec(spec), format_of(format_)
    name = loaded.spec.name
    files = places(file_format, name, out)
    own_certificate = next(iter(files.values())).parent / f"{name}.cert.json"
    proof = certificate or own_certificate
    for file in files.values():
        if os.path.realpath(file) == os.path.realpath(proof):
            raise OutputError("is the certificate file", path=file, remedy="choose another --out")
    check_places(file_format, files, name)
    check_certificate(spec, own_certificate)
    recorded = None if certificate else _recorded(spec, own_certificate)
    with progress(f"exporting {name}") as step:
        if file_format.needs_proof_only:
            result = export_proof(loaded, certificate, step, recorded)
        else:
            result = export_design(loaded, certificate, step, execution, recorded)
    remarks: tuple[str, ...] = ()
    if result.may_be_written:
        # The error about a design without a program names its place in the spec.
        with placed(loaded):
            remarks = write_export(result, format_, files, None if certificate else proof, spec)
    exported_files = list(files.values()) if result.may_be_written else []
    certified = result.may_be_written and result.certificate is not None
    locations = {
        "file": str(exported_files[0]) if exported_files else None,
        "files": list(map(str, exported_files)),
        "certificate": str(proof) if certified else None,
    }
    return Answer(
        lambda: Exported(loaded, result).to_dict() | locations | {"remarks": remarks},
        lambda: _show(name, result, exported_files, proof, remarks),
        exit_codes.VERDICT_CODES.get(result.verdict, exit_codes.REFUTED),
        # Nothing was written, which is an error of its own.
        loud=not result.may_be_written,
    )


def _recorded(spec: Path, own_certificate: Path) -> Recorded:
    """Return the certificate of a spec in the nrs.lock of this folder; else that in `beside`."""
    from nrs_design.gating.lock import read_lock_if_any
    from nrs_design.gating.renew import recorded_in
    from nrs_design.pipeline.runs import Recorded

    lock = Path("nrs.lock")
    locked = recorded_in(read_lock_if_any(lock), lock)
    return locked.get(Path(os.path.abspath(spec)), Recorded(own_certificate))


def _show(
    name: str, result: Export, exported_files: list[Path], proof: Path, remarks: tuple[str, ...]
) -> None:
    if not result.may_be_written:
        note(f"{name}: not exported: {result.reason}")
        return
    file_names = ", ".join(map(str, exported_files))
    proved = result.verdict == "proved"
    verdict = "PROVED" if proved else f"UNPROVED ({result.reason})"
    say(f"{name}: {verdict}, exported to {file_names}", verdict="proved" if proved else "")
    if result.certificate is not None:
        note(f"certificate: {proof}")
    for remark in remarks:
        note(remark)
