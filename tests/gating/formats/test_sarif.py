import json
from pathlib import Path

import jsonschema
import pytest

from nrs_design.gating.formats.sarif import fingerprint, format_sarif
from nrs_design.gating.obligations import Status
from nrs_design.gating.rules import RULES
from tests.gating.formats.support import HOSTILE, obligation, outcome_of

# The parts of SARIF 2.1.0 (OASIS) that are written, with what that standard requires of them.
SARIF = json.loads(Path(__file__).with_name("sarif.json").read_text(encoding="utf-8"))


def sarif_of(outcome):
    log = json.loads(format_sarif(outcome))
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


def test_fingerprint_survives_moved_lines_and_other_words():
    base = fingerprint(obligation())
    assert fingerprint(obligation(line=99, message="other", status=Status.ERROR)) == base
    assert fingerprint(obligation(subject="a")) != base
    assert fingerprint(obligation(path="specs/b.nrs.yaml")) != base
