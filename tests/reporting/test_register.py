"""Every sentence that a certificate takes for granted has its entry in the register."""

import json

import pytest

from nrs_design.models.contact import LINEAR_LAWS
from nrs_design.pipeline import run_certification
from nrs_design.reporting.register import MOTOR, TISSUE, Standing, is_known, register_of
from nrs_design.spec import read_spec
from tests.support import ROOT, SOFT_TISSUE

CERTIFICATES = sorted((ROOT / "reports").glob("*.cert.json"))


@pytest.mark.parametrize("path", CERTIFICATES, ids=lambda path: path.name.split(".")[0])
def test_every_sentence_of_the_shipped_certificates_is_known(path):
    statements = json.loads(path.read_text(encoding="utf-8"))["assumptions"]
    assert [text for text in statements if not is_known(text)] == []


def test_what_laws_remember_is_known():
    texts = [
        text
        for law in LINEAR_LAWS.values()
        for alone in (True, False)
        for text in law.memory_texts("nose", alone=alone)
    ]
    assert texts
    assert [text for text in texts if not is_known(text)] == []


def test_an_assumption_keeps_its_sentence_and_order():
    statements = ("The axes of the robot do not act on each other.", "The moon is full.")
    axes, moon = register_of(statements)
    assert (axes.name, axes.statement) == ("axes do not act on each other", statements[0])
    assert axes.standing is Standing.OPEN
    assert all((axes.bound, axes.breaks, axes.test))
    assert not is_known(statements[1])
    assert (moon.statement, moon.standing) == (statements[1], Standing.OPEN)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (
            "The noise of the force signal is left out: it has no bound.",
            "the force signal",
        ),
        (
            "What lasts of the errors of the force signal is a torque about the pivot of at most "
            "1 N*m. In free motion an admittance without a spring integrates it, and the robot "
            "creeps.",
            "the force signal",
        ),
        ("Any switching signal is possible.", "how controllers may be switched"),
        ("Mode a is left after at most 1 step.", "the rules of switching are kept"),
    ],
)
def test_sentences_that_share_words_are_told_apart(text, name):
    assert register_of([text])[0].name == name


@pytest.mark.parametrize(
    ("data", "doubts", "standing"),
    [
        ("measured", "", Standing.TESTED),
        ("synthetic", "", Standing.OPEN),
        ("measured", "    doubts: [the record is short]\n", Standing.OPEN),
    ],
)
def test_only_measured_records_without_doubt_count_as_a_test(tmp_path, data, doubts, standing):
    source = f"{{file: a.csv, sha256: {64 * 'a'}, data: {data}}}"
    text = SOFT_TISSUE.read_text(encoding="utf-8").replace(
        "    lever_arm: 0.24 m\n", f"    lever_arm: 0.24 m\n    provenance: [{source}]\n{doubts}"
    )
    path = tmp_path / "a.nrs.yaml"
    path.write_text(text, encoding="utf-8")
    spec = read_spec(path).spec
    statements = run_certification(read_spec(SOFT_TISSUE)).certification.system.assumptions
    found = {item.name: item.standing for item in register_of(statements, spec)}
    assert found[TISSUE] is standing
    assert found[MOTOR] is Standing.OPEN
