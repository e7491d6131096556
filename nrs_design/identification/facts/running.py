"""How a run stands to the bounds of its spec."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.identification.facts.finding import Facts, source_facts

if TYPE_CHECKING:
    from nrs_design.identification.running.check import Check
    from nrs_design.identification.running.judge import RunJudgement
    from nrs_design.spec import LoadedSpec


def run_judgement_facts(
    found: RunJudgement, loaded: LoadedSpec, certificate: Path | None, reason: str
) -> Facts:
    """Return the verdict and every check; the reason says why it is not proved, empty if it is."""
    first = found.first
    return {
        "verdict": found.verdict,
        "proved": found.bounds.proved,
        "unproved_because": reason or None,
        "synthetic": found.log.source.synthetic,
        "log": source_facts([found.log.source]),
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
            for c in found.checks
        ],
        "estimated_share_of_time": found.share,
        "judged_share_of_rows": found.judged,
        "stiffness_not_tested_because": found.hint or None,
        "stiffness": [
            {
                "from_s": found.log.begin + float(found.log.time[w.first]),
                "to_s": found.log.begin + float(found.log.time[w.last - 1]),
                "value_Nm_rad": w.value,
                "low_Nm_rad": w.low,
                "high_Nm_rad": w.high,
            }
            for w in found.windows
        ],
    }


def _violation(check: Check) -> Facts | None:
    if check.first is None:
        return None
    return {"check": check.name, "time_s": check.first.time, "what": check.first.words}
