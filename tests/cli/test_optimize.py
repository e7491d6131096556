from tests.support import SOFT_TISSUE, document_of, run


def write(tmp_path, text):
    (tmp_path / "written.nrs.yaml").write_text(text)
    return "written.nrs.yaml"


def test_one_sensitivity_peak_for_one_controller(tmp_path):
    """Withdrawal over soft tissue: 3.75298 is the supremum; the table is rounded up, as warned."""
    result = run("optimize", SOFT_TISSUE, "-v", cwd=tmp_path)
    assert result.stdout.startswith("soft-tissue: G(s) = (0.99739 s + 56.822)")
    row = next(line for line in result.stdout.splitlines() if "withdrawal" in line)
    for value in ("0.01", "1.04", "3.753!"):
        assert value in row
    assert "3.578" not in result.stdout + result.stderr
    assert "the worst of the loop that certify-switching is about" in result.stdout
    document = document_of("optimize", SOFT_TISSUE, cwd=tmp_path)
    for controller in document["controllers"]:
        worst = {goal["goal"]: goal["worst"] for goal in controller["goals"]}
        assert controller["sensitivity_peak"] == worst["max_sensitivity_peak"]
        assert controller["delay_margin_s"] == worst["min_delay_margin"]
