from xml.etree import ElementTree

import pytest

from nrs_design.gating.formats import to_badge
from nrs_design.gating.obligations import Status
from tests.gating.formats.support import obligation, outcome_of


@pytest.mark.parametrize(
    ("outcome", "said", "colour"),
    [
        (outcome_of(obligation(Status.PROVED), verdict="proved"), "1 proved", "#00664b"),
        (outcome_of(obligation(), verdict="refuted"), "1 refuted", "#a63603"),
        (outcome_of(obligation(), verdict="inconclusive"), "1 inconclusive", "#6b5b00"),
        # A proof beside a goal that is missed is not green, nor is nothing at all.
        (outcome_of(obligation(Status.MISSED), verdict="proved"), "1 not fulfilled", "#a63603"),
        (outcome_of(), "0 proved", "#6b5b00"),
    ],
)
def test_it_says_the_worst(outcome, said, colour):
    root = ElementTree.fromstring(to_badge(outcome))
    space = "{http://www.w3.org/2000/svg}"
    assert root.find(f"{space}title").text == f"switching: {said}"
    assert root.findall(f"{space}rect")[1].get("fill") == colour
