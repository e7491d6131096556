"""What an audit says: facts for JSON, and sentences."""

from __future__ import annotations

from pathlib import Path

from nrs_design.api.audit import AuditCheck
from nrs_design.identification.reporting.view import Facts, source_facts
from nrs_design.identification.running.judge import RunJudgement
from nrs_design.spec import LoadedSpec

CLAIMS = {
    "inside": "the run stayed inside what was proved",
    "outside": "the run left its bounds",
    "inconclusive": "no bound was left as far as could be judged",
}


def first_violation(run: RunJudgement) -> str:
    """Say what was left first, and when; empty for nothing."""
    first = run.first
    return f"first at t = {first.time:.6g} s: {first.name}: {first.violation}" if first else ""


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
        "first_violation": first and _violation(first),
        "checks": [
            {
                "name": c.name,
                "status": c.status,
                "measured": c.measured,
                "allowed": c.allowed or None,
                "basis": c.basis or None,
                "first_violation": _violation(c),
            }
            for c in run.checks
        ],
        "judged_share_of_rows": run.judged_share,
    }


def _violation(check: AuditCheck) -> Facts | None:
    if check.time is None:
        return None
    return {"check": check.name, "time_s": check.time, "what": check.violation}
