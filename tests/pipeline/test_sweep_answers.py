"""Answers in a file: what is kept claims nothing that nothing shows."""

import pytest

from nrs_design.errors import OutputError
from nrs_design.pipeline.sweep_answers import PointAnswer, add_answer, is_shown, read_answers
from tests.tables import rows


@pytest.mark.parametrize("document", rows(__file__, "test_claims"))
def test_claims(document):
    assert not is_shown(document, {})
    assert is_shown(document, document)
    assert not is_shown(document, {"verdict": "inconclusive"})


@pytest.mark.parametrize(
    "document",
    [
        {"verdict": "inconclusive"},
        {"claim": None, "proved": False, "goals": [{"proved": False}]},
        {"Mt": 0.01, "text": "not proved"},
    ],
)
def test_no_claims(document):
    assert is_shown(document, {})


def test_beside_what_is_shown_nothing_more_may_be_claimed():
    assert is_shown({"verdict": "proved", "method": "lmi"}, {"verdict": "proved"})
    assert not is_shown({"verdict": "proved", "cost": 1.0}, {"verdict": "proved"})
    assert not is_shown({"verdict": "proved", "proved_scale": 1.0}, {"verdict": "proved"})
    assert not is_shown({"cost": 1.0}, {"verdict": "proved"})


def test_the_last_answer_of_a_point_counts(tmp_path):
    file = tmp_path / "kept.jsonl"
    assert read_answers(file) == {}
    first, other = (PointAnswer((v,), 0, "k", {"text": "\ud800"}) for v in ("1 N", "2 N"))
    last = PointAnswer(("1 N",), 1, "k", {})
    for answer in (first, other, last):
        add_answer(file, answer)
    assert read_answers(file) == {("1 N",): last, ("2 N",): other}


def test_no_file_of_somebody_else_is_added_to(tmp_path):
    file = tmp_path / "kept.jsonl"
    file.write_text("mine")
    with pytest.raises(OutputError, match="not overwritten"):
        read_answers(file)
