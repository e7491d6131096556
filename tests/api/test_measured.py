import pytest

import nrs_design as nrs
from nrs_design.errors import DataError
from tests.support import ROOT, SOFT_TISSUE

DATA = ROOT / "specs/data"


def test_tissue_and_actuator():
    tissue = nrs.identify([DATA / f"silicone-soft-{i}.csv" for i in (1, 2, 3)])
    assert tissue.chosen.law.name == "elastic"
    (stiffness,) = tissue.chosen.ranges
    assert stiffness.low < 747.1461 < stiffness.high
    motor = nrs.identify(sorted(DATA.glob("actuator-*hz.csv")), "actuator")
    assert motor.ranges[1].value == pytest.approx(0.0351, rel=1e-3)


@pytest.mark.parametrize(
    ("kind", "law", "words"),
    [
        ("bone", None, "no kind 'bone'"),
        ("tissue", "rubber", "no law 'rubber'"),
        ("actuator", "elastic", "has no law"),
    ],
)
def test_wrong_words(kind, law, words):
    with pytest.raises(DataError, match=words):
        nrs.identify(DATA / "silicone-soft-1.csv", kind, law=law)


def test_a_run_is_judged_against_its_spec(tmp_path):
    log = tmp_path / "run.csv"
    rows = "\n".join(f"{i / 500},0,0,0,insertion" for i in range(100))
    log.write_text(f"time_s,angle_rad,torque_Nm,velocity_rad_s,mode\n{rows}\n")
    study = nrs.load(SOFT_TISSUE)
    study.certify().save(tmp_path)
    judged = study.audit(log, tmp_path / "soft-tissue.cert.json")
    # Contact is estimated, and no reading says how far off it is.
    assert judged.verdict == "inconclusive"
    assert judged.first is None
