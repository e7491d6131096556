"""Gains with their proof, or why there are none."""

import pytest

import nrs_design as nrs
from nrs_design.errors import DesignError
from tests.support import ROOT, SOFT_TISSUE


def test_what_is_proved_ships(tmp_path):
    study = nrs.load(SOFT_TISSUE)
    exported = study.export(study.certify().save(tmp_path))
    assert exported
    assert exported.record is not None
    assert exported.certificate is not None
    assert r"B_{\mathrm{t}} \approx 2.15\,\mathrm{N\,m\,s/rad}" in exported.latex()
    # The keys of the command; nothing was written.
    assert list(exported.to_dict()) == [
        "spec", "verdict", "reason", "file", "files", "certificate", "record",
    ]  # fmt: skip
    assert exported.to_dict()["files"] == []


def test_what_is_refuted_does_not():
    exported = nrs.load(ROOT / "docs/examples/wide-range.nrs.yaml").export()
    assert not exported
    assert (exported.verdict, exported.record, exported.latex()) == ("refuted", None, "")
    assert "not exported" in repr(exported)
    assert exported.reason in str(exported)
    with pytest.raises(DesignError, match="nothing to draw"):
        exported.plot()
