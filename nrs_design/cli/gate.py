"""``nrs-design gate``: every proof obligation of a project, for CI."""

from __future__ import annotations

import sys
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Literal, NoReturn

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import command
from nrs_design.cli.options import Budget, Memory, refuse_both
from nrs_design.cli.printing import note, progress, say, say_failure, wants_details, wants_json
from nrs_design.cli.tables import print_table
from nrs_design.errors import NrsDesignError, OutputError
from nrs_design.proof.text import counted

if TYPE_CHECKING:
    from nrs_design.gating.obligations import Caution, GateOutcome

GateFormat = Literal["text", "github", "sarif", "junit", "json", "markdown"]
# Folders that a note lists by name.
MAX_FOLDERS = 5


@command("gate")
def gate(
    paths: Annotated[
        list[Path], typer.Argument(metavar="PATH...", help="Spec files, or folders of them.")
    ],
    format_: Annotated[GateFormat, typer.Option("--format", help="What to print.")] = "text",
    out: Annotated[Path | None, typer.Option(help="Write it to this file, not to stdout.")] = None,
    locked: Annotated[
        bool,
        typer.Option("--locked", help="Only re-check what is locked: no solver, nothing written."),
    ] = False,
    lock: Annotated[Path, typer.Option(help="Lock file.")] = Path("nrs.lock"),
    prune: Annotated[
        bool, typer.Option("--prune", help="Drop what is locked for specs that no longer exist.")
    ] = False,
    reports: Annotated[
        Path,
        typer.Option(
            "--reports", help="Folder for certificates and HTML reports, below that of --lock."
        ),
    ] = Path("reports"),
    no_reports: Annotated[
        bool, typer.Option("--no-reports", help="Write certificates, but no HTML reports.")
    ] = False,
    pages: Annotated[
        bool,
        typer.Option(
            "--pages", help="Write the HTML report of every spec, too of what is as recorded."
        ),
    ] = False,
    jobs: Annotated[int, typer.Option(min=1, help="How many processes.")] = 1,
    against: Annotated[
        Path | None,
        typer.Option(
            metavar="BASE",
            help="Folder like this one, such as a checkout of the base branch: say what is weaker "
            "here than there, and fail on it.",
        ),
    ] = None,
    budget: Budget = None,
    memory: Memory = None,
) -> NoReturn:
    """Certify every spec, write certificates, reports and the lock file, and fail closed.

    A certificate in the folder that still holds is kept, and not searched for again; --budget and
    --memory always search. Reports are written of what is new or not fulfilled.

    The lock file keeps its entries for other specs, and no file of another spec is overwritten.

    The exit code is that of the worst obligation: 4 before 2 before 1 before 3 before 0.

    Example: nrs-design gate specs

    Example: nrs-design gate --locked --format github specs

    Example: nrs-design gate --locked --against ../base specs
    """
    from nrs_design.gating.find_specs import find_specs
    from nrs_design.output import LOCK, check_place

    output_format = format_of(format_)
    _check_options(out, jobs, locked=locked, prune=prune)
    refuse_both(("--pages", "--no-reports", pages and no_reports))
    refuse_both(("--pages", "--locked", pages and locked))
    start = perf_counter()
    if against is not None:
        from nrs_design.gating.against import base_paths

        # Refuse paths outside the folder before minutes of search. A lock file outside both folders
        # would be compared with itself.
        base_paths([*paths, lock], against)
    specs = find_specs(paths)
    if locked:
        from nrs_design.gating.lock import read_lock
        from nrs_design.gating.locked import run_locked

        content = read_lock(lock)
        with progress("gate") as step:
            outcome = run_locked(specs, content, lock, step, paths=paths)
    else:
        from nrs_design.gating.lock import read_lock_if_any
        from nrs_design.gating.renew import check_folder, recorded_in, write_lock
        from nrs_design.gating.run import Files, run_gate
        from nrs_design.pipeline.certification import Overrides

        check_folder(reports, lock)
        check_place(lock, LOCK)
        known = recorded_in(read_lock_if_any(lock), lock)
        files = Files(folder=reports, html=not no_reports, every_page=pages, locked=known)
        with progress("gate") as step:
            outcome = run_gate(specs, files, step, Overrides(budget=budget, memory=memory), jobs)
        outcome = write_lock(outcome, lock, prune=prune)
    outcome = _note_unread_paths(outcome, paths)
    if against is not None:
        from nrs_design.gating.against import compare_with_base

        outcome = compare_with_base(outcome, paths, against, lock)
    cautions = outcome.cautions
    for item in cautions[:1]:
        _warn(item)
    _deliver(outcome, output_format, out)
    printed_cautions = [item for item in cautions[1:] if wants_details() or not item.beyond]
    for item in printed_cautions:
        _warn(item)
    hidden = len(cautions[1:]) - len(printed_cautions)
    if hidden:
        note(f"note: {counted(hidden, 'more remark')} on designs, as `optimize` lists them (or -v)")
    for text in outcome.notes:
        note(f"note: {text}")
    note(f"{perf_counter() - start:.1f} s")
    raise typer.Exit(exit_codes.SEVERITY_CODES[outcome.severity])


def _warn(item: Caution) -> None:
    note(f"warning: {item.path}:{item.line}:{item.column}: {item.message}")


def format_of(format_: GateFormat) -> GateFormat:
    """Return the requested format; --json stands for ``--format json``."""
    as_json = wants_json()
    refuse_both(("--json", f"--format {format_}", as_json and format_ not in ("text", "json")))
    return "json" if as_json else format_


def _check_options(out: Path | None, jobs: int, *, locked: bool, prune: bool) -> None:
    """Refuse contradicting options and foreign output files before the work."""
    from nrs_design.gating.find_specs import SUFFIXES
    from nrs_design.output import GATE, check_place

    refuse_both(("--prune", "--locked", prune and locked), reason=": --locked writes nothing")
    if jobs > 1 and locked:
        raise NrsDesignError(
            "--jobs and --locked exclude each other: re-checking takes no search",
            remedy="leave --jobs out",
        )
    if out is not None and out.name.lower().endswith(SUFFIXES):
        raise OutputError("is the name of a spec", path=out, remedy="choose another --out")
    if out is not None:
        check_place(out, GATE)


def _deliver(outcome: GateOutcome, output_format: GateFormat, out: Path | None) -> None:
    """Write the document to stdout or the file --out, and a summary to the terminal."""
    from nrs_design.gating.formats import FORMATS
    from nrs_design.gating.formats.text import summary_line
    from nrs_design.output import GATE, write_output

    if out is None and output_format == "text":
        _show(outcome)
        return
    document = FORMATS[output_format](outcome)
    if out is None:
        sys.stdout.write(document)
    else:
        write_output(out, document, replaces=GATE)
    note(summary_line(outcome))


def _show(outcome: GateOutcome) -> None:
    """Print for people: what is not fulfilled, and the sum; with -v every spec and its gains."""
    from nrs_design.gating.formats import text

    if wants_details():
        print_table("", text.COLUMNS, text.rows_of(outcome))
        for line in (*text.gain_lines(outcome), ""):
            say(line)
    for item in outcome.findings:
        say_failure(text.line_of(item), str(item.status))
    for line in (*text.change_lines(outcome), text.summary_line(outcome)):
        say(line)


def _note_unread_paths(outcome: GateOutcome, paths: list[Path]) -> GateOutcome:
    from nrs_design.gating.find_specs import SUFFIXES, find_misnamed, find_passed_over

    for reason, found in {
        "not looked into (hidden, or a link)": find_passed_over(paths),
        f"not examined, for want of a name that ends in {SUFFIXES[0]}": find_misnamed(paths),
    }.items():
        if found:
            names = ", ".join(path.as_posix() for path in found[:MAX_FOLDERS])
            omission = f" and {len(found) - MAX_FOLDERS} more" if len(found) > MAX_FOLDERS else ""
            outcome = outcome.with_note(f"{reason}: {names}{omission}")
    return outcome
