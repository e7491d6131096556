import pytest

from nrs_design.gating.rules import RULES, WORDS
from tests.cli.test_app import loaded_by
from tests.support import document_of, run


@pytest.mark.parametrize("name", [*RULES, *WORDS, "nrs102", "PROVED"])
def test_one_entry(tmp_path, name):
    out = run("explain", name, cwd=tmp_path, code=0).stdout
    entry = RULES.get(name.upper()) or WORDS[name.lower()]
    said = " ".join(out.split())
    assert entry.explanation in said
    assert entry.remedy in said


def test_list(tmp_path):
    out = run("explain", cwd=tmp_path, code=0).stdout
    assert all(f"{rule.id}  {rule.title}\n" in out for rule in RULES.values())
    assert all(word in out for word in WORDS)


def test_json(tmp_path):
    document = document_of("explain", cwd=tmp_path)
    assert document["schema"] == "nrs-design/explain/1"
    assert [rule["id"] for rule in document["rules"]] == list(RULES)
    assert document_of("explain", "inconclusive", cwd=tmp_path)["word"] == "inconclusive"


def test_explaining_needs_no_numerical_library(tmp_path):
    _, facts = loaded_by(tmp_path, "explain")
    assert not {"numpy", "scipy", "control", "flint"} & set(facts["modules"])
