"""For code scanners: SARIF 2.1.0, the failures with stable rule ids and fingerprints."""

from __future__ import annotations

import hashlib
from typing import Any

from nrs_design import __version__
from nrs_design.gating.obligations import GateOutcome, Obligation, relative_uri
from nrs_design.gating.rules import RULES
from nrs_design.printable import json_text
from nrs_design.spec.task_space import file_of

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
FINGERPRINT = "nrsDesignObligation/v1"


def format_sarif(outcome: GateOutcome) -> str:
    """Return a SARIF log with one run; only failures are results."""
    log = {
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [
            {
                "tool": {
                    "driver": {
                        "name": "nrs-design",
                        "semanticVersion": __version__,
                        "rules": [
                            {
                                "id": rule.id,
                                "shortDescription": {"text": rule.title},
                                "fullDescription": {"text": rule.explanation},
                                "help": {"text": rule.remedy},
                                "defaultConfiguration": {"level": "error"},
                            }
                            for rule in RULES.values()
                        ],
                    }
                },
                "columnKind": "unicodeCodePoints",
                "results": [_result(item) for item in outcome.findings],
            }
        ],
    }
    return json_text(log) + "\n"


def _result(item: Obligation) -> dict[str, Any]:
    region = {"startLine": item.line or 1}
    if item.column is not None:
        region["startColumn"] = item.column
    return {
        "ruleId": item.rule.id,
        "ruleIndex": list(RULES).index(item.rule.id),
        "level": "error",
        "message": {"text": f"{item.status}: {item.message}"},
        "locations": [
            {
                "physicalLocation": {
                    "artifactLocation": {
                        "uri": relative_uri(file_of(item.path)),
                        "uriBaseId": "%SRCROOT%",
                    },
                    "region": region,
                }
            }
        ],
        "partialFingerprints": {FINGERPRINT: fingerprint(item)},
    }


def fingerprint(item: Obligation) -> str:
    """Return what identifies an obligation while lines move and messages change."""
    content = "\n".join((item.rule.id, relative_uri(item.path), item.subject))
    return hashlib.sha256(content.encode(errors="backslashreplace")).hexdigest()
