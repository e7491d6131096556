"""The mode logic in C: case by case what the replica does, and every number of it deployed."""

import re
import struct
from fractions import Fraction

import pytest

from nrs_design.controllers.shipped import shipped_law
from nrs_design.controllers.step_logic import LONGEST
from nrs_design.exporters.build import build_unproved
from nrs_design.exporters.formats.c import header_text
from nrs_design.exporters.program import Program
from nrs_design.exporters.self_test import LOGIC_COUNT, LOGIC_SPECIAL, draw_cases, logic_cases
from nrs_design.exporters.text import CNames, literal
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.exporters.programs import (
    STRICT,
    built,
    check_with_misra,
    compiler,
    emulated,
    run,
    write_law,
)
from tests.support import ROOT
from tests.tables import rows

PERIOD = Fraction(1, 500)


@pytest.fixture(scope="module", params=["insertion-by-sign", "force-by-threshold"])
def shipped(request):
    found = run_design(read_spec(ROOT / f"docs/examples/{request.param}.nrs.yaml"))
    law = shipped_law(found.spec, found.design, PERIOD)
    record = build_unproved(found.loaded, found.design, "a test", PERIOD, None)
    return record, law, CNames(found.spec.name)


def test_cases_hold_what_decides(shipped):
    """Each threshold and its neighbors, each time and one sample less, and modes there are not."""
    _, law, _ = shipped
    logic, cases = law.logic, [*logic_cases(law.logic)]
    for switch in logic.switches:
        for bound in switch.bounds:
            bits = struct.unpack(">I", struct.pack(">f", float(bound.threshold)))[0]
            place = 2 + logic.signals.index(bound.signal)
            drawn = {int(case[place], 16) for case in cases}
            assert {bits - 1, bits, bits + 1, *LOGIC_SPECIAL} <= drawn
    drawn = {tuple(case[:2]) for case in cases}
    for mode, stay in enumerate(logic.hold_samples):
        assert {(mode, n) for n in (0, max(stay - 1, 0), stay, stay + 1, LONGEST)} <= drawn
    assert {case[0] for case in cases} == set(range(len(logic.hold_samples) + 1))
    switched = {(case[0], case[-2]) for case in cases if case[0] != case[-2]}
    assert {(s.source, s.target) for s in logic.switches} <= switched


@pytest.mark.slow
def test_cppcheck_with_misra_is_content(tmp_path, shipped):
    record, law, _ = shipped
    check_with_misra(write_law(tmp_path, record, law, draw_cases(law, 1))[0])


@pytest.mark.parametrize(("old", "new"), rows(__file__, "test_the_self_test_runs_the_logic_too"))
def test_the_self_test_runs_the_logic_too(tmp_path, shipped, old, new):
    """After the law, which is right: every slip in the logic is one of its own cases."""
    record, law, names = shipped
    cases = draw_cases(law, 20)
    source, test, flag = write_law(tmp_path, record, law, cases)
    text = source.read_text()
    assert old in text
    source.write_text(text.replace(old, new) if old else text)
    built(compiler(), *STRICT, flag, source, test, "-o", tmp_path / "program")
    said = run(tmp_path / "program").stdout
    if old:
        (index,) = map(int, re.findall(r"case (\d+) differs", said))
        assert index >= len(cases.rows)
    else:
        assert said == f"{names.spec}: all {len(cases.rows) + LOGIC_COUNT} cases are the same\n"
        assert emulated(tmp_path, source, flag, test) == f"0: {said}"


def test_every_number_of_the_logic_is_in_the_header(shipped):
    """`verify --deployed` compares all of them."""
    record, law, names = shipped
    text = header_text(Program(record, law, names))
    macros = re.findall(rf"#define {names.upper}_LOGIC_\w+ (\S+)", text)
    bounds = [literal(b.threshold) for s in law.logic.switches for b in s.bounds]
    stays = [f"{number}U" for number in (law.logic.start, *law.logic.hold_samples)]
    assert sorted(macros) == sorted([*bounds, *stays])
    assert "The proof does not rest on the signals" in " ".join(text.replace("\n *", " ").split())
