"""Output of an audit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.identification.reporting.view import (
    Facts,
    facts_of,
    label_of,
    source_facts,
    source_section,
    thinned,
)
from nrs_design.identification.running.bounds import Check
from nrs_design.identification.running.judge import RunJudgement
from nrs_design.reporting.document import Block, Bullets, Illustration, Report, Section, Table
from nrs_design.reporting.style import ALARM, INK, MUTED, new_figure, styled
from nrs_design.spec import LoadedSpec

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CLAIMS = {
    "inside": "the run stayed inside what was proved",
    "outside": "the run left its bounds",
    "inconclusive": "no bound was left as far as could be judged",
}
# Columns of a run, from the top.
_LABELS = {
    "angle": "Angle [rad]",
    "torque": "Torque [N m]",
    "deflection": "Deflection [m]",
    "force": "Force [N]",
    "velocity": "Velocity [rad/s]",
    "command": "Command",
    "mode": "Mode",
}
_FOOTER = "Page of nrs-design. A run is one run, not a proof."


def first_violation(run: RunJudgement) -> str:
    """Say what was left first, and when; empty for nothing."""
    first = run.first
    if first is None or first.first is None:
        return ""
    return f"first at t = {first.first.time:.6g} s: {first.name}: {first.first.words}"


def unproved_text(reason: str) -> str:
    """Say that a spec is not proved."""
    return f"UNPROVED SPEC: {reason}; its ranges are only declared."


def run_facts(
    run: RunJudgement, loaded: LoadedSpec, certificate: Path | None, reason: str
) -> Facts:
    """Return the verdict and every check; the reason says why it is not proved, empty if it is."""
    first = run.first
    return {
        "verdict": run.verdict,
        "proved": run.bounds.proved,
        "unproved_because": reason or None,
        "synthetic": run.log.source.synthetic,
        "log": source_facts([run.log.source]),
        "spec": {"name": loaded.spec.name, "sha256": loaded.sha256},
        "certificate": None if certificate is None else str(certificate),
        "first_violation": _violation(first) if first is not None else None,
        "checks": [
            {
                "name": c.name,
                "status": str(c.status),
                "measured": c.measured,
                "allowed": c.allowed or None,
                "basis": c.basis or None,
                "first_violation": _violation(c),
            }
            for c in run.checks
        ],
        "judged_share_of_rows": run.judged,
    }


def _violation(check: Check) -> Facts | None:
    if check.first is None:
        return None
    return {"check": check.name, "time_s": check.first.time, "what": check.first.words}


def run_report(run: RunJudgement, name: str, reason: str) -> Report:
    """Return the page of a run."""
    sources = [run.log.source]
    claim = first_violation(run) or CLAIMS[run.verdict]
    note = "Dashed: the first violation, if there is one."
    figure = Illustration("run", "The log", note, _draw(run))
    return Report(
        name=f"run-{name}",
        title=f"A run of {name}",
        verdict=run.verdict,
        claim=f"{label_of(sources)}{claim[0].upper()}{claim[1:]}.",
        remarks=(unproved_text(reason),) if reason else (),
        facts=facts_of(sources),
        sections=(
            Section("Checks", tuple(_tables(run))),
            Section("Figures", (figure,)),
            source_section(sources),
        ),
        footer=_FOOTER,
    )


def _tables(run: RunJudgement) -> Iterator[Block]:
    judged = tuple((c.name, str(c.status), c.measured) for c in run.checks)
    yield Table("What the log shows", ("Check", "Outcome", "Measured"), judged)
    bounds = tuple((c.name, c.allowed, c.basis) for c in run.checks if c.allowed)
    yield Table("Bounds", ("Check", "Allowed", "Which is"), bounds)
    left = tuple(
        f"{c.name}: at {c.first.time:.6g} s, {c.first.words}." for c in run.checks if c.first
    )
    if left:
        yield Bullets("First violations", left)


@styled
def _draw(run: RunJudgement) -> Figure:
    """Draw every column of a log over time."""
    log, first = run.log, run.first
    names = [name for name in _LABELS if name in log.columns]
    figure = new_figure(0.8 + 1.15 * len(names))
    rows = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    pick = thinned(len(log.time))
    for axes, name in zip(rows, names, strict=True):
        values = log.columns[name][pick]
        axes.step(log.begin + log.time[pick], values, where="post", color=INK, linewidth=1.0)
        label = _LABELS[name] + (f" [{log.command_unit}]" if name == "command" else "")
        axes.set_ylabel(label, fontsize=8.5)
        if name == "mode":
            axes.set_yticks(range(len(log.labels)), log.labels)
        if name == "torque":
            for sign in (-1, 1):
                axes.axhline(sign * run.bounds.torque, color=MUTED, linestyle=":", linewidth=1)
        if first is not None and first.first is not None:
            axes.axvline(first.first.time, color=ALARM, linestyle="--", linewidth=1.2)
    rows[-1].set_xlabel("Time [s]")
    return figure
