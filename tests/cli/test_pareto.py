"""`nrs-design pareto`, as a user types it."""

import pytest

from tests.support import ROOT, document_of, run

SAMPLED = ROOT / "specs" / "neuroboscope" / "soft-tissue-sampled.nrs.yaml"
COMMUTING = ROOT / "specs" / "examples" / "commuting.nrs.yaml"


@pytest.mark.parametrize("above", ["", "0", "-1", "5,x", "2000", ",".join(map(str, range(1, 40)))])
def test_shares_that_are_none(tmp_path, above):
    refused = run("pareto", SAMPLED, "--above", above, cwd=tmp_path, code=2)
    assert "no shares" in refused.stderr


def test_matrices_have_no_cost(tmp_path):
    refused = run("pareto", COMMUTING, cwd=tmp_path, code=2)
    assert "has no gains to choose" in refused.stderr


def test_points_for_people_and_programs(tmp_path):
    document = document_of("pareto", SAMPLED, "--above", "5", "--figure", "p.png", cwd=tmp_path)
    (curve,) = document["curves"]
    free, point = curve["points"]
    assert free["allowed_above"] is None
    assert point["stiffness"]["soft"] > free["stiffness"]["soft"] > 44.24
    assert point["cost"] > free["cost"] >= curve["least_cost"]
    assert point["decay_rate"] > 0
    assert (tmp_path / "p.png").stat().st_size > 1000
    shown = run(
        "pareto", SAMPLED, "--above", "5", "--objective", "decay-rate", cwd=tmp_path, code=0
    )
    assert "decay-rate for cost, with virtual mass" in shown.stdout
    assert "least" in shown.stdout
