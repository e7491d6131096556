"""Cases of a mode logic: both sides of every threshold, both sides of every time, and no number."""

import struct
from fractions import Fraction

import pytest

from nrs_design.controllers.step_logic import LONGEST, StepLogic
from nrs_design.exporters.logic_cases import SPECIAL, logic_document
from nrs_design.spec import read_spec
from tests.support import ROOT


@pytest.fixture(scope="module", params=["insertion-by-sign", "force-by-threshold"])
def logic(request):
    spec = read_spec(ROOT / f"docs/examples/{request.param}.nrs.yaml").spec
    return StepLogic.of(spec.mode_logic, tuple(spec.controllers), Fraction(1, 500))


def test_cases_hold_what_decides(logic):
    """Each threshold and its neighbors, each time and one sample less, and modes there are not."""
    document = logic_document(logic)
    cases, columns = document["cases"], document["columns"]
    for switch in logic.switches:
        for bound in switch.bounds:
            bits = struct.unpack(">I", struct.pack(">f", float(bound.threshold)))[0]
            place = columns.index(bound.signal)
            drawn = {int(case[place], 16) for case in cases}
            assert {bits - 1, bits, bits + 1, *SPECIAL} <= drawn
    drawn = {tuple(case[:2]) for case in cases}
    for mode, stay in enumerate(logic.stays):
        assert {(mode, n) for n in (0, max(stay - 1, 0), stay, stay + 1, LONGEST)} <= drawn
    assert {case[0] for case in cases} == set(range(len(logic.stays) + 1))
    switched = {(case[0], case[-2]) for case in cases if case[0] != case[-2]}
    assert {(s.source, s.target) for s in logic.switches} <= switched
