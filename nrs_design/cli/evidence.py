"""``nrs-design evidence``: the file of a device, as far as control goes, and its check."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import note, progress, say, say_failure
from nrs_design.cli.reading import take_spec
from nrs_design.errors import NrsDesignError

if TYPE_CHECKING:
    from nrs_design.assurance.case import Case, Given, UserFile
    from nrs_design.assurance.check import FolderCheck
    from nrs_design.pipeline import Result
    from nrs_design.spec import LoadedSpec


@command("evidence")
def evidence(
    spec: Annotated[
        Path | None, typer.Argument(metavar="SPEC", help="Spec file (*.nrs.yaml).")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder to write: new, empty, or evidence of this spec.")
    ] = None,
    check: Annotated[
        Path | None,
        typer.Option(help="Folder to check; with SPEC, that it is about what SPEC says now."),
    ] = None,
    certificate: Annotated[
        Path | None,
        typer.Option(help="Certificate of this design; without it, the design is certified."),
    ] = None,
    results: Annotated[
        Path | None,
        typer.Option(help="What you found by testing: YAML, as results-to-do.yaml in the folder."),
    ] = None,
    build: Annotated[
        Path | None,
        typer.Option(help="Record of a build, NAME.binary.json, as verify --deployed writes it."),
    ] = None,
    binary: Annotated[
        list[Path] | None,
        typer.Option(help="A file that runs on the robot; kept as its hash. May be repeated."),
    ] = None,
    date: Annotated[
        str | None, typer.Option(help="Date to write, as 2026-01-31; none by default.")
    ] = None,
) -> Answer:
    """Write a folder of evidence for a proved design, or check one.

    Claim, register of assumptions, hazards, argument, clauses of standards, parts list, program and
    hashes. Nothing is claimed for the maker of the device. Exit code: 1 if a goal is missed or a
    test failed, 3 if a goal is not proved; the folder is written. With --check, 1 if the folder is
    rejected, 3 if its pages cannot be compared.

    Example: nrs-design evidence specs/neuroboscope/soft-tissue-sampled.nrs.yaml --out evidence

    Example: nrs-design evidence --check evidence
    """
    if (out is None) == (check is None):
        raise NrsDesignError("name one of --out and --check", remedy="--out writes, --check checks")
    files = [*map(_user_file, binary or ())]
    if check is not None:
        if any(given is not None for given in (certificate, results, build, date)):
            message = "--certificate, --results, --build and --date are for writing"
            raise NrsDesignError(message, remedy="the folder has its own: leave them out")
        return _check(check, spec, files)
    if spec is None or out is None:
        raise NrsDesignError("no spec is named", remedy="name the spec that the folder is about")
    from nrs_design.assurance.case import Given

    return _write(spec, out, certificate, Given(results, build, tuple(files), _day(date)))


def _user_file(path: Path) -> UserFile:
    import hashlib

    from nrs_design.assurance.case import UserFile
    from nrs_design.assurance.sources import read_file

    content = read_file(path)
    return UserFile(path.name, len(content), hashlib.sha256(content).hexdigest())


def _day(text: str | None) -> str:
    from datetime import date

    try:
        return "" if text is None else date.fromisoformat(text).isoformat()
    except ValueError:
        raise NrsDesignError(
            f"{text!r} is no date", remedy="write --date as in 2026-01-31"
        ) from None


def _write(spec: Path, out: Path, certificate: Path | None, given: Given) -> Answer:
    from nrs_design.assurance.case import build_case
    from nrs_design.assurance.contents import contents_of
    from nrs_design.assurance.folder import check_free, write_folder
    from nrs_design.assurance.sources import sources_of
    from nrs_design.gating.judge import judge_result

    loaded = take_spec(spec)
    name = loaded.spec.name
    # Refuse what cannot be written before minutes of search.
    check_free(out, name)
    with progress(f"evidence for {name}") as step:
        result = _certified(loaded, certificate, step)
        verdict = result.certification.verdict
        if result.certificate is None or verdict != "proved":
            return _refused(name, verdict)
        case = build_case(result, judge_result(result, step), given, step)
        step("pages")
        contents = contents_of(case, *sources_of(loaded))
        write_folder(out, name, contents)
    facts = {**_facts(case), "folder": str(out), "files": [*contents]}
    return Answer(lambda: facts, lambda: _show(case, out, len(contents)), _code(case))


def _certified(loaded: LoadedSpec, certificate: Path | None, step: Any) -> Result:
    from nrs_design.pipeline import run_certification, run_recorded

    if certificate is not None:
        return run_recorded(loaded, certificate, step)
    return run_certification(loaded, progress=step)


def _refused(name: str, verdict: str) -> Answer:
    reason = f"the design is not proved: {verdict}"
    return Answer(
        lambda: {"spec": name, "verdict": str(verdict), "folder": None, "reason": reason},
        lambda: note(f"{name}: no evidence written: {reason} (nrs-design report shows why)"),
        exit_codes.OF_VERDICT[verdict],
        loud=True,
    )


def _facts(case: Case) -> dict[str, Any]:
    return {
        "spec": case.name,
        "spec_sha256": case.spec_sha256,
        "verdict": "proved",
        "certificate_id": case.certificate_id,
        "missed": [f"{item.rule.id} {item.subject}" for item in case.missed],
        "failed": case.failed,
        "open": case.open,
        "results_of_this_spec": case.results.spec in ("", case.spec_sha256),
        "program": sorted(case.program),
        "no_program": case.no_program or None,
    }


def _code(case: Case) -> int:
    worst = max((item.severity for item in case.missed), default=0)
    return exit_codes.REFUTED if case.failed else exit_codes.OF_SEVERITY[worst]


def _show(case: Case, folder: Path, files: int) -> None:
    say(f"{case.name}: PROVED, evidence in {folder} ({files} files)", verdict="proved")
    _show_state(case)


def _show_state(case: Case) -> None:
    for item in case.missed:
        say_failure(f"{item.status}: {item.subject}: {item.message}", item.status)
    for id in case.failed:
        say_failure(f"failed: {id}: {case.results.by_id[id].said}", "refuted")
    if case.results.by_id and case.results.spec != case.spec_sha256:
        note("the results were found with another spec, so none of them counts as passed")
    settled = sum(row.settled for row in case.register)
    say(f"assumptions: {settled} of {len(case.register)} shown; open: {len(case.open)} ids")
    say(f"program: {f'none, since {case.no_program}' if case.no_program else 'in program/'}")


def _check(folder: Path, spec: Path | None, binaries: list[UserFile]) -> Answer:
    from nrs_design.assurance.check import check_evidence

    with progress(f"checking {folder}") as step:
        found = check_evidence(folder, spec, binaries, step)
    codes = {
        "holds": exit_codes.PROVED,
        "rejected": exit_codes.REFUTED,
        "inconclusive": exit_codes.INCONCLUSIVE,
    }
    return Answer(
        lambda: _check_facts(found),
        lambda: _show_check(found, folder),
        codes[found.verdict],
        loud=found.verdict != "holds",
    )


def _check_facts(found: FolderCheck) -> dict[str, Any]:
    state = {} if found.case is None else _facts(found.case)
    return {
        **state,
        "spec": found.name,
        "check": found.verdict,
        "faults": found.faults,
        "undecided": found.undecided or None,
        "notes": found.notes,
        "files": found.files,
    }


def _show_check(found: FolderCheck, folder: Path) -> None:
    for fault in found.faults:
        say_failure(f"rejected: {fault}", "rejected")
    if found.faults:
        return
    if found.undecided:
        say(f"{found.name}: INCONCLUSIVE: hashes and certificate hold; {found.undecided}")
        return
    say(f"{found.name}: {folder} holds: {found.files} files, certificate checked, pages made again")
    for text in found.notes:
        note(text)
    if found.case is not None:
        _show_state(found.case)
