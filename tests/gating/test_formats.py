import json
import xml.etree.ElementTree as ET
from pathlib import Path

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.gating.formats import FORMATS, to_github, to_json, to_junit, to_sarif, to_text
from nrs_design.gating.formats.sarif import fingerprint
from nrs_design.gating.obligations import (
    Caution,
    GateOutcome,
    Obligation,
    SpecOutcome,
    Status,
    failed,
)
from nrs_design.gating.rules import RULES, SWITCHING_STABLE

GAINS = {
    "motion": {"Kp": "117359.4375", "Kd": "2060"},
    "hand": {},
    "tissue": {"Mt": "0.00999999977648258209228515625"},
}
STATUSES = [Status.INCONCLUSIVE, Status.ERROR, Status.REFUTED, Status.PROVED, Status.MISSED]
HOSTILE = "a: 100%,\r\nb\x1b[31m\x00<&>\"'::error::"


def obligation(status=Status.REFUTED, path="specs/a.nrs.yaml", **changes):
    fields = {"subject": "system", "message": "it grows", "line": 7, "column": 3, **changes}
    return Obligation(SWITCHING_STABLE, Path(path), status=status, **fields)


def outcome_of(*items, **fields):
    path = items[0].path if items else Path("specs/a.nrs.yaml")
    return GateOutcome((SpecOutcome(path, items, **fields),))


@pytest.fixture
def mixed():
    """One spec of every kind of end."""
    good = SpecOutcome(
        Path("specs/good.nrs.yaml"),
        (obligation(Status.PROVED, "specs/good.nrs.yaml"),),
        sha256="0" * 64,
        verdict="proved",
        common_quadratic="exists",
        rate="1.5",
        rate_name="alpha",
        modes=2,
        certificate=Path("reports/good.cert.json"),
        certificate_id="abcdef0123456789",
    )
    bad = SpecOutcome(Path("specs/a.nrs.yaml"), tuple(map(obligation, STATUSES)), verdict="refuted")
    defect = failed(Path("specs/c.nrs.yaml"), RuntimeError("unforeseen\nand long"))
    return GateOutcome((bad, good, defect), ("a note",))


def test_worst_comes_first(mixed):
    order = [str(item.status) for item in mixed.broken]
    assert order == ["error", "error", "refuted", "missed", "inconclusive"]
    assert mixed.broken[0].rule.id == "NRS900"


@pytest.mark.parametrize("name", FORMATS)
def test_equal_outcomes_give_equal_documents(mixed, name):
    assert FORMATS[name](mixed) == FORMATS[name](mixed)
    assert FORMATS[name](mixed).endswith("\n")


class TestText:
    def test_table_and_failures(self, mixed):
        lines = to_text(mixed).split("\n")
        assert lines[0].split("  ")[0] == "spec"
        (good,) = (line for line in lines if line.startswith("specs/good"))
        assert good.split() == [
            "specs/good.nrs.yaml",
            *["proved", "exists", "alpha", ">=", "1.5", "1/s", "2", "abcdef012345"],
        ]
        assert "specs/a.nrs.yaml:7:3: NRS102 refuted: it grows" in lines
        assert "specs/c.nrs.yaml: NRS900 error: RuntimeError: unforeseen and long" in lines
        assert "1 refuted, 1 proved, 1 without verdict; 7 obligations, 5 not" in to_text(mixed)

    def test_gains_are_shown_by_their_shortest_single_precision_decimals(self):
        text = to_text(outcome_of(obligation(), gains=GAINS))
        assert "specs/a.nrs.yaml: motion Kp 117359.44, Kd 2060; tissue Mt 0.01\n" in text
        assert "single-precision" in text
        assert "gains" not in to_text(outcome_of(obligation()))

    def test_one_of_a_kind(self):
        assert "1 spec: " in to_text(outcome_of(obligation()))
        assert "; 1 obligation, " in to_text(outcome_of(obligation()))

    def test_hostile_text_steers_no_terminal(self):
        text = to_text(outcome_of(obligation(path=f"specs/{HOSTILE}", message=HOSTILE)))
        assert all(line.isprintable() for line in text.split("\n"))
        assert text.count("\n") == to_text(outcome_of(obligation())).count("\n")


def test_json_has_the_warnings_of_each_spec():
    caution = Caution(Path("specs/a.nrs.yaml"), "Mt is on its bound", 3, 5)
    (spec,) = json.loads(to_json(outcome_of(obligation(), cautions=(caution,))))["specs"]
    assert spec["warnings"] == [{"message": "Mt is on its bound", "line": 3, "column": 5}]


class TestGitHub:
    def test_annotation(self):
        assert to_github(outcome_of(obligation())) == (
            "::error file=specs/a.nrs.yaml,line=7,col=3,title=NRS102::"
            "The system is stable under the declared switching: refuted. it grows\n"
        )

    def test_escapes(self):
        line = to_github(outcome_of(obligation(path="a: 100%,\r\nb.yaml", message="50%\r\n::x")))
        assert line.startswith(
            "::error file=a%3A 100%25%2C\\r\\nb.yaml,line=7,col=3,title=NRS102::"
        )
        assert line.endswith("50%25\\r\\n::x\n")

    def test_at_most_ten_and_a_notice(self):
        items = [obligation(Status.INCONCLUSIVE)] * 9 + [obligation()] * 3
        lines = to_github(outcome_of(*items)).splitlines()
        assert [line.split("::")[1].split()[0] for line in lines] == ["error"] * 10 + ["notice"]
        assert all(": refuted." in line for line in lines[:3])
        assert lines[-1] == "::notice title=nrs-design::2 more not shown; see the log of this step"

    def test_ten_need_no_notice(self):
        assert "notice" not in to_github(outcome_of(*[obligation()] * 10))

    def test_warnings_come_after_errors(self):
        caution = Caution(Path("specs/a,b.nrs.yaml"), "Mt is on its bound, 50%", 3, 5)
        document = to_github(outcome_of(obligation(), cautions=(caution,)))
        assert document.splitlines()[1] == (
            "::warning file=specs/a%2Cb.nrs.yaml,line=3,col=5,title=nrs-design::"
            "Mt is on its bound, 50%25"
        )
        assert to_github(outcome_of(cautions=(caution,) * 12)).count("::warning") == 10

    def test_place_that_is_not_known(self):
        line = to_github(outcome_of(obligation(line=None, column=None)))
        assert "line=1,col=1" in line

    def test_nothing_to_say(self):
        assert to_github(outcome_of(obligation(Status.PROVED))) == ""

    @given(st.text(), st.text(st.characters(exclude_characters="\0/", codec="utf-8")))
    def test_every_annotation_is_one_line(self, message, name):
        text = to_github(outcome_of(obligation(path=f"specs/x{name}", message=message)))
        assert text.count("\n") == 1
        assert "\r" not in text
        properties = text.removeprefix("::error ").partition("::")[0]
        assert [part.partition("=")[0] for part in properties.split(",")] == [
            *["file", "line", "col", "title"]
        ]


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


class TestSarif:
    def test_results_are_the_failures_worst_first(self, mixed):
        run = sarif_of(mixed)
        rules = run["tool"]["driver"]["rules"]
        assert [rule["id"] for rule in rules] == list(RULES)
        assert [result["ruleId"] for result in run["results"]] == ["NRS900"] + ["NRS102"] * 4
        assert all(rules[r["ruleIndex"]]["id"] == r["ruleId"] for r in run["results"])

    def test_place(self, mixed):
        (place,) = sarif_of(mixed)["results"][1]["locations"]
        assert place["physicalLocation"] == {
            "artifactLocation": {"uri": "specs/a.nrs.yaml", "uriBaseId": "%SRCROOT%"},
            "region": {"startLine": 7, "startColumn": 3},
        }

    @pytest.mark.parametrize("name", ["a b.yaml", "100%.yaml", "a#b?c.yaml", "ä.yaml", "a\nb"])
    def test_hostile_names_are_valid_references(self, name):
        sarif_of(outcome_of(obligation(path=f"specs/{name}", message=HOSTILE)))

    def test_a_passing_run_has_no_results(self):
        assert sarif_of(outcome_of(obligation(Status.PROVED)))["results"] == []

    def test_fingerprint_survives_moved_lines_and_other_words(self):
        base = fingerprint(obligation())
        assert fingerprint(obligation(line=99, message="other", status=Status.ERROR)) == base
        assert fingerprint(obligation(subject="a")) != base
        assert fingerprint(obligation(path="specs/b.nrs.yaml")) != base


class TestJUnit:
    def test_one_case_per_obligation_and_one_suite_per_spec(self, mixed):
        root = ET.fromstring(to_junit(mixed))
        assert root.attrib == {"name": "nrs-design", "tests": "7", "failures": "3", "errors": "2"}
        suites = root.findall("testsuite")
        assert [suite.get("name") for suite in suites] == [str(s.path) for s in mixed.specs]
        assert [suite.get("tests") for suite in suites] == ["5", "1", "1"]
        ends = [[(end.tag, end.get("type")) for end in case] for case in suites[0]]
        assert ends == [
            [("failure", "inconclusive")],
            [("error", "NRS102")],
            [("failure", "refuted")],
            [],
            [("failure", "missed")],
        ]

    def test_hostile_text_stays_well_formed(self):
        item = obligation(path=f"specs/{HOSTILE}", message=HOSTILE + "\ud800\ufffe")
        root = ET.fromstring(to_junit(outcome_of(item)).encode())
        message = root.find("testsuite/testcase/failure").get("message")
        assert message.startswith("a: 100%,")
        assert "\\x1b[31m\\x00<&>\"'" in message
        assert message.endswith("\\ud800\\ufffe")

    @given(st.text())
    def test_any_message_is_well_formed(self, message):
        ET.fromstring(to_junit(outcome_of(obligation(message=message))).encode())

    def test_no_times(self, mixed):
        assert "time" not in {
            key for element in ET.fromstring(to_junit(mixed)).iter() for key in element.attrib
        }


class TestJson:
    def test_envelope(self, mixed):
        document = json.loads(to_json(mixed))
        assert document["schema"] == "nrs-design/gate/1"
        assert document["passed"] is False
        assert document["notes"] == ["a note"]
        assert [spec["verdict"] for spec in document["specs"]] == ["refuted", "proved", None]
        assert document["specs"][1]["certificate"] == "reports/good.cert.json"
        assert document["specs"][0]["gains"] == {}
        assert document["specs"][0]["obligations"][2] == {
            "rule": "NRS102",
            "subject": "system",
            "status": "refuted",
            "message": "it grows",
            "line": 7,
            "column": 3,
        }

    def test_gains_are_exact(self):
        (spec,) = json.loads(to_json(outcome_of(obligation(), gains=GAINS)))["specs"]
        assert spec["gains"] == GAINS
