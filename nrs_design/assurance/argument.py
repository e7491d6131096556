"""The argument of a case: why the claim holds of the robot, and what is left open."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from nrs_design.assurance.build import Build
from nrs_design.assurance.case import Case
from nrs_design.assurance.gsn import GsnElement, GsnKind, goal, solution
from nrs_design.assurance.hazards import TracedHazard, ended_in
from nrs_design.assurance.register import RecordState, RegisterRow, recorded_state
from nrs_design.assurance.steps import STEPS, user_steps
from nrs_design.proof.text import counted
from nrs_design.switched.assumption import Standing


def build_argument(case: Case) -> GsnElement:
    """Return the whole argument of a case."""
    strategy = GsnElement(
        "S1",
        GsnKind.STRATEGY,
        "Over the proof, what it takes for granted, the program, the hazards, and the tool",
        (_proof(case), _assumptions(case), _program(case), _hazards(case), _tool(case)),
    )
    top = goal("G1", f"{case.name}: control does what the claim says, on the robot", strategy)
    contexts = (
        _context("C1", f"Spec {case.name}, SHA-256 {case.spec_sha256}"),
        _context("C2", f"Claim: {case.claim}{_more(case)}"),
        _context("C3", "Outside of the claim: what README.md lists as outside of the proof"),
    )
    return replace(top, in_context_of=contexts)


def _more(case: Case) -> str:
    more = len(case.also)
    return f" README.md has {counted(more, 'claim')} more." if more else ""


def _context(id: str, text: str) -> GsnElement:
    return GsnElement(id, GsnKind.CONTEXT, text)


def _proof(case: Case) -> GsnElement:
    made = goal(
        "G2",
        "The loop of the spec, closed with the gains that ship, has the property of the claim",
        solution("Sn2.1", f"{case.name}.cert.json, id {case.certificate_id[:12]}"),
    )
    exact = "Modes are exact; integers decide every condition, and no solver is believed"
    return replace(made, in_context_of=(GsnElement("J2", GsnKind.JUSTIFICATION, exact),))


def _assumptions(case: Case) -> GsnElement:
    shown = sum(row.settled for row in case.register)
    tally = f"{shown} of {len(case.register)} shown"
    goals = tuple(_assumption(f"G3.{k}", row) for k, row in enumerate(case.register, start=1))
    strategy = GsnElement("S3", GsnKind.STRATEGY, "Over each id of assumptions.md", goals)
    return goal("G3", f"What the proof takes for granted is true of the robot ({tally})", strategy)


def _assumption(id: str, row: RegisterRow) -> GsnElement:
    text = f"{row.id}: {row.kind.name}"
    if not row.settled and row.standing is Standing.ARGUED:
        text += "; argued from how the controller is made, not tested"
    return goal(id, text, *_support(id, row), refuted=row.state is RecordState.FAILED)


def _support(id: str, row: RegisterRow) -> Iterator[GsnElement]:
    if not row.settled:
        return
    told = row.test.said if row.test is not None else row.covered_by
    yield solution(f"Sn{id[1:]}", told)


def _program(case: Case) -> GsnElement:
    text = "The processor computes the law with these gains"
    if not case.program:
        return goal("G4", f"{text} (no program here: {case.no_program})")
    steps = [name for name in user_steps(case.program) if name.startswith("program.")]
    taken = (_step(f"G4.{k}", name, case) for k, name in enumerate(steps, start=2))
    return goal("G4", text, _build(case.build), *taken)


def _build(build: Build | None) -> GsnElement:
    text = "The source in program/, compiled by the user's own line, passes its self-test"
    if build is None:
        return goal("G4.1", f"{text} (no record of a build is named)")
    if build.others:
        return goal("G4.1", f"{text} (built from another {', '.join(build.others)})")
    return goal("G4.1", text, solution("Sn4.1", f"build.json: {build.said}"))


def _step(id: str, name: str, case: Case) -> GsnElement:
    state = recorded_state(name, case.results, case.spec_sha256)
    support: tuple[GsnElement, ...] = ()
    if state is RecordState.PASSED:
        support = (solution(f"Sn{id[1:]}", case.results.by_id[name].said),)
    return goal(id, f"{name}: {STEPS[name][0]}", *support, refuted=state is RecordState.FAILED)


def _hazards(case: Case) -> GsnElement:
    goals = tuple(_hazard(f"G5.{k}", h) for k, h in enumerate(case.hazards, start=1))
    strategy = GsnElement("S5", GsnKind.STRATEGY, "Over each hazard of hazards.md", goals)
    text = "Hazards of the control law, as far as this tool knows them, are met by obligations"
    met = goal("G5", text, strategy)
    others = "Hazards, severity and probability are for the maker of the device to complete"
    return replace(met, in_context_of=(GsnElement("A5", GsnKind.ASSUMPTION, others),))


def _hazard(id: str, traced: TracedHazard) -> GsnElement:
    missed = traced.missed
    text = f"{traced.hazard.id}: {traced.hazard.name}"
    if not traced.obligations:
        text += " (no goal of the spec is about it)"
    support: tuple[GsnElement, ...] = ()
    if traced.obligations and not (missed or traced.failed):
        rules = ", ".join(dict.fromkeys(item.rule.id for item in traced.obligations))
        support = (solution(f"Sn{id[1:]}", f"{ended_in(traced.obligations)}: {rules}"),)
    text += f"; {len(missed)} missed" if missed else ""
    text += f"; {', '.join(traced.failed)} failed" if traced.failed else ""
    refuted = bool(traced.failed) or any(item.severity > 1 for item in missed)
    return goal(id, text, *support, refuted=refuted)


def _tool(case: Case) -> GsnElement:
    decides = case.decider
    small = goal(
        "G6.1",
        f"What decides is small enough to be read: {len(decides.files)} files",
        solution("Sn6.1", f"tool.md: {decides.lines} lines"),
    )
    record = decides.mutation
    noticed = "Its tests notice every small error in it, or it is listed with the reason"
    if record is None or not decides.examined:
        why = "no record in this release" if record is None else "the record is of other files"
        mutants = goal("G6.2", f"{noticed} ({why})")
    elif record.unnoticed:
        mutants = goal("G6.2", f"{noticed} ({record.unnoticed} unnoticed)", refuted=True)
    else:
        told = f"{record.killed} of {record.mutants} mutants noticed, {record.equivalent} listed"
        mutants = goal("G6.2", noticed, solution("Sn6.2", told))
    opinion = goal(
        "G6.3",
        "flint decides the same, where it has an opinion",
        solution("Sn6.3", "asked at every check, with a veto"),
    )
    independent = _step("G6.4", "tool.independent-check", case)
    return goal("G6", "A wrong verdict is unlikely", small, mutants, opinion, independent)
