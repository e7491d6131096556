"""A page is drawn of what is new or not fulfilled, and again if it is of another certificate."""

from dataclasses import replace

import pytest

from nrs_design import reporting
from nrs_design.certificates.prove import read_document
from nrs_design.gating.run import Files, run_gate
from tests.support import write_spec

STABLE = [[[-1, 0], [0, -2]], [[-2, 0], [0, -1]]]


@pytest.fixture
def drawn(tmp_path, monkeypatch):
    """Run the gate on one spec; tell whether its page was drawn, and return it."""
    spec = tmp_path / "mine.nrs.yaml"
    write_spec(spec, *STABLE)
    render, calls = reporting.render_html, []
    monkeypatch.setattr(reporting, "render_html", lambda *a: calls.append(a) or render(*a))

    def gate():
        calls.clear()
        outcome = run_gate([spec], Files(folder=tmp_path / "reports"))
        assert not outcome.broken
        return bool(calls), (tmp_path / "reports/given.html").read_bytes()

    return gate


@pytest.fixture
def page(drawn):
    is_drawn, content = drawn()
    assert is_drawn
    assert drawn() == (False, content)
    return content


def test_a_page_of_another_certificate_is_drawn_again(tmp_path, drawn, page):
    certificate = read_document(tmp_path / "reports/given.cert.json")["id"].encode()
    (tmp_path / "reports/given.html").write_bytes(page.replace(certificate, b"0" * 64))
    assert drawn()[0]
    write_spec(tmp_path / "mine.nrs.yaml", *STABLE[:1])
    assert drawn()[0]
    assert not drawn()[0]


def test_what_is_recorded_and_fulfilled_has_no_page_unless_all_are_asked_for(tmp_path, drawn, page):
    place = tmp_path / "reports/given.html"
    place.unlink()
    files = Files(folder=tmp_path / "reports")
    assert not run_gate([tmp_path / "mine.nrs.yaml"], files).broken
    assert not place.exists()
    run_gate([tmp_path / "mine.nrs.yaml"], replace(files, every_page=True))
    assert place.exists()
