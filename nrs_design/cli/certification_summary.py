"""What ``--json`` prints about a decision on stability under switching."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fractions import Fraction

    from nrs_design.pipeline import Result
    from nrs_design.search.certification import Certification


def certification_summary(result: Result, path: Path | None) -> dict[str, Any]:
    """Return what ``--json`` prints."""
    from nrs_design.certificates.bounds import bounds_summary
    from nrs_design.certificates.goals import certified_goals

    certification = result.certification
    evidence = certification.evidence
    return {
        "spec": result.loaded.spec.name,
        "spec_sha256": result.loaded.sha256,
        "verdict": str(certification.verdict),
        "refuted_in": certification.refuted_in,
        "common_quadratic": str(certification.common_quadratic),
        "claim": evidence.claim(certification.system) if evidence else None,
        "statements": [
            {"kind": statement.kind, "claim": statement.claim(certification.system)}
            for statement in certification.statements
        ],
        "bounds": bounds_summary(certification.system, certification.statements),
        "goals": [
            {"goal": g.key, "wanted": g.wanted, "shown": g.said, "proved": g.met}
            for g in certified_goals(result.loaded.spec, result.certificate)
        ],
        "method": certification.method,
        **rate_summary(certification),
        "time": str(certification.system.time),
        "coordinates": result.coordinates,
        "states": list(certification.system.states),
        "modes": [mode.name for mode in certification.system.modes],
        "gains": dict(result.certificate.gains) if result.certificate else None,
        "attempts": [
            {
                "step": a.step,
                "outcome": a.outcome,
                "work": round(a.work, 6),
                "seconds": round(a.seconds, 6),
            }
            for a in certification.attempts
        ],
        "assumptions": list(certification.granted),
        "certificate": None if path is None else str(path),
        "certificate_id": result.certificate.id if result.certificate else None,
    }


def rate_summary(certification: Certification) -> dict[str, Any]:
    """Return what ``--json`` prints about the proved rate and its limit."""
    evidence, system = certification.evidence, certification.system
    rate = None if evidence is None else evidence.proved_rate(system)
    return {
        "decay_rate": None if rate is None else _safe_float(rate, system.time),
        "decay_rate_exact": None if rate is None else str(rate),
        "decay_rate_limit": certification.rate_limit,
        "decay_rate_unit": "1/s" if system.time == "continuous" else "1 per step",
    }


def _safe_float(rate: Fraction, time: str) -> float:
    """Return a double on the side of slower decay."""
    from nrs_design.proof.bounds import lower_float, upper_float

    return lower_float(rate) if time == "continuous" else upper_float(rate)
