import json
import os
import subprocess
import sys
from fractions import Fraction
from itertools import count

import pytest

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.spec import read_spec
from tests.support import COMMUTING, ROOT, SOFT_TISSUE, document_of, run, started, typed

EXAMPLES = ROOT / "specs" / "examples"
RANGES = EXAMPLES / "oscillator-range.nrs.yaml"


@pytest.mark.slow
def test_margin_of_the_oscillator(tmp_path):
    """Zelentsovsky 1994: stable up to 6.98513, so no larger box can be proved."""
    arguments = ("certify-switching", RANGES, "--margin", "--max-degree", 6)
    margin = document_of(*arguments, cwd=tmp_path, code=0)["margin"]
    plain = run(*arguments, cwd=tmp_path)
    proved, refuted = (Fraction(margin[f"{end}_scale_exact"]) for end in ("proved", "refuted"))
    assert margin["proved_scale"] <= proved < refuted <= margin["refuted_scale"]
    assert f"largest box: scaled by {rounded_down(proved)} about" in plain.stdout
    assert f"scaled by {rounded_up(refuted)} they are refuted" in plain.stdout


@pytest.mark.slow
def test_shortest_dwell_time_of_a_pair_that_is_proved_at_30_s(tmp_path):
    """Never less than the verdict above it, nor a number that is rounded the wrong way."""
    (tmp_path / "pair.nrs.yaml").write_text(
        "kind: switched-system\nname: pair\ntime: continuous\nmodes:\n"
        '  - {name: a, A: [["-0.1", 1], [-1, "-0.1"]]}\n'
        '  - {name: b, A: [["-0.1", 10], ["-0.1", "-0.1"]]}\nswitching: {dwell_time: 30 s}\n'
    )
    arguments = ("pair.nrs.yaml", "--shortest-dwell", "--max-degree", 4)
    dwell = document_of("certify-switching", *arguments, cwd=tmp_path)["shortest_dwell"]
    assert (dwell["unit"], dwell["method"]) == ("s", "mode quadratic")
    assert Fraction(dwell["refuted_exact"]) < Fraction(dwell["proved_exact"]) < 12
    assert dwell["refuted"] <= Fraction(dwell["refuted_exact"])
    assert dwell["proved"] >= Fraction(dwell["proved_exact"])


def test_json(tmp_path):
    document = document_of(
        "certify-switching", SOFT_TISSUE, "--out", "c.json", cwd=tmp_path, code=0
    )
    certificate = json.loads((tmp_path / "c.json").read_text())
    (statement,) = certificate["statements"]
    wanted = {
        "decay_rate_exact": statement["rate"],
        "modes": [mode["name"] for mode in certificate["modes"]],
        "gains": certificate["gains"],
        "certificate": "c.json",
        "certificate_id": certificate["id"],
        "spec_sha256": read_spec(SOFT_TISSUE).sha256,
    }
    assert {name: document[name] for name in wanted} == wanted
    # The answer says in words what the certificate holds as data.
    assert "claim" not in statement
    granted = [*certificate["assumptions"], certificate["contact"]["loss"]]
    assert len(document["assumptions"]) == len(granted)
    assert granted[-1] == {"id": "contact-lost.surface"}
    assert document["assumptions"][-1].startswith("Contact is lost where the deflection")
    assert document["decay_rate"] <= document["decay_rate_limit"]


def test_a_clock_that_stops_the_search_is_said_and_nothing_is_decided(tmp_path, monkeypatch):
    ticks = count()
    monkeypatch.setattr("nrs_design.search.work.monotonic", lambda: 100.0 * next(ticks))
    said = "the clock stopped this after 660 s, before its budget of work was used up"
    for options in ((), ("--json",)):
        result = run("certify-switching", COMMUTING, *options, cwd=tmp_path, code=3)
        assert f"error[NRS008]: {said}" in " ".join(result.stderr.split())
        assert "PROVED" not in result.stdout
    document = json.loads(result.stdout)
    assert document["rule"] == "NRS008"
    assert document["faults"][0]["message"].startswith(said)
    assert not (tmp_path / "reports").exists()


def test_work_is_counted_alike_in_every_run(tmp_path):
    found = [document_of("certify-switching", COMMUTING, cwd=tmp_path) for _ in range(2)]
    one, other = ({a["step"]: a["work"] for a in each["attempts"]} for each in found)
    assert one == other
    assert one["lmi"] > 0


def test_every_step_is_listed_and_no_color_is_in_a_pipe(tmp_path):
    environment = {"FORCE_COLOR": "1", "NO_COLOR": "1"}
    result = typed("certify-switching", COMMUTING, "-v", cwd=tmp_path, environment=environment)
    assert "\x1b" not in result.stdout + result.stderr
    assert "suspicious modes: none" in result.stdout
    assert "lmi: found" in result.stdout


def broken_pipe():
    read, write = os.pipe()
    os.close(read)
    return write


@pytest.mark.parametrize(
    ("opened", "code", "said"),
    [
        # Who reads changes nothing: the system is proved, and its certificate is written.
        (broken_pipe, 0, "certificate written to c.json\n"),
        (lambda: os.open("/dev/full", os.O_WRONLY), 2, "the output cannot be written"),
    ],
)
def test_output_that_nobody_takes(tmp_path, opened, code, said):
    written, asked = opened(), ("certify-switching", str(COMMUTING), "--out", "c.json")
    done = subprocess.run(
        [*(sys.executable, "-m", "nrs_design"), *asked],
        stdout=written,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    os.close(written)
    assert done.returncode == code
    assert said in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "spec", "closed"),
    [("certify-switching", COMMUTING, ">&- 2>&-"), ("tune", SOFT_TISSUE, ">&-")],
)
def test_closed_streams(tmp_path, command, spec, closed):
    line = f'exec "$0" -m nrs_design {command} "$1" {closed}'
    result = started("sh", "-c", line, sys.executable, spec, cwd=tmp_path, python=False)
    assert result.returncode == 0
    assert "internal error" not in result.stderr
