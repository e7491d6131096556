from dataclasses import replace

import pytest

from nrs_design import reporting
from nrs_design.certificates.prove import read_document
from nrs_design.errors import InternalError
from nrs_design.gating.obligations import Status
from nrs_design.gating.run import Files, run_gate
from tests.pipeline.test_blocked import PAIR
from tests.support import write_spec

from .conftest import BROKEN, STABLE, UNSTABLE, gate_of


@pytest.fixture
def examine(tmp_path):
    """Gate the given texts as specs s0, s1, ... without reports."""

    def run(*texts):
        paths = [tmp_path / f"s{i}.nrs.yaml" for i in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            path.write_text(text)
        return gate_of(tmp_path, *paths)

    return run


def test_the_outcome_is_the_same_for_any_number_of_processes(tmp_path):
    """Specs that cannot be read, share a name or are refuted are at their places."""
    texts = (STABLE, UNSTABLE, BROKEN, STABLE.replace("name: stable", "name: other"), UNSTABLE)
    paths = [tmp_path / f"s{i}.nrs.yaml" for i in range(len(texts))]
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text)
    files = Files(folder=tmp_path / "reports", html=False)
    alone = run_gate(paths, files)
    assert run_gate(paths, files, jobs=2) == alone
    assert [spec.path for spec in alone.specs] == paths


def test_inconclusive_fails(examine, inconclusive):
    outcome = examine(STABLE)
    (broken,) = outcome.broken
    assert (broken.rule.id, broken.status) == ("NRS102", Status.INCONCLUSIVE)
    assert "nothing found" in broken.message
    assert "0.25" not in broken.message, "times differ from run to run"
    assert outcome.severity == 1
    assert outcome.specs[0].certificate is None


def test_missing_and_misnamed_files_are_errors(tmp_path):
    outcome = gate_of(tmp_path, tmp_path / "missing.nrs.yaml", tmp_path / "\udcff.nrs.yaml")
    assert [spec.obligations[0].rule.id for spec in outcome.specs] == ["NRS001", "NRS001"]
    assert "not UTF-8" in outcome.specs[1].obligations[0].message


def test_a_defect_of_one_examination_is_the_worst_and_stops_no_other(examine, monkeypatch):
    from nrs_design.gating import run

    def disagree(loaded, **options):
        if loaded.spec.name == "stable":
            raise InternalError("two computations disagree")
        return certify(loaded, **options)

    certify = run.run_certification
    monkeypatch.setattr(run, "run_certification", disagree)
    outcome = examine(BROKEN, STABLE.replace("name: stable", "name: other"), STABLE)
    assert [spec.verdict for spec in outcome.specs] == [None, "proved", None]
    assert [item.rule.id for item in outcome.broken] == ["NRS900", "NRS001"]
    assert outcome.severity == 4


def test_what_the_clock_stops_is_inconclusive_and_stops_no_other(examine, monkeypatch):
    # Each search has a fuse of its own, and may look at it many times.
    ticks = iter([*[0.0] * 3, *[1e6] * 10**6])
    monkeypatch.setattr("nrs_design.search.work.monotonic", lambda: next(ticks))
    outcome = examine(STABLE.replace("name: stable", "name: other"), STABLE)
    assert [spec.verdict for spec in outcome.specs] == [None, "proved"]
    (broken,) = outcome.broken
    assert (broken.rule.id, broken.status) == ("NRS008", Status.INCONCLUSIVE)
    assert "the clock stopped this" in broken.message
    assert outcome.severity == 1


def test_a_certificate_that_does_not_hold_when_read_back_is_reported(examine, monkeypatch):
    from nrs_design.certificates.certificate import dump
    from nrs_design.gating import run

    def other(*given):
        return dump(*given).replace("matrices.given", "matrices.guessed")

    monkeypatch.setattr(run, "dump", other)
    outcome = examine(STABLE)
    (broken,) = outcome.broken
    assert (broken.rule.id, broken.status) == ("NRS104", Status.MISSED)


@pytest.mark.slow
def test_lines_that_block_a_proof_are_said_and_the_gate_fails(examine):
    (spec,) = examine(PAIR).specs
    (stable,) = (o for o in spec.obligations if o.rule.id == "NRS102")
    assert stable.status is Status.INCONCLUSIVE
    assert "; proved with any one of these changes; " in stable.message
    assert "s0.nrs.yaml:7: switching.dwell_time: with 2.91 s" in stable.message


MATRICES = [[[-1, 0], [0, -2]], [[-2, 0], [0, -1]]]


@pytest.fixture
def drawn(tmp_path, monkeypatch):
    """Run the gate on one spec; tell whether its page was drawn, and return it."""
    spec = tmp_path / "mine.nrs.yaml"
    write_spec(spec, *MATRICES)
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
    write_spec(tmp_path / "mine.nrs.yaml", *MATRICES[:1])
    assert drawn()[0]
    assert not drawn()[0]


def test_a_page_that_somebody_changed_is_drawn_again(tmp_path, drawn, page):
    (tmp_path / "reports/given.html").write_bytes(page.replace(b"Proved", b"Proved for all"))
    assert [drawn()[0], drawn()[0]] == [True, False]


def test_a_page_of_a_spec_that_has_moved_is_drawn_again(tmp_path, page):
    """It says where its spec lies, and so whose it is."""
    spec, moved = tmp_path / "mine.nrs.yaml", tmp_path / "moved/mine.nrs.yaml"
    moved.parent.mkdir()
    spec.rename(moved)
    assert not run_gate([moved], Files(folder=tmp_path / "reports")).broken
    drawn_again = (tmp_path / "reports/given.html").read_bytes()
    assert b"../moved/mine.nrs.yaml" in drawn_again
    assert b"../moved/mine.nrs.yaml" not in page


def test_what_is_recorded_and_fulfilled_has_no_page_unless_all_are_asked_for(tmp_path, drawn, page):
    place = tmp_path / "reports/given.html"
    place.unlink()
    files = Files(folder=tmp_path / "reports")
    assert not run_gate([tmp_path / "mine.nrs.yaml"], files).broken
    assert not place.exists()
    run_gate([tmp_path / "mine.nrs.yaml"], replace(files, every_page=True))
    assert place.exists()
