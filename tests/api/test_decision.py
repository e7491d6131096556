"""Verdicts, their figures and their files."""

import pytest

import nrs_design as nrs
from nrs_design.errors import DesignError, OutputError
from tests.api.pairs import pair
from tests.support import ROOT


def test_save_and_verify(tmp_path):
    file = nrs.certify(pair(6), name="pair").save(tmp_path)
    assert file == tmp_path / "pair.cert.json"
    assert nrs.verify(file, tmp_path / "pair.nrs.yaml").fault is None
    assert nrs.verify(file)
    other = nrs.certify(pair(5), name="pair")
    other.save(tmp_path / "other")
    assert nrs.verify(file, tmp_path / "other" / "pair.nrs.yaml").fault is not None
    assert not nrs.verify(file, tmp_path / "other" / "pair.nrs.yaml")
    altered = tmp_path / "altered.cert.json"
    altered.write_text(file.read_text().replace('"name": "pair"', '"name": "pear"', 1))
    assert "altered" in nrs.verify(altered).fault
    assert not nrs.verify(altered)


def test_a_file_is_no_folder(tmp_path):
    """What looks like a file would become a folder of that name."""
    with pytest.raises(OutputError, match=r"name of a file; .*pair\.cert\.json"):
        nrs.certify(pair(6), name="pair").save(tmp_path / "mine.cert.json")
    assert not list(tmp_path.iterdir())


def test_saving_overwrites_no_other_spec(tmp_path, monkeypatch):
    """Neither where the files go, nor in the working folder, where one has the same name."""
    spec, place = tmp_path / "pair.nrs.yaml", tmp_path / "place"
    text = (ROOT / "specs/examples/commuting.nrs.yaml").read_text().replace("commuting", "pair")
    spec.write_text(text)
    decision = nrs.certify(pair(6), name="pair")
    with pytest.raises(OutputError, match="is another spec"):
        decision.save(tmp_path)
    assert spec.read_text() == text
    assert not (tmp_path / "pair.cert.json").exists()
    monkeypatch.chdir(tmp_path)
    assert nrs.verify(decision.save(place), place / "pair.nrs.yaml").fault is None
    decision.save(place)
    assert spec.read_text() == text


def test_nothing_shown_is_not_saved(tmp_path):
    inconclusive = nrs.certify(pair(6), method="lmi", name="pair")
    assert repr(inconclusive) == "<Decision pair: INCONCLUSIVE>"
    assert inconclusive.verdict == "inconclusive"
    with pytest.raises(OutputError, match="no certificate"):
        inconclusive.save(tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_figures_and_page(tmp_path):
    decision = nrs.certify(pair(5))
    assert decision.plot().axes
    with pytest.raises(DesignError, match="no figure 'nope'"):
        decision.plot("nope")
    other = tmp_path / "thesis.html"
    other.write_text("mine")
    with pytest.raises(OutputError, match="not overwritten"):
        decision.report(other)
    assert other.read_text() == "mine"
    page = decision.report(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == page
    shown = decision._repr_html_()
    assert "PROVED" in shown
    assert "<script" not in shown
