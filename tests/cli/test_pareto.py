"""`nrs-design pareto`, as a user types it."""

import pytest

from tests.support import ROOT, document_of, run

SAMPLED = ROOT / "specs" / "neuroboscope" / "soft-tissue-sampled.nrs.yaml"
REDESIGNED = SAMPLED.with_name("soft-tissue-redesigned.nrs.yaml")
COMMUTING = ROOT / "specs" / "examples" / "commuting.nrs.yaml"


@pytest.mark.parametrize("above", ["", "0", "-1", "5,x", "2000", ",".join(map(str, range(1, 40)))])
def test_shares_that_are_none(tmp_path, above):
    refused = run("pareto", SAMPLED, "--above", above, cwd=tmp_path, code=2)
    assert "no shares" in refused.stderr


@pytest.mark.parametrize("names", ["", "cost", "cost,speed", "Stiffness"])
def test_objectives_that_are_none(tmp_path, names):
    refused = run("pareto", SAMPLED, "--objectives", names, cwd=tmp_path, code=2)
    # A terminal breaks lines within a frame.
    said = " ".join(refused.stderr.replace("\N{BOX DRAWINGS LIGHT VERTICAL}", "").split())
    assert "give some of stiffness, decay-rate, delay, peak-torque, noise" in said


def test_matrices_have_no_cost(tmp_path):
    refused = run("pareto", COMMUTING, cwd=tmp_path, code=2)
    assert "has no gains to choose" in refused.stderr


def free_rate(document):
    return document["curves"][0]["points"][0]["decay_rate"]


def test_points_for_people_and_programs(tmp_path):
    files = ("--figure", "p.png", "--csv", "p.csv", "--with", REDESIGNED)
    document = document_of("pareto", SAMPLED, "--above", "5", *files, cwd=tmp_path)
    # It decays twice as fast, and costs 0.2527.
    given = document["given"][REDESIGNED.name]
    assert given["decay_rate"] > 2 > free_rate(document)
    assert given["cost"] == pytest.approx(0.2527, abs=1e-4)
    rows = (tmp_path / "p.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == 4
    assert rows[0].startswith("curve,cost,stiffness,decay_rate,delay,force,noise")
    (curve,) = document["curves"]
    free, point = curve["points"]
    assert free["allowed_above"] is None
    assert point["stiffness"]["soft"] > free["stiffness"]["soft"] > 44.24
    assert point["cost"] > free["cost"] >= curve["least_cost"]
    assert point["decay_rate"] > 0
    assert (tmp_path / "p.png").stat().st_size > 1000
    shown = run(
        "pareto", SAMPLED, "--above", "5", "--objectives", "cost,decay-rate", cwd=tmp_path, code=0
    )
    assert "decay rate for cost, with virtual mass" in shown.stdout
    assert "least" in shown.stdout
