"""The register: what a sentence carries, and what counts as tested."""

import pytest

from nrs_design.certificates.catalogue import Standing
from nrs_design.pipeline.runs import run_certification
from nrs_design.proof.assumption import Assumption
from nrs_design.reporting.sections.tail import register_of
from nrs_design.spec import read_spec
from tests.reporting.conftest import recorded
from tests.support import SOFT_TISSUE
from tests.tables import rows

AXES = "The axes of the robot do not act on each other."


def test_an_assumption_keeps_its_sentence_and_order():
    said = Assumption.create("motor.joint", gain="[1, 2] rad/s/rpm", tau="1 s", moving="all")
    motor, axes = register_of([said, Assumption("uncoupled.axes")])
    bound = "its gain stays in [1, 2] rad/s/rpm and its time constant is 1 s"
    assert (motor.kind.id, motor.bound) == ("motor", bound)
    assert motor.statement.endswith(f"{bound}, and may change arbitrarily fast.")
    assert (axes.statement, axes.bound, axes.standing) == (AXES, "zero coupling", Standing.OPEN)


@pytest.mark.parametrize(
    ("data", "doubts", "standing"),
    rows(__file__, "test_only_measured_records_without_doubt_count_as_a_test"),
)
def test_only_measured_records_without_doubt_count_as_a_test(tmp_path, data, doubts, standing):
    spec = recorded(tmp_path, data, doubts).spec
    statements = run_certification(read_spec(SOFT_TISSUE)).certification.system.assumptions
    found = {entry.kind.id: entry.standing for entry in register_of(statements, spec)}
    assert found["tissue"] is Standing[standing]
    assert found["nominal-motor"] is Standing.OPEN
