"""Specs that are valid and probably not meant: the table of doubts."""

from pathlib import Path

import pytest

from nrs_design.spec import doubt_spec, parse_spec
from tests.tables import cases_of, edit_of, edited, spec_text, words_of


@pytest.mark.parametrize("case", cases_of(Path(__file__).with_name("doubts.yaml"), "base"))
def test_what_is_probably_not_meant_is_told_at_its_place(case):
    """Where a case says `clear`, no doubt stands there; an environment that is not touched may."""
    doubts = doubt_spec(parse_spec(edited(spec_text(case["base"]), edit_of(case))))
    said = [(".".join(map(str, doubt.at)), str(doubt)) for doubt in doubts]
    if "clear" in case:
        assert not [text for at, text in said if at.startswith(case["clear"])]
    else:
        (told,) = (text for at, text in said if at == case["at"])
        assert all(words in told for words in words_of(case))
        assert {at for at, _ in said} <= {case["at"], "environments.hand"}
