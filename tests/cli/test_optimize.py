"""`nrs-design optimize`, as a user types it."""

import json

import pytest

from tests.support import COMMUTING, FORCE_LIMIT, SOFT_TISSUE, run


def test_optimum_of_the_thesis(tmp_path):
    """Thesis 6.3.2.1: Mt = 0.01 and Bt = 2.15, 1.04; desired impedances 2.1486 and half of it."""
    result = run("optimize", SOFT_TISSUE, "--json", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["schema"] == "nrs-design/optimize/1"
    insertion, withdrawal = document["controllers"]
    assert [insertion["name"], withdrawal["name"]] == ["insertion", "withdrawal"]
    assert insertion["desired_impedance"] == pytest.approx(2.14859, rel=1e-5)
    assert withdrawal["desired_impedance"] == pytest.approx(2.14859 / 2, rel=1e-5)
    for controller, Bt in ((insertion, 2.15), (withdrawal, 1.04)):
        assert controller["Mt"] == pytest.approx(0.01)
        assert controller["Bt"] == pytest.approx(Bt)
        assert controller["optimum"]["cost"] <= controller["cost"]
        assert controller["stiffness_limit"] > controller["stiffness"]
    assert document["motion_loop"]["source"] == "designed"


def test_table(tmp_path):
    result = run("optimize", SOFT_TISSUE, cwd=tmp_path)
    assert result.returncode == 0
    lines = result.stdout.splitlines()
    assert lines[0].startswith("soft-tissue: G(s) = (0.99739 s + 56.822)")
    row = next(line for line in lines if "insertion" in line)
    for value in ("2.1486", "43.0356", "0.01", "2.15"):
        assert value in row


def test_nothing_to_optimize(tmp_path):
    result = run("optimize", FORCE_LIMIT, cwd=tmp_path)
    assert result.returncode == 0
    assert "no impedance controllers" in result.stderr


def test_given_matrices(tmp_path):
    result = run("optimize", COMMUTING, cwd=tmp_path)
    assert result.returncode == 2
    assert "error[NRS002]" in result.stderr
    assert "nothing to design" in result.stderr
    assert result.stdout == ""


def test_missing_spec(tmp_path):
    assert run("optimize", "none.nrs.yaml", cwd=tmp_path).returncode == 2
