"""For other programs: the versioned envelope, with every obligation."""

from __future__ import annotations

from typing import Any

from nrs_design.gating.obligations import (
    BaseChanges,
    Caution,
    GateOutcome,
    Obligation,
    SpecOutcome,
    relative_path,
)
from nrs_design.printable import json_text


def format_json(outcome: GateOutcome) -> str:
    """Return one JSON document."""
    document = {
        "schema": "nrs-design/gate/1",
        "passed": outcome.severity == 0,
        "specs": [_spec(spec) for spec in outcome.specs],
        "notes": list(outcome.notes),
    }
    if outcome.changes is not None:
        document["against"] = _against(outcome.changes)
    return json_text(document) + "\n"


def _against(changes: BaseChanges) -> dict[str, Any]:
    """Return the changes against the base; each weaker one is an obligation, too."""
    return {
        "base": changes.base.as_posix(),
        "weaker": changes.weaker,
        "others": [
            {"path": relative_path(item.path), **_finding_fields(item)} for item in changes.others
        ],
    }


def _spec(spec: SpecOutcome) -> dict[str, Any]:
    return {
        "path": relative_path(spec.path),
        "spec_sha256": spec.sha256,
        "verdict": spec.verdict,
        "refuted_in": spec.refuted_in,
        "common_quadratic": spec.common_quadratic,
        "rate": spec.rate,
        "rate_name": spec.rate_name,
        "modes": spec.modes,
        "bounds": list(spec.bounds),
        "certificate": None if spec.certificate is None else relative_path(spec.certificate),
        "certificate_id": spec.certificate_id,
        "gains": {name: dict(gains) for name, gains in spec.gains.items()},
        "gain_units": {name: dict(units) for name, units in spec.units.items()},
        "warnings": [_finding_fields(item) for item in spec.cautions],
        "obligations": [_obligation(item) for item in spec.obligations],
    }


def _obligation(item: Obligation) -> dict[str, Any]:
    head = {"rule": item.rule.id, "subject": item.subject, "status": str(item.status)}
    return head | _finding_fields(item)


def _finding_fields(item: Obligation | Caution) -> dict[str, Any]:
    return {"message": item.message, "line": item.line, "column": item.column}
