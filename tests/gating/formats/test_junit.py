import xml.etree.ElementTree as ET

from hypothesis import given
from hypothesis import strategies as st

from nrs_design.gating.formats.junit import format_junit
from tests.gating.formats.support import HOSTILE, obligation, outcome_of


def test_one_case_per_obligation_and_one_suite_per_spec(mixed):
    root = ET.fromstring(format_junit(mixed))
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


def test_hostile_text_stays_well_formed():
    item = obligation(path=f"specs/{HOSTILE}", message=HOSTILE + "\ud800\ufffe")
    root = ET.fromstring(format_junit(outcome_of(item)).encode())
    message = root.find("testsuite/testcase/failure").get("message")
    assert message.startswith("a: 100%,")
    assert "\\x1b[31m\\x00<&>\"'" in message
    assert message.endswith("\\ud800\\ufffe")


@given(st.text())
def test_any_message_is_well_formed(message):
    ET.fromstring(format_junit(outcome_of(obligation(message=message))).encode())
