"""`nrs-design identify tool`, as a user types it."""

import shutil

from tests.identification.cli.identify.records import DATA, SOFT
from tests.support import SOFT_TISSUE, document_of, run

POSES = DATA / "tool-poses.csv"


def test_tool_into_a_spec_that_the_gate_proves(tmp_path):
    spec = tmp_path / "soft-tissue.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    page = tmp_path / "tool.html"
    document = document_of(
        "identify", "tool", POSES, "--write", spec, "--report", page, cwd=tmp_path, code=0
    )
    assert document["schema"] == "nrs-design/identify-tool/1"
    assert document["synthetic"] is True
    assert document["mass_kg"]["low"] < 0.797 < document["mass_kg"]["high"]
    for axis, value in zip("xyz", (0.002, -0.004, 0.2), strict=True):
        assert document["center_of_mass_m"][axis]["low"] < value
        assert value < document["center_of_mass_m"][axis]["high"]
    assert "data: synthetic" in spec.read_text()
    assert "Errors in each pose" in page.read_text(encoding="utf-8")
    again = run("identify", "tool", POSES, "--write", spec, "-v", cwd=tmp_path)
    assert "Center of mass [m]" in again.stdout
    optimized = document_of("optimize", spec, cwd=tmp_path)
    assert set(optimized["sensor"]["parts"]) == {"bias", "mass and center of mass of the tool"}
    assert optimized["sensor"]["lasting_error"] > 0


def test_wrong_poses(tmp_path):
    assert "missing" in run("identify", "tool", SOFT[0], cwd=tmp_path, code=2).stderr
    (tmp_path / "two.csv").write_text("\n".join(POSES.read_text().splitlines()[:4]))
    result = run("identify", "tool", tmp_path / "two.csv", cwd=tmp_path, code=2)
    assert "2 poses do not determine a tool" in result.stderr
