"""`nrs-design robot export`, as a user types it."""

from pathlib import Path

import pytest

from tests.support import ROOT, document_of, run

SPEC = str(ROOT / "specs/robots/neuroboscope.nrs.yaml")


@pytest.mark.parametrize(("format_", "ending"), [("mjcf", "mjcf.xml"), ("urdf", "urdf")])
def test_files(tmp_path, format_, ending):
    done = run("robot", "export", SPEC, "--format", format_, "--out", "there", cwd=tmp_path, code=0)
    file = tmp_path / f"there/neuroboscope.{ending}"
    assert f"there/neuroboscope.{ending}" in done.stdout
    before = file.read_bytes()
    again = ("robot", "export", SPEC, "--format", format_, "--out", file)
    run(*again, cwd=tmp_path, code=0)
    assert file.read_bytes() == before
    file.write_text("<robot>mine</robot>")
    assert "not overwritten" in run(*again, cwd=tmp_path, code=2).stderr
    assert file.read_text() == "<robot>mine</robot>"


def test_a_file_of_another_ending_is_no_folder(tmp_path):
    done = run("robot", "export", SPEC, "--format", "urdf", "--out", "x.txt", cwd=tmp_path, code=2)
    assert "seems to be a file" in done.stderr
    assert "ends in .urdf" in done.stderr
    assert not list(tmp_path.iterdir())


C = ("robot", "export", SPEC, "--format", "c", "--out", "there")


def test_c_is_not_written_without_unproved(tmp_path):
    """Nothing is proved of it."""
    assert "not exported: no certificate covers" in run(*C, cwd=tmp_path, code=3).stderr
    document = document_of(*C, cwd=tmp_path)
    assert (document["verdict"], document["files"]) == ("inconclusive", [])
    assert not (tmp_path / "there").exists()


@pytest.mark.slow
def test_c_is_written_unproved(tmp_path):
    """The exit code says that nothing is proved, and every file does."""
    command = C
    done = run(*command, "--unproved", cwd=tmp_path, code=3)
    assert "UNPROVED (no certificate covers" in done.stdout
    files = [tmp_path / f"there/neuroboscope.{ending}" for ending in ("h", "c")]
    before = [file.read_bytes() for file in files]
    assert all(b"verdict: UNPROVED" in text for text in before)
    document = document_of(*command, "--unproved", cwd=tmp_path)
    assert document["verdict"] == "inconclusive"
    assert document["files"] == ["there/neuroboscope.h", "there/neuroboscope.c"]
    assert [file.read_bytes() for file in files] == before
    (tmp_path / "copy.nrs.yaml").write_bytes(Path(SPEC).read_bytes())
    copied = ("robot", "export", "copy.nrs.yaml", *command[3:], "--unproved")
    assert "belongs to" in run(*copied, cwd=tmp_path, code=2).stderr
    vectors = ("robot", "export", SPEC, "--format", "vectors", "--unproved", "--out", "there")
    run(*vectors, cwd=tmp_path, code=3)
    assert (
        "nrs-design/robot-vectors/1"
        in (tmp_path / "there/neuroboscope.robot-vectors.json").read_text()
    )
    copied = ("robot", "export", "copy.nrs.yaml", *vectors[3:])
    assert "belongs to" in run(*copied, cwd=tmp_path, code=2).stderr


def test_models_are_no_programs(tmp_path):
    done = run("robot", "export", SPEC, "--unproved", cwd=tmp_path, code=2)
    assert "--unproved is for programs" in done.stderr
    assert not list(tmp_path.iterdir())


def test_the_model_of_another_spec_is_not_overwritten(tmp_path):
    for name in ("a.nrs.yaml", "b.nrs.yaml"):
        (tmp_path / name).write_bytes(Path(SPEC).read_bytes())
    for format_ in ("mjcf", "urdf"):
        first = ("robot", "export", "a.nrs.yaml", "--format", format_)
        run(*first, cwd=tmp_path, code=0)
        before = {path: path.read_bytes() for path in (tmp_path / "reports").iterdir()}
        refused = run("robot", "export", "b.nrs.yaml", "--format", format_, cwd=tmp_path, code=2)
        assert "belongs to a.nrs.yaml" in refused.stderr
        assert {path: path.read_bytes() for path in before} == before
        run(*first, cwd=tmp_path, code=0)
