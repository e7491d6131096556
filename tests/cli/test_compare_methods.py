"""`nrs-design compare-methods`, as a user types it."""

from tests.support import COMMUTING, PRINT_ERROR, ROOT, SOFT_TISSUE, document_of, run

LOSSY = ROOT / "docs" / "examples" / "lossy-network.nrs.yaml"
SIX = ROOT / "specs" / "examples" / "dayawansa-martin-6.nrs.yaml"
FEW = ("--max-updates", "300")


def test_the_table_of_the_pair_of_the_thesis(tmp_path):
    done = run("compare-methods", SOFT_TISSUE, *FEW, cwd=tmp_path, code=0)
    rows = [line.split() for line in done.stdout.splitlines() if line.startswith(" gradient")]
    assert [row[1] for row in rows] == ["mean-norm"] * 2 + ["balanced"] * 2 + ["given"] * 2
    assert [row[2] for row in rows] == ["round-robin", "random"] * 3
    assert ["not" in row for row in rows] == [False] * 4 + [True] * 2
    assert done.stdout.rstrip().endswith("for the states of the modes.")
    assert list(tmp_path.iterdir()) == []


def test_json_and_figure(tmp_path):
    lmi, *iterations = document_of(
        "compare-methods", COMMUTING, "--figure", "v.png", cwd=tmp_path, code=0
    )["runs"]
    assert (lmi["method"], lmi["updates"], lmi["history"]) == ("lmi", None, [])
    assert len(iterations) == 6
    for found in iterations:
        assert found["verdict"] == "proved"
        assert found["history"][0][-1][0] == found["updates"]
        assert 0 < found["decay_rate"] <= found["decay_rate_limit"]
        assert found["condition"] >= 1
    assert (tmp_path / "v.png").read_bytes().startswith(b"\x89PNG")


def test_exit_codes(tmp_path):
    run("compare-methods", SIX, *FEW, "-q", cwd=tmp_path, code=3)
    run("compare-methods", PRINT_ERROR, *FEW, "-q", cwd=tmp_path, code=1)


def test_a_system_that_neither_is_for(tmp_path):
    done = run("compare-methods", LOSSY, cwd=tmp_path, code=2)
    assert "one quadratic function for all modes" in done.stderr
    assert "use `nrs-design certify-switching`" in done.stderr
