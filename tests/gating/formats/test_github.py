from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from nrs_design.gating.formats.github import format_github
from nrs_design.gating.obligations import Caution
from tests.gating.formats.support import obligation, outcome_of


def test_annotation():
    assert format_github(outcome_of(obligation())) == (
        "::error file=specs/a.nrs.yaml,line=7,col=3,title=NRS102::"
        "The system is stable under the declared switching: refuted. it grows\n"
    )


def test_escapes():
    line = format_github(outcome_of(obligation(path="a: 100%,\r\nb.yaml", message="50%\r\n::x")))
    assert line.startswith("::error file=a%3A 100%25%2C\\r\\nb.yaml,line=7,col=3,title=NRS102::")
    assert line.endswith("50%25\\r\\n::x\n")


def test_warnings_come_after_errors():
    caution = Caution(Path("specs/a,b.nrs.yaml"), "Mt is on its bound, 50%", 3, 5)
    document = format_github(outcome_of(obligation(), cautions=(caution,)))
    assert document.splitlines()[1] == (
        "::warning file=specs/a%2Cb.nrs.yaml,line=3,col=5,title=nrs-design::"
        "Mt is on its bound, 50%25"
    )


@given(st.text(), st.text(st.characters(exclude_characters="\0/", codec="utf-8")))
def test_every_annotation_is_one_line(message, name):
    text = format_github(outcome_of(obligation(path=f"specs/x{name}", message=message)))
    assert text.count("\n") == 1
    assert "\r" not in text
    properties = text.removeprefix("::error ").partition("::")[0]
    assert [part.partition("=")[0] for part in properties.split(",")] == [
        *["file", "line", "col", "title"]
    ]
