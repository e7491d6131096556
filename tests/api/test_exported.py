"""Gains with their proof, or why there are none."""

import pytest

import nrs_design as nrs
from nrs_design.errors import DesignError, NrsDesignError
from tests.support import ROOT, SOFT_TISSUE, run


def test_what_is_proved_ships(tmp_path):
    study = nrs.load(SOFT_TISSUE)
    exported = study.export(study.certify().save(tmp_path))
    assert exported
    assert exported.record is not None
    assert exported.certificate is not None
    # The keys of the command; nothing was written.
    assert list(exported.to_dict()) == [
        "spec", "verdict", "reason", "file", "files", "certificate", "record",
    ]  # fmt: skip
    assert exported.to_dict()["files"] == []


def test_what_is_refuted_does_not():
    exported = nrs.load(ROOT / "docs/examples/wide-range.nrs.yaml").export()
    assert not exported
    assert (exported.verdict, exported.record) == ("refuted", None)
    assert "not exported" in repr(exported)
    assert exported.reason in str(exported)
    with pytest.raises(DesignError, match="nothing to draw"):
        exported.plot()


def test_files_are_written_with_their_proof(tmp_path):
    exported = nrs.load(SOFT_TISSUE).export()
    (file,) = exported.save(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["soft-tissue.cert.json", file.name]
    assert nrs.verify(tmp_path / "soft-tissue.cert.json", SOFT_TISSUE)
    command = tmp_path / "command"
    run("export", SOFT_TISSUE, "--out", command, cwd=tmp_path)
    assert file.read_bytes() == (command / file.name).read_bytes()


def test_what_is_not_proved_of_a_program_is_not_written(tmp_path):
    exported = nrs.load(SOFT_TISSUE).export()
    with pytest.raises(DesignError, match="continuous time"):
        exported.save(tmp_path, "c")
    with pytest.raises(NrsDesignError, match="no format 'jsn'"):
        exported.save(tmp_path, "jsn")
    with pytest.raises(DesignError, match="not exported"):
        nrs.load(ROOT / "docs/examples/wide-range.nrs.yaml").export().save(tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_program_is_written_where_its_loop_is_proved(tmp_path):
    exported = nrs.load(ROOT / "docs/examples/insertion-axis.nrs.yaml").export()
    files = exported.save(tmp_path, "c")
    assert {file.suffix for file in files} >= {".c", ".h"}
    assert all(file.exists() for file in files)
