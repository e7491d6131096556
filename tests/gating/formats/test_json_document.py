import json
from pathlib import Path

from nrs_design.gating.formats.json_document import format_json
from nrs_design.gating.obligations import Caution
from tests.gating.formats.support import obligation, outcome_of


def test_envelope(mixed):
    document = json.loads(format_json(mixed))
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


def test_warnings_of_each_spec():
    caution = Caution(Path("specs/a.nrs.yaml"), "Mt is on its bound", 3, 5)
    (spec,) = json.loads(format_json(outcome_of(obligation(), cautions=(caution,))))["specs"]
    assert spec["warnings"] == [{"message": "Mt is on its bound", "line": 3, "column": 5}]
