"""The register: what a sentence carries, what counts as tested, what a certificate lacks."""

import pytest

from nrs_design.loop.assumption import Standing, say
from nrs_design.pipeline.runs import run_certification
from nrs_design.reporting.register import register_of
from nrs_design.spec import read_spec
from tests.reporting.conftest import recorded
from tests.support import SOFT_TISSUE

AXES = "The axes of the robot do not act on each other."


def test_an_assumption_keeps_its_sentence_and_order():
    said = say("motor.joint", "at 1 rpm", motor="m", moving="")
    motor, axes = register_of([said, say("uncoupled.axes")])
    assert (motor.statement, motor.kind.id, motor.bound) == (said, "motor", "at 1 rpm")
    assert (axes.statement, axes.bound, axes.standing) == (AXES, "zero coupling", Standing.OPEN)


def test_what_a_certificate_alone_does_not_tell_is_said():
    (found,) = register_of([AXES])
    assert (found.statement, found.standing) == (AXES, Standing.OPEN)
    assert "report its spec" in found.kind.breaks
    assert "report its spec" in found.kind.test


@pytest.mark.parametrize(
    ("data", "doubts", "standing"),
    [
        ("measured", "", Standing.TESTED),
        ("synthetic", "", Standing.OPEN),
        ("measured", "    doubts: [the record is short]\n", Standing.OPEN),
    ],
)
def test_only_measured_records_without_doubt_count_as_a_test(tmp_path, data, doubts, standing):
    spec = recorded(tmp_path, data, doubts).spec
    statements = run_certification(read_spec(SOFT_TISSUE)).certification.system.assumptions
    found = {entry.kind.id: entry.standing for entry in register_of(statements, spec)}
    assert found["tissue"] is standing
    assert found["nominal-motor"] is Standing.OPEN
