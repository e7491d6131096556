"""`nrs-design robot export`, as a user types it."""

import json
from pathlib import Path

import pytest

from tests.support import ROOT, run, typed

SPEC = str(ROOT / "specs/robots/neuroboscope.nrs.yaml")


@pytest.mark.parametrize(("format_", "ending"), [("mjcf", "mjcf.xml"), ("urdf", "urdf")])
def test_files(tmp_path, format_, ending):
    done = run("robot", "export", SPEC, "--format", format_, "--out", "there", cwd=tmp_path)
    assert done.returncode == 0
    file = tmp_path / f"there/neuroboscope.{ending}"
    assert f"there/neuroboscope.{ending}" in done.stdout
    before = file.read_bytes()
    again = ("robot", "export", SPEC, "--format", format_, "--out", file)
    assert run(*again, cwd=tmp_path).returncode == 0
    assert file.read_bytes() == before
    file.write_text("<robot>mine</robot>")
    refused = run(*again, cwd=tmp_path)
    assert refused.returncode == 2
    assert "not overwritten" in refused.stderr
    assert file.read_text() == "<robot>mine</robot>"


def test_json(tmp_path):
    done = typed("robot", "export", SPEC, "--json", cwd=tmp_path)
    document = json.loads(done.stdout)
    assert document["schema"] == "nrs-design/robot-export/1"
    assert document["files"] == ["reports/neuroboscope.mjcf.xml"]


def test_what_is_no_robot(tmp_path):
    spec = str(ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml")
    done = run("robot", "export", spec, cwd=tmp_path)
    assert done.returncode == 2
    assert "describes no robot" in done.stderr
    assert not list(tmp_path.iterdir())


def test_the_model_of_another_spec_is_not_overwritten(tmp_path):
    for name in ("a.nrs.yaml", "b.nrs.yaml"):
        (tmp_path / name).write_bytes(Path(SPEC).read_bytes())
    for format_ in ("mjcf", "urdf"):
        first = ("robot", "export", "a.nrs.yaml", "--format", format_)
        assert run(*first, cwd=tmp_path).returncode == 0
        before = {path: path.read_bytes() for path in (tmp_path / "reports").iterdir()}
        refused = run("robot", "export", "b.nrs.yaml", "--format", format_, cwd=tmp_path)
        assert refused.returncode == 2
        assert "belongs to a.nrs.yaml" in refused.stderr
        assert {path: path.read_bytes() for path in before} == before
        assert run(*first, cwd=tmp_path).returncode == 0
