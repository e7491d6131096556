"""What evidence quotes of a spec is what the gate asks of it."""

import pytest

from nrs_design.gating.judge import judge_result
from nrs_design.gating.obligations import Status
from nrs_design.gating.rules import CERTIFICATE_HOLDS, MODE_STABLE
from nrs_design.gating.run import Files, run_gate
from nrs_design.pipeline import run_certification
from nrs_design.spec import read_spec
from tests.support import COMMUTING, SOFT_TISSUE


@pytest.mark.parametrize("spec", [COMMUTING, pytest.param(SOFT_TISSUE, marks=pytest.mark.slow)])
def test_it_is_what_the_gate_asks_beside_files_and_modes(tmp_path, spec):
    (gated,) = run_gate([spec], Files(tmp_path, html=False)).specs
    wanted = [o for o in gated.obligations if o.rule not in (MODE_STABLE, CERTIFICATE_HOLDS)]
    assert list(judge_result(run_certification(read_spec(spec)))) == wanted


def test_a_goal_that_is_missed_is_told(tmp_path):
    spec = tmp_path / "fast.nrs.yaml"
    text = SOFT_TISSUE.read_text().replace("switching:", "goals: {decay_rate: 90 1/s}\nswitching:")
    spec.write_text(text)
    (goal,) = [o for o in judge_result(run_certification(read_spec(spec))) if o.rule.id == "NRS108"]
    assert goal.status is Status.INCONCLUSIVE
    assert goal.subject == "system: decay_rate"
