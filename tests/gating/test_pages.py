"""A page is drawn of what is new or not fulfilled, and again if what it follows from differs."""

from dataclasses import replace

import pytest

from nrs_design import reporting
from nrs_design.gating import pages
from nrs_design.gating.run import Files, run_gate
from nrs_design.pipeline.certification import Overrides
from tests.support import write_spec

STABLE = [[[-1, 0], [0, -2]], [[-2, 0], [0, -1]]]


@pytest.fixture
def drawn(tmp_path, monkeypatch):
    """Run the gate on one spec; tell whether its page was drawn, and return it."""
    spec = tmp_path / "mine.nrs.yaml"
    write_spec(spec, *STABLE)
    render, calls = reporting.render_html, []
    monkeypatch.setattr(reporting, "render_html", lambda *a: calls.append(a) or render(*a))

    def gate(**overrides):
        calls.clear()
        outcome = run_gate(
            [spec], Files(folder=tmp_path / "reports"), overrides=Overrides(**overrides)
        )
        assert not outcome.broken
        return bool(calls), (tmp_path / "reports/given.html").read_bytes()

    return gate


@pytest.fixture
def page(drawn):
    is_drawn, content = drawn()
    assert is_drawn
    assert drawn() == (False, content)
    return content


def test_a_page_that_was_changed_is_drawn_again(tmp_path, drawn, page):
    (tmp_path / "reports/given.html").write_bytes(page.replace(b"proved", b"refuted", 1))
    assert drawn()[0]
    (tmp_path / "reports/.given.html.made").unlink()
    assert drawn()[0]
    assert not drawn()[0]


def test_what_the_spec_says_counts_to_the_letter(tmp_path, drawn, page):
    spec = tmp_path / "mine.nrs.yaml"
    spec.write_text(f"# A line more.\n{spec.read_text(encoding='utf-8')}", encoding="utf-8")
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


def test_how_far_the_search_goes_counts(drawn, page):
    assert drawn(budget=59.0)[0]
    assert not drawn(budget=59.0)[0]


def test_the_program_counts(drawn, page, monkeypatch):
    monkeypatch.setattr(pages, "__version__", "another")
    pages.program_hash.cache_clear()
    assert drawn()[0]
    pages.program_hash.cache_clear()
