"""The page of a run and its bounds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from nrs_design.identification.reporting.figures.running import draw_judgement, draw_stiffness
from nrs_design.identification.reporting.identification import facts_of, label_of, source_section
from nrs_design.reporting.document import Block, Bullets, Illustration, Report, Section, Table

if TYPE_CHECKING:
    from nrs_design.identification.running.judge import RunJudgement

_FOOTER = "Page of nrs-design. A run is one run, not a proof."
_PROVED = "A run inside its bounds is one run; the proof is about all of them."
_DECLARED = (
    "A run inside its bounds is one run, and nothing is proved about others: name a certificate by "
    "--certificate."
)
_MEANING = (
    "Estimated: a window shows how much the torque changes with the angle, and the range bounds "
    "their ratio. Where the stiffness changes inside its range, the two differ, so no window is "
    "called inside or outside.",
    "Undecided: more than one reading of the log is possible.",
    "Not judged: the log lacks a column, or a bound is not known. Not modelled: the model takes "
    "for granted that there is none of it.",
)


def run_report(found: RunJudgement, name: str, reason: str) -> Report:
    """Say and draw everything about a run."""
    log, limit = found.log, _PROVED if found.bounds.proved else _DECLARED
    loud = (f"UNPROVED SPEC: {reason}; its ranges are only declared.",) if reason else ()
    return Report(
        name=f"run-{name}",
        title=f"A run of {name}",
        verdict=found.verdict,
        claim=f"{label_of([log.source])}{_claim(found)}",
        remarks=loud,
        facts=facts_of([log.source]),
        sections=(
            Section("Checks", tuple(_tables(found))),
            Section("Figures", tuple(_figures(found))),
            Section("How to read this", (Bullets("", (*_MEANING, limit)),), boxed=True),
            source_section([log.source]),
        ),
        footer=_FOOTER,
    )


def _tables(found: RunJudgement) -> Iterator[Block]:
    judged = tuple((c.name, str(c.status), c.measured) for c in found.checks)
    yield Table("What the log shows", ("Check", "Outcome", "Measured"), judged)
    bounds = tuple((c.name, c.allowed, c.basis) for c in found.checks if c.allowed)
    yield Table("Bounds", ("Check", "Allowed", "Which is"), bounds)
    left = tuple(
        f"{c.name}: at {c.first.time:.6g} s, {c.first.words}." for c in found.checks if c.first
    )
    if left:
        yield Bullets("First violations", left)
    yield Bullets("", (f"{found.estimates[0].upper()}{found.estimates[1:]}.",))


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
            "Slope in windows",
            "Slope of torque over angle. Bars: how far noise may have moved it. Shaded: the range "
            "of their ratio.",
            draw_stiffness(found),
        )
    yield Illustration(
        "run", "The log", "Dashed: the first violation, if there is one.", draw_judgement(found)
    )
