"""Records and runs, as the library takes them."""

import json
import random

import numpy as np
import pytest

import nrs_design as nrs
from nrs_design.identification.errors import DataError
from tests.support import ROOT, SOFT_TISSUE, document_of

DATA = ROOT / "specs/data"
TISSUE = [DATA / f"silicone-soft-{i}.csv" for i in (1, 2, 3)]


def test_a_tissue():
    tissue = nrs.identify(TISSUE)
    assert (tissue.chosen, tissue.doubts, tissue.synthetic) == ("elastic", (), True)
    stiffness = tissue.ranges["k"]
    assert stiffness.low < 747.1461 < stiffness.high
    assert stiffness.unit == "N/m"
    assert tissue.files == tuple(TISSUE)
    # Synthetic data are said to be, wherever they are shown.
    assert "SYNTHETIC" in repr(tissue)
    assert "SYNTHETIC" in tissue._repr_html_()


def test_arrays_are_read_as_a_file_is():
    rows = np.loadtxt(TISSUE[0], delimiter=",", skiprows=2)
    frame = dict(zip(("time_s", "deflection_m", "force_N"), rows.T, strict=True))
    found, read = nrs.identify(frame), nrs.identify(TISSUE[0])
    assert (found.ranges, found.synthetic) == (read.ranges, False)


def test_an_actuator():
    motor = nrs.identify(sorted(DATA.glob("actuator-*hz.csv")), "actuator")
    assert motor.ranges["time_constant"].value == pytest.approx(0.0351, rel=1e-3)
    assert motor.ranges["gain"].unit == "(rad/s)/rpm"
    assert motor.plot().axes


def test_a_delay_between_columns_of_ones_own(tmp_path):
    """Of a random command that is seen three samples later, whatever the columns are called."""
    generator = random.Random(1)
    sent = [generator.gauss(0, 1) for _ in range(400)]
    rows = [f"{i / 500},{u},{sent[i - 3] if i >= 3 else 0}" for i, u in enumerate(sent)]
    log = tmp_path / "log.csv"
    log.write_text("\n".join(["time_s,raw_N,used_N", *rows]) + "\n")
    columns = {"command": "raw_N", "measured": "used_N"}
    found = nrs.identify(log, "delay", columns=columns)
    assert found.ranges["samples"].low <= 3 <= found.ranges["samples"].high
    assert found.ranges["delay"].value == pytest.approx(0.006, abs=1e-3)


@pytest.mark.parametrize(
    ("arguments", "law", "words"),
    [
        ((TISSUE[0], "bone"), None, "no kind 'bone'"),
        ((TISSUE[0], "tissue"), "rubber", "no law 'rubber'"),
        ((TISSUE[0], "actuator"), "elastic", "actuator have no law"),
        (("tissue", [TISSUE[0]]), None, "arguments are swapped"),
        (("actuator", TISSUE[0]), None, "arguments are swapped"),
        ((TISSUE[0], [TISSUE[1]]), None, "no kind"),
        ((TISSUE, "delay"), None, "one record"),
    ],
)
def test_wrong_words(arguments, law, words):
    with pytest.raises(DataError, match=words):
        nrs.identify(*arguments, law=law)


def test_a_run_is_judged_against_its_spec(tmp_path):
    log = tmp_path / "run.csv"
    rows = "\n".join(f"{i / 500},0,0,0,insertion" for i in range(100))
    log.write_text(f"time_s,angle_rad,torque_Nm,velocity_rad_s,mode\n{rows}\n")
    study = nrs.load(SOFT_TISSUE)
    cert = study.certify().save(tmp_path)
    judged = study.audit(log, cert)
    # Nothing tells the stiffness, without an angle.
    assert judged.verdict == "inconclusive"
    assert not judged
    assert judged.first is None
    assert {check.name: check.status for check in judged.checks}["stiffness"] == "not judged"
    assert study.audit(log).unproved_because
    assert "UNPROVED SPEC" in repr(study.audit(log))
    said = document_of("audit", log, SOFT_TISSUE, "--certificate", cert, cwd=tmp_path)
    assert said.pop("schema")
    assert json.loads(json.dumps(judged.to_dict())) == said


def test_what_left_its_bounds_first_is_named(tmp_path):
    log = tmp_path / "run.csv"
    rows = "\n".join(f"{i / 500},0,{5 * (i > 50)},0,insertion" for i in range(100))
    log.write_text(f"time_s,angle_rad,torque_Nm,velocity_rad_s,mode\n{rows}\n")
    judged = nrs.load(SOFT_TISSUE).audit(log)
    assert judged.verdict == "outside"
    assert judged.first is not None
    assert judged.first in judged.checks
    assert judged.first.time == pytest.approx(51 / 500)
    assert judged.first.violation
