"""The page of a run held against its bounds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from nrs_design.reporting.document import Bullets, Illustration, Report, Section, Table
from nrs_design.reporting.figures.running import draw_run, draw_stiffness
from nrs_design.reporting.identification import FOOTER, facts_of, label_of, source_section

if TYPE_CHECKING:
    from nrs_design.identification.running import RunJudgement

_MEANING = (
    "A violation of the stiffness is claimed only where a whole interval lies outside the range. "
    "Intervals hold at 95 % for all windows together, with noise in force and deflection.",
    "Undecided: an interval lies across the end of the range, or too little moved.",
    "Not judged: the log lacks a column, or a bound is not known. Not modelled: the proof takes "
    "for granted that there is none of it.",
    "A run inside its bounds is one run; the proof is about all of them.",
)


def run_report(found: RunJudgement, name: str, reason: str) -> Report:
    """Say and draw everything about a run.

    Parameters
    ----------
    found : RunJudgement
        As `judge_run` gives it.
    name : str
        Of the spec.
    reason : str
        Why the spec is not proved; empty if it is.
    """
    log = found.log
    rows = tuple(
        (
            check.name,
            str(check.status),
            check.measured,
            check.allowed,
            check.basis,
            "" if check.first is None else f"{check.first.time:.6g} s: {check.first.words}",
        )
        for check in found.checks
    )
    columns = ("Check", "Outcome", "Measured", "Allowed", "Which is", "First violation")
    loud = (f"UNPROVED SPEC: {reason}; its ranges are only declared.",) if reason else ()
    return Report(
        name=f"run-{name}",
        title=f"A run of {name}",
        verdict=found.verdict,
        claim=f"{label_of(log.source.synthetic)}{_claim(found)}",
        remarks=loud,
        facts=facts_of([log.source]),
        sections=(
            Section("Checks", (Table("Bounds and the run", columns, rows),)),
            Section("Figures", tuple(_figures(found))),
            Section("How to read this", (Bullets("", _MEANING),), boxed=True),
            source_section([log.source]),
        ),
        footer=FOOTER,
    )


def _claim(found: RunJudgement) -> str:
    first = found.first
    if first is not None and first.first is not None:
        return f"First left at t = {first.first.time:.6g} s: {first.name}: {first.first.words}."
    if found.verdict == "inside":
        return "The run stayed inside what was proved."
    return "No bound was left as far as could be judged."


def _figures(found: RunJudgement) -> Iterator[Illustration]:
    if found.windows:
        yield Illustration(
            "stiffness",
            "Stiffness in windows",
            "Bars: intervals at 95 % for all windows together. Shaded: the range.",
            draw_stiffness(found),
        )
    yield Illustration(
        "run", "The log", "Dashed: the first violation, if there is one.", draw_run(found)
    )
