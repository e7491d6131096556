"""JSON fields of a proof and its margins in SI; every double is rounded conservatively."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.certificates.catalogue import sentences
from nrs_design.models.axis import unit
from nrs_design.proof.bounds import lower_float, upper_float

if TYPE_CHECKING:
    from fractions import Fraction

    from nrs_design.pipeline.blocked import Blocked, Blocking
    from nrs_design.pipeline.certification import Result
    from nrs_design.pipeline.margins import ProofMargins
    from nrs_design.search.margin import Bracket, MarginBrackets

Facts = dict[str, Any]


def certification_facts(result: Result, path: Path | None) -> Facts:
    """Return the facts of a decision on stability under switching."""
    from nrs_design.certificates.bounds import bounds_summary
    from nrs_design.certificates.goals import certified_goals

    found, certificate, spec = result.certification, result.certificate, result.loaded.spec
    system, evidence = found.system, found.evidence
    rate = None if evidence is None else evidence.proved_rate(system)
    continuous = system.time == "continuous"
    return {
        **result.loaded.facts,
        "verdict": str(found.verdict),
        "refuted_in": found.refuted_in,
        "common_quadratic": str(found.common_quadratic),
        "claim": evidence.claim(system) if evidence else None,
        "statements": [{"kind": s.kind, "claim": s.claim(system)} for s in found.statements],
        "bounds": bounds_summary(system, found.statements),
        "goals": [
            {"goal": g.key, "wanted": g.wanted, "shown": g.said, "proved": g.met}
            for g in certified_goals(spec, certificate)
        ],
        "method": found.method,
        **_number("decay_rate", rate, lower_float if continuous else upper_float),
        "decay_rate_limit": found.rate_limit,
        "decay_rate_unit": "1/s" if continuous else "1 per step",
        "time": str(system.time),
        "coordinates": None if result.designed is None else result.designed.spec.coordinates,
        "states": list(system.states),
        "modes": [mode.name for mode in system.modes],
        "gains": dict(certificate.gains) if certificate else None,
        "attempts": [
            {
                "step": attempt.step,
                "outcome": attempt.outcome,
                "work": round(attempt.work, 6),
                "seconds": round(attempt.seconds, 6),
            }
            for attempt in found.attempts
        ],
        "assumptions": list(sentences(found.granted)),
        "certificate": None if path is None else str(path),
        "certificate_id": certificate.id if certificate else None,
    }


def margins_facts(margins: ProofMargins) -> Facts:
    """Return the facts of the requested margins."""
    content: Facts = {}
    if (box := margins.box) is not None:
        content["margin"] = {
            **_number("proved_scale", box.proved, lower_float),
            **_number("refuted_scale", box.refuted, upper_float),
            "refuted_in": box.refuted_in or None,
            "why_not_refuted": box.end or None,
            "method": box.proof.method if box.proof else None,
        }
    if (dwell := margins.dwell) is not None:
        content["shortest_dwell"] = {
            **_number("proved", dwell.proved, upper_float),
            **_number("refuted", dwell.refuted, lower_float),
            "refuted_in": dwell.refuted_in or None,
            "unit": "s",
            "method": dwell.proof.method if dwell.proof else None,
        }
    if margins.loop is not None:
        content["loop_margins"] = loop_facts(margins.loop)
    return content


def loop_facts(margins: MarginBrackets) -> Facts:
    """Return the facts of the margins of delay, period and disturbances."""
    brackets = (("delay", margins.delay, "samples"), ("period", margins.period, "s"))
    content: Facts = {
        name: {**_ends(bracket), "unit": unit}
        for name, bracket, unit in brackets
        if bracket is not None
    }
    if margins.command is not None:
        content["force_limit"] = {
            "limit": float(margins.command.limit),
            "unit": unit("N*m"),
            "disturbances": [
                {
                    "name": name,
                    "unit": unit,
                    "kept_up_to": lower_float(proved),
                    "broken_in_simulation_at": upper_float(broken),
                }
                for name, (proved, broken, unit) in margins.command.bounds.items()
            ],
        }
    return content


def blocked_facts(blocked: Blocked, spec: Path) -> Facts:
    """Return the facts of the lines that prevent a proof."""
    return {
        "blocked_by": [
            {
                "lines": [_line_facts(line, spec) for line in item.lines],
                "claim": item.claim,
                "assumptions_besides": item.needs,
                "gains_differ": item.new_gains,
                "spec_sha256": item.sha256,
            }
            for item in blocked.proved
        ],
        "lines_tried": blocked.tried,
        "lines_work": round(blocked.work, 6),
    }


def _line_facts(line: Blocking, spec: Path) -> Facts:
    from nrs_design.pipeline.blocked import line_text

    return {
        "place": f"{spec}:{line.place.line}:{line.place.column}",
        "line": line.line,
        "text": line_text(line),
        "proved_up_to": line.proved or None,
        "asked": line.asked or None,
        "write": line.write or None,
        "left_out": line.left_out,
    }


def _ends(bracket: Bracket) -> Facts:
    proved, refuted = bracket.proved, bracket.refuted
    return {
        "proved": None if proved is None else lower_float(proved),
        "refuted": None if refuted is None else upper_float(refuted),
        "refuted_in": bracket.refuted_in or None,
        "why_not_refuted": bracket.end or None,
    }


def _number(name: str, number: Fraction | None, round_number: Callable[[Fraction], float]) -> Facts:
    """Return a number as a conservatively rounded double and as an exact text."""
    exact, double = (None, None) if number is None else (str(number), round_number(number))
    return {name: double, f"{name}_exact": exact}
