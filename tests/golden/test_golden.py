"""Every answer is what it was."""

import json
from functools import cache

import pytest

from tests.golden.answers import ANSWERS, answer, differences, rows, specs
from tests.golden.combinations import outcomes, stored, subjects

# Gains and certificates are of the same optimum, and are compared more often.
ROWS = [
    pytest.param(name, command, marks=[pytest.mark.nightly] if command == "optimize" else [])
    for name, command in rows()
]


@cache
def stored_answers(name):
    return json.loads((ANSWERS / f"{name}.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize(("name", "command"), ROWS)
def test_a_command_answers_as_before(name, command, tmp_path):
    found = json.loads(json.dumps(answer(name, command, tmp_path)))
    assert not [*differences(stored_answers(name)[command], found)]


def test_nothing_is_stored_that_is_not_asked():
    asked = {(file, command) for file, command in rows()}
    files = {file.stem for file in ANSWERS.glob("*.json")} - {"combinations"}
    assert asked == {(file, command) for file in files for command in stored_answers(file)}


@pytest.mark.parametrize("subject", subjects())
def test_what_combines_and_what_is_refused_stays(subject):
    """A pair or row of features is refused with the same words, or makes the same system."""
    assert outcomes(subject) == stored()["outcomes"][subject]


@pytest.mark.parametrize("name", specs())
def test_a_shipped_spec_leaves_no_question_open(name):
    """It has no doubt, and says `contact: kept` where only that is proved."""
    checked, decided = (stored_answers(name)[key] for key in ("check", "certify-switching"))
    assert not any(spec["warnings"] for spec in checked["specs"])
    if "contact: not said" in str(checked) and decided["verdict"] == "proved":
        assert "with contact lost" in decided["claim"]
