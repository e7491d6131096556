import json

import jsonschema
import pytest

from nrs_design.gating.formats import to_sarif
from nrs_design.gating.formats.sarif import fingerprint
from nrs_design.gating.obligations import Status
from nrs_design.gating.rules import RULES
from tests.gating.formats.support import HOSTILE, obligation, outcome_of

# The parts of SARIF 2.1.0 (OASIS) that are written, with what that standard requires of them.
TEXT = {
    "type": "object",
    "required": ["text"],
    "properties": {"text": {"type": "string", "minLength": 1}},
    "additionalProperties": False,
}
LEVEL = {"enum": ["none", "note", "warning", "error"]}
RULE = {
    "type": "object",
    "required": ["id"],
    "properties": {
        "id": {"type": "string"},
        "shortDescription": TEXT,
        "fullDescription": TEXT,
        "help": TEXT,
        "defaultConfiguration": {
            "type": "object",
            "properties": {"level": LEVEL},
            "additionalProperties": False,
        },
    },
    "additionalProperties": False,
}
LOCATION = {
    "type": "object",
    "properties": {
        "physicalLocation": {
            "type": "object",
            "required": ["artifactLocation"],
            "properties": {
                "artifactLocation": {
                    "type": "object",
                    "properties": {
                        "uri": {"type": "string", "pattern": "^[A-Za-z0-9._~/%-]+$"},
                        "uriBaseId": {"const": "%SRCROOT%"},
                    },
                    "additionalProperties": False,
                },
                "region": {
                    "type": "object",
                    "required": ["startLine"],
                    "properties": {
                        "startLine": {"type": "integer", "minimum": 1},
                        "startColumn": {"type": "integer", "minimum": 1},
                    },
                    "additionalProperties": False,
                },
            },
            "additionalProperties": False,
        }
    },
    "additionalProperties": False,
}
RESULT = {
    "type": "object",
    "required": ["message", "ruleId", "ruleIndex"],
    "properties": {
        "ruleId": {"type": "string"},
        "ruleIndex": {"type": "integer", "minimum": 0},
        "level": LEVEL,
        "message": TEXT,
        "locations": {"type": "array", "items": LOCATION, "minItems": 1},
        "partialFingerprints": {"type": "object", "additionalProperties": {"type": "string"}},
    },
    "additionalProperties": False,
}
DRIVER = {
    "type": "object",
    "required": ["name"],
    "properties": {
        "name": {"type": "string"},
        "semanticVersion": {"type": "string"},
        "rules": {"type": "array", "items": RULE, "uniqueItems": True},
    },
    "additionalProperties": False,
}
RUN = {
    "type": "object",
    "required": ["tool", "results"],
    "properties": {
        "tool": {
            "type": "object",
            "required": ["driver"],
            "properties": {"driver": DRIVER},
            "additionalProperties": False,
        },
        "columnKind": {"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
        "results": {"type": "array", "items": RESULT},
    },
    "additionalProperties": False,
}
SARIF = {
    "type": "object",
    "required": ["version", "runs"],
    "properties": {
        "$schema": {"type": "string", "format": "uri"},
        "version": {"const": "2.1.0"},
        "runs": {"type": "array", "items": RUN, "minItems": 1},
    },
    "additionalProperties": False,
}


def sarif_of(outcome):
    log = json.loads(to_sarif(outcome))
    jsonschema.validate(log, SARIF)
    return log["runs"][0]


def test_results_are_the_failures_worst_first(mixed):
    run = sarif_of(mixed)
    rules = run["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == list(RULES)
    assert [result["ruleId"] for result in run["results"]] == ["NRS900"] + ["NRS102"] * 4
    assert all(rules[r["ruleIndex"]]["id"] == r["ruleId"] for r in run["results"])


def test_place(mixed):
    (place,) = sarif_of(mixed)["results"][1]["locations"]
    assert place["physicalLocation"] == {
        "artifactLocation": {"uri": "specs/a.nrs.yaml", "uriBaseId": "%SRCROOT%"},
        "region": {"startLine": 7, "startColumn": 3},
    }


@pytest.mark.parametrize("name", ["a b.yaml", "100%.yaml", "a#b?c.yaml", "ä.yaml", "a\nb"])
def test_hostile_names_are_valid_references(name):
    sarif_of(outcome_of(obligation(path=f"specs/{name}", message=HOSTILE)))


def test_a_passing_run_has_no_results():
    assert sarif_of(outcome_of(obligation(Status.PROVED)))["results"] == []


def test_fingerprint_survives_moved_lines_and_other_words():
    base = fingerprint(obligation())
    assert fingerprint(obligation(line=99, message="other", status=Status.ERROR)) == base
    assert fingerprint(obligation(subject="a")) != base
    assert fingerprint(obligation(path="specs/b.nrs.yaml")) != base
