"""``nrs-design gate``: every proof obligation of a project, for CI."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.options import Budget, Json, MaxDegree, Memory, Quiet
from nrs_design.cli.printing import note, progress, say, say_failure
from nrs_design.cli.tables import print_table
from nrs_design.errors import NrsDesignError, OutputError

if TYPE_CHECKING:
    from nrs_design.gating.obligations import GateOutcome

# Highest degree, budget and memory, as far as they are given.
SearchLimits = tuple[int | None, float | None, float | None]

# By severity of the worst obligation, from none to a defect of this program.
OF_SEVERITY = (
    exit_codes.PROVED,
    exit_codes.INCONCLUSIVE,
    exit_codes.REFUTED,
    exit_codes.USAGE,
    exit_codes.INTERNAL,
)

# Folders that a note lists by name.
SHOWN = 5


class GateFormat(StrEnum):
    """Formats by name."""

    TEXT = "text"
    GITHUB = "github"
    SARIF = "sarif"
    JUNIT = "junit"
    JSON = "json"


def gate(
    paths: Annotated[
        list[Path], typer.Argument(metavar="PATH...", help="Spec files, or folders of them.")
    ],
    format_: Annotated[
        GateFormat, typer.Option("--format", help="What to print.")
    ] = GateFormat.TEXT,
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
    against: Annotated[
        Path | None,
        typer.Option(
            metavar="BASE",
            help="Folder like this one, such as a checkout of the base branch: say what is weaker "
            "here than there, and fail on it.",
        ),
    ] = None,
    max_degree: MaxDegree = None,
    budget: Budget = None,
    memory: Memory = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Certify every spec, write certificates, reports and the lock file, and fail closed.

    The lock file keeps its entries for other specs, and no file of another spec is overwritten.

    The exit code is that of the worst obligation: 4 before 2 before 1 before 3 before 0.

    Example: nrs-design gate specs

    Example: nrs-design gate --locked --format github specs

    Example: nrs-design gate --locked --against ../base specs
    """
    chosen = format_of(format_, as_json=as_json)
    _check_options(out, locked=locked, prune=prune)
    search = (max_degree, budget, memory)
    start = perf_counter()
    if against is not None:
        from nrs_design.gating.against import base_paths

        # What cannot be compared is said before minutes of search.
        base_paths(paths, against)
    outcome = (
        _re_check(paths, lock, quiet=quiet)
        if locked
        else _certify(paths, lock, reports, search, html=not no_reports, prune=prune, quiet=quiet)
    )
    if against is not None:
        from nrs_design.gating.against import compare_with_base

        outcome = compare_with_base(outcome, paths, against, lock)
    _deliver(outcome, chosen, out, quiet=quiet)
    _note(outcome, quiet=quiet)
    note(f"{perf_counter() - start:.1f} s", quiet=quiet)
    raise typer.Exit(OF_SEVERITY[outcome.severity])


def format_of(format_: GateFormat, *, as_json: bool) -> GateFormat:
    """Return the format that is asked for; --json is short for one of them.

    Raises
    ------
    NrsDesignError
        If both ask for different things.
    """
    if as_json and format_ not in (GateFormat.TEXT, GateFormat.JSON):
        raise NrsDesignError(
            f"--json and --format {format_} exclude each other", remedy="keep one of them"
        )
    return GateFormat.JSON if as_json else format_


def _check_options(out: Path | None, *, locked: bool, prune: bool) -> None:
    """Refuse what excludes each other, and what must not be overwritten, before the work."""
    from nrs_design.gating.find_specs import SUFFIXES
    from nrs_design.output import GATE, check_place

    if prune and locked:
        raise NrsDesignError(
            "--prune and --locked exclude each other: --locked writes nothing",
            remedy="keep one of them",
        )
    if out is not None and out.name.lower().endswith(SUFFIXES):
        raise OutputError("is the name of a spec", path=out, remedy="choose another --out")
    if out is not None:
        check_place(out, GATE)


def _deliver(outcome: GateOutcome, chosen: GateFormat, out: Path | None, *, quiet: bool) -> None:
    """Write the document to where it is wanted; people see a text, too."""
    from nrs_design.gating.formats import FORMATS
    from nrs_design.output import GATE, write_output

    document = FORMATS[chosen](outcome)
    if out is not None:
        write_output(out, document, replaces=GATE)
    elif chosen is GateFormat.TEXT:
        _show(outcome, document, quiet=quiet)
    else:
        sys.stdout.write(document)
    if out is not None or chosen is not GateFormat.TEXT:
        for line in FORMATS["text"](outcome).split("\n"):
            note(line, quiet=quiet)


def _note(outcome: GateOutcome, *, quiet: bool) -> None:
    """Say what is doubtful, and what a person should know beside it."""
    for item in (caution for spec in outcome.specs for caution in spec.cautions):
        note(f"warning: {item.path}:{item.line}:{item.column}: {item.message}", quiet=quiet)
    for text in outcome.notes:
        note(f"note: {text}", quiet=quiet)


def _show(outcome: GateOutcome, document: str, *, quiet: bool) -> None:
    """Print for people: what is not fulfilled, and the rest too unless it shall be quiet."""
    from nrs_design.gating.formats import text

    if not (quiet or sys.stdout.isatty()):
        sys.stdout.write(document)
        return
    if not quiet:
        print_table("", text.COLUMNS, text.rows_of(outcome))
        for line in text.gain_lines(outcome):
            say(line)
    if outcome.broken and not quiet:
        say()
    for item in outcome.broken:
        say_failure(text.line_of(item), str(item.status))
    if not quiet:
        for line in text.change_lines(outcome):
            say(line)
        say()
        say(text.summary_line(outcome))


def _certify(
    paths: list[Path],
    lock: Path,
    reports: Path,
    search: SearchLimits,
    *,
    html: bool,
    prune: bool,
    quiet: bool,
) -> GateOutcome:
    from nrs_design.gating.find_specs import find_specs
    from nrs_design.gating.lock import read_lock_if_any
    from nrs_design.gating.renew import bounds_of, certificates_of, check_folder, write_lock
    from nrs_design.gating.run import Files, run_gate
    from nrs_design.output import LOCK, check_place
    from nrs_design.pipeline import Overrides

    specs = find_specs(paths)
    check_folder(reports, lock)
    check_place(lock, LOCK)
    known = read_lock_if_any(lock)
    with progress("gate", quiet=quiet) as step:
        files = Files(reports, html, certificates_of(known, lock), bounds_of(known))
        outcome = run_gate(specs, files, step, Overrides(*search))
    return _with_not_examined(write_lock(outcome, lock, prune=prune), paths)


def _re_check(paths: list[Path], lock: Path, *, quiet: bool) -> GateOutcome:
    from nrs_design.gating.find_specs import find_specs
    from nrs_design.gating.lock import read_lock
    from nrs_design.gating.locked import run_locked

    specs, content = find_specs(paths), read_lock(lock)
    with progress("gate", quiet=quiet) as step:
        outcome = run_locked(specs, content, lock, step, named=paths)
    return _with_not_examined(outcome, paths)


def _with_not_examined(outcome: GateOutcome, paths: list[Path]) -> GateOutcome:
    from nrs_design.gating.find_specs import SUFFIXES, find_misnamed, find_passed_over

    for why, found in {
        "not looked into (hidden, or a link)": find_passed_over(paths),
        f"not examined, for want of a name that ends in {SUFFIXES[0]}": find_misnamed(paths),
    }.items():
        if found:
            outcome = outcome.with_note(f"{why}: {_listed(found)}")
    return outcome


def _listed(paths: tuple[Path, ...]) -> str:
    more = f" and {len(paths) - SHOWN} more" if len(paths) > SHOWN else ""
    return ", ".join(path.as_posix() for path in paths[:SHOWN]) + more
