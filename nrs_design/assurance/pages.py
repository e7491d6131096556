"""The pages of a case in Markdown: plain tables that a diff shows line by line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from hashlib import sha256

from nrs_design.assurance.case import Case
from nrs_design.assurance.hazards import TracedHazard, ended_in
from nrs_design.assurance.register import RegisterRow
from nrs_design.assurance.standards import standards, support_of
from nrs_design.assurance.steps import STEPS, user_steps
from nrs_design.gating.obligations import Obligation
from nrs_design.printable import visible
from nrs_design.proof.text import counted

NO_CLAIM = (
    "A help to find what can support which clause. It is no claim of conformity, neither of this "
    "program nor of the device: what a clause asks for, and whether it is met, its maker says."
)
_NONE = "–"


def start_page(case: Case) -> str:
    """Return README.md: what is claimed, how it stands, what is open, how to check it."""
    return _page(
        f"Evidence for {case.name}",
        *([case.title] if case.title else []),
        *([f"Date: {case.date}"] if case.date else []),
        f"**Proved.** {visible(case.claim)}",
        *(f"**Shown, too.** {visible(claim)}" for claim in case.also),
        "\n".join(f"- {line}" for line in _standing(case)),
        f"Spec: SHA-256 `{case.spec_sha256}`. Certificate: id `{case.certificate_id}`, made by "
        f"nrs-design {case.certificate.version}; this folder by nrs-design {case.decider.release}.",
        "## Outside of the proof",
        "\n".join(f"- {text}" for text in case.outside) or "Whether the matrices are those of it.",
        *_gains(case),
        "## Files",
        _table(("file", "what"), _FILES),
        "## Check it",
        "`nrs-design evidence --check FOLDER` compares every hash, proves the certificate again "
        "for the spec in this folder, and makes every page again. `sha256sum -c SHA256SUMS` "
        "compares hashes only: whoever changes a file can change its hash, too.",
    )


_FILES = (
    ("`assumptions.md`", "register of what the proof takes for granted, with tests and results"),
    ("`hazards.md`", "hazards, traced to goals, limits, gains, assumptions, tests, program"),
    ("`argument.svg`, `argument.txt`", "why it holds of the robot, in Goal Structuring Notation"),
    ("`standards.md`", "which file can support which clause"),
    ("`tool.md`, `sbom.cdx.json`", "what in the tool decides; its parts (CycloneDX)"),
    ("`evidence.json`", "the same facts for programs"),
    ("`*.cert.json`, `spec/`", "certificate, and what it is about"),
    ("`program/`", "source, vectors, self-test, monitor; only where the sampled loop is proved"),
    ("`results.yaml`, `results-to-do.yaml`", "what users found; what is left, to fill in"),
    ("`build.json`", "record of a build, where one was named"),
    ("`SHA256SUMS`", "hashes of all files"),
)


def _standing(case: Case) -> Iterator[str]:
    yield f"Obligations of the gate: {ended_in(case.obligations)}."
    for item in case.missed:
        yield f"**{item.status}**: {item.subject}: {visible(item.message)}"
    settled = sum(row.settled for row in case.register)
    yield f"Assumptions: {settled} of {len(case.register)} shown."
    if case.failed:
        yield f"**Tests failed**: {', '.join(case.failed)}."
    yield f"Open: {', '.join(case.open) or 'nothing that this tool knows of'}."
    if case.results.by_id and case.results.spec != case.spec_sha256:
        yield f"**Results are of another spec** (SHA-256 `{case.results.spec}`), and do not count."
    yield f"Program: {f'none, since {case.no_program}' if case.no_program else 'in `program/`'}."


def _gains(case: Case) -> Iterator[str]:
    if case.gains:
        yield "## Gains that are proved"
        rows = (
            (name, gain, value, case.units[name][gain])
            for name, gains in case.gains.items()
            for gain, value in gains.items()
        )
        yield _table(("controller", "gain", "value", "unit"), rows)


def register_page(case: Case) -> str:
    """Return assumptions.md."""
    return _page(
        f"What the proof of {case.name} takes for granted",
        "One row for each id; a test covers all sentences of its row.",
        _table(
            ("id", "covered by", "state", "test", "result"),
            (
                (f"`{row.id}`", row.covered_by, row.state, row.kind.test, _result(row))
                for row in case.register
            ),
        ),
        *map(_assumption, case.register),
        "## Steps to the robot",
        _table(
            ("id", "what", "how", "state", "result"),
            (
                (f"`{id}`", *STEPS[id], case.states[id], _found(case, id))
                for id in user_steps(case.program)
            ),
        ),
    )


def _assumption(row: RegisterRow) -> str:
    lines = [f"## `{row.id}`: {row.kind.name}", *map(visible, row.statements)]
    lines.append(f"Within: {visible('; '.join(row.bounds))}. If false: {row.kind.breaks}")
    return "\n\n".join(lines)


def _result(row: RegisterRow) -> str:
    return _NONE if row.test is None else row.test.said


def _found(case: Case, id: str) -> str:
    return case.results.by_id[id].said if id in case.results.by_id else _NONE


def hazard_page(case: Case) -> str:
    """Return hazards.md."""
    return _page(
        f"Hazards of the control law of {case.name}",
        "A start for a risk file, not the whole of it: hazards of which this tool knows "
        "something. It estimates neither severity nor probability. A goal that is *met* was "
        "computed in floating point; one that is *proved* was decided exactly.",
        _table(
            ("hazard", "what", "goals", "open assumptions", "failed tests"),
            (
                (
                    f"`{h.hazard.id}`",
                    h.hazard.name,
                    _tally(h.obligations),
                    ", ".join(h.unsettled) or _NONE,
                    ", ".join(h.failed) or _NONE,
                )
                for h in case.hazards
            ),
        ),
        *map(_hazard, case.hazards),
        "## Program",
        _program(case),
    )


def _tally(obligations: Sequence[Obligation]) -> str:
    return ended_in(obligations) if obligations else "no goal is set"


def _hazard(traced: TracedHazard) -> str:
    lines = [f"- How: {traced.hazard.events}"]
    lines += [
        f"- {item.rule.id} {item.subject}: **{item.status}**, {visible(item.message)}"
        for item in traced.obligations
    ]
    lines.append(f"- Limits of the spec: {visible('; '.join(traced.limits)) or 'none'}")
    lines.append(f"- Gains: {'; '.join(traced.gains) or 'none: matrices are given'}")
    told = (f"{row.id} ({row.state})" for row in traced.assumptions)
    lines.append(f"- Assumptions: {', '.join(told) or 'none of its own'}")
    lines.append(f"- Told by the monitor: {', '.join(traced.watched) or 'nothing'}")
    return f"## `{traced.hazard.id}`\n\n" + "\n".join(lines)


def _program(case: Case) -> str:
    told = "All gains above are in these files." if case.program else f"None: {case.no_program}."
    files = ((name, sha256(content).hexdigest()) for name, content in sorted(case.program.items()))
    rows = [(f"`program/{name}`", hashed) for name, hashed in files]
    rows += [
        (f"`{visible(file.name)}`, named by the user, {file.size} bytes", file.sha256)
        for file in case.binaries
    ]
    if case.build is not None:
        told += f" Build: {visible(case.build.said)}."
        others = ", ".join(case.build.others)
        told += f" **It took another {others} than the one here.**" if others else ""
        told += f" Not looked at: {visible('; '.join(case.build.record.not_compared))}."
        rows += [
            (f"`{visible(name)}`, as build.json says", visible(hashed))
            for name, hashed in sorted(case.build.record.compiled.items())
        ]
    if case.binaries:
        told += " What was named by the user is told by its hash; nothing here has looked inside."
    return told + ("\n\n" + _table(("file", "SHA-256"), rows) if rows else "")


def standards_page(case: Case, files: Iterable[str]) -> str:
    """Return standards.md.

    Parameters
    ----------
    case : Case
        The case.
    files : iterable of str
        Paths of all files of the folder.
    """
    files = tuple(files)
    parts = [f"Clauses that files of {case.name} can support", NO_CLAIM]
    for standard in standards():
        parts.append(f"## {standard.name}\n\nOn {standard.about}.")
        rows = (
            (row.clause, support_of(row, case.name, files), row.can, row.user)
            for row in standard.row
        )
        parts.append(_table(("clause", "files", "what they can support", "left to you"), rows))
    return _page(*parts)


def tool_page(case: Case) -> str:
    """Return tool.md: what decides, and how that is known to be right."""
    decides = case.decider
    record = decides.mutation
    if record is None:
        mutants = "This release ships no record of a mutation run."
    else:
        mutants = (
            f"Every small error was made in it, one at a time: {record.mutants} mutants, "
            f"{record.killed} noticed by a test, {record.equivalent} that decide the same (each "
            f"listed with its reason), {record.unnoticed} unnoticed."
        )
        if not decides.examined:
            mutants += f" **That was with other files** (SHA-256 `{record.sha256}`)."
    return _page(
        f"What decides in nrs-design {decides.release}",
        "Searches, solvers and designs propose; none of them is believed. These "
        f"{len(decides.files)} files, {decides.lines} lines, decide; beside Python's standard "
        f"library they import {', '.join(decides.imports) or 'nothing'}. They are what to "
        "qualify, by their own tests and by programs that decide the same.",
        f"SHA-256 over all of them: `{decides.sha256}`.",
        "## Believed beside it",
        "A certificate holds its modes, and these files decide about them. That the modes are "
        "those of the spec rests on more of this program; the tests hold it against formulas and "
        "runs, and no second program decides it.",
        _table(("what it does", "lines"), ((w, str(n)) for w, n in decides.believed.items())),
        f"## Mutation record\n\n{mutants}",
        "## Programs that decide the same",
        _table(
            ("program", "shares", "state"),
            (
                ("python-flint", "the reader of certificates", "asked at every check; a veto"),
                (
                    "`check_elsewhere.py` of the documentation",
                    "nothing but Python",
                    f"id `tool.independent-check`: {case.states['tool.independent-check']}",
                ),
            ),
        ),
        "## Files that decide",
        _table(
            ("file", "lines", "SHA-256"),
            ((f"`{f.path}`", str(f.lines), f"`{f.sha256}`") for f in decides.files),
        ),
    )


def form_page(case: Case) -> str:
    """Return results-to-do.yaml: every id without a result that counts, to be filled in."""
    head = (
        f"# {counted(len(case.open), 'result')} to find. Copy this file out of the folder, fill "
        "in what you have tested,\n# delete the rest, and name it: nrs-design evidence SPEC --out "
        "FOLDER --results FILE\n"
    )
    if not case.open:
        return f'{head}spec: "{case.spec_sha256}"\nresults: {{}}\n'
    lines = [f'spec: "{case.spec_sha256}"', "results:"]
    how = {row.id: row.kind.test for row in case.register} | {
        id: STEPS[id][1] for id in user_steps(case.program)
    }
    for id in case.open:
        lines += [f"  # {how[id]}", f'  {id}: {{result: "", date: "", reference: ""}}']
    return head + "\n".join(lines) + "\n"


def _page(title: str, *parts: str) -> str:
    return "\n\n".join((f"# {title}", *parts)) + "\n"


def _table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines)


def _cell(text: str) -> str:
    return visible(text).replace("|", "\\|")
