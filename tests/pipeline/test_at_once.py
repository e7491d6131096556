"""What is proved of a spec that has many parts at once."""

import pytest

from nrs_design.certificates.certificate import Verdict, dump
from nrs_design.pipeline.certification import run_verification
from nrs_design.pipeline.runs import run_certification
from nrs_design.search.certification import Limits
from nrs_design.spec import read_spec
from tests.proof.graphs import shape_of
from tests.search.support import TEXT
from tests.support import ROOT, spec_in

TURNS = (
    TEXT.replace("GAIN, time_constant: TAU", "4.8417e-4 rad/s/rpm, time_constant: 0.0351 s")
    .replace("{nominal: LOW N*m/rad, range: [LOW N*m/rad, HIGH N*m/rad]}", "43 N*m/rad")
    .replace("CONTROLLERS", "  c: {type: impedance, environment: soft, Mt: 0.01 kg*m^2, Bt: BT}")
    .replace("BT", "2 N*m*s/rad")
    + "sampling: {period: 2 ms, outer_period: 4 ms, delay: 0}\ncontact: kept\n"
    "disturbances: {command: 8 deg/s}\n"
)


@pytest.mark.slow
def test_beside_two_periods_no_bound_is_stated(tmp_path):
    """Decay is proved for both periods; that no bound is looked for is said."""
    path = spec_in(tmp_path, TURNS, "turns")
    result = run_certification(read_spec(path), limits=Limits(optimize_rate=False))
    assert result.certification.verdict is Verdict.PROVED
    (statement,) = result.certification.statements
    assert statement.covers_rounding
    missing = [a.outcome for a in result.certification.attempts if a.step.startswith("bound on")]
    assert len(missing) == 2
    assert all(
        "misses deadlines or counts dwell times, decay is proved, and no bound" in outcome
        for outcome in missing
    )
    file = tmp_path / "turns.cert.json"
    file.write_text(dump(result.certificate))
    assert run_verification(file, result).fault is None


@pytest.mark.slow
def test_everything_at_once_is_one_certificate(tmp_path):
    """Sampling, late samples, tolerance, lost contact, rounding, a command, a hand."""
    loaded = read_spec(ROOT / "docs/examples/everything-at-once.nrs.yaml")
    result = run_certification(loaded, limits=Limits(optimize_rate=False, budget=600.0))
    assert result.certification.verdict is Verdict.PROVED
    system = result.certification.system
    stable, force, velocity = result.certification.statements
    assert shape_of(stable) == "conewise-quadratic"
    assert all(item.covers_rounding and item.covers_lost_contact for item in (stable, force))
    assert [item.bound(system).output.name for item in (force, velocity)] == ["force", "velocity"]
    file = tmp_path / "all.cert.json"
    file.write_text(dump(result.certificate), encoding="utf-8")
    assert run_verification(file, result).fault is None
