import json

import pytest
from typer.testing import CliRunner

from nrs_design.cli.app import make_app
from nrs_design.errors import OutputError
from tests.support import COMMUTING, PRINT_ERROR, ROOT

COMMUTING, PRINT_ERROR = map(str, (COMMUTING, PRINT_ERROR))


def run(*arguments: str):
    return CliRunner().invoke(make_app(), ["report", *arguments])


def test_default_is_a_page_in_reports(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = run(COMMUTING)
    assert done.exit_code == 0
    assert done.stdout == "commuting: PROVED\n"
    page = (tmp_path / "reports/commuting.html").read_text()
    assert page.startswith("<!DOCTYPE html>")


def test_a_page_ends_as_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused = run(COMMUTING, "--out", "page.png")
    assert isinstance(refused.exception, OutputError)
    assert list(tmp_path.iterdir()) == []


def test_wrong_usage():
    assert run(COMMUTING, "--date", "1.3.2026").exit_code == 2


def test_a_date_is_written_only_if_given(tmp_path):
    out = tmp_path / "c.html"
    pages = []
    for dates in ([], ["--date", "2026-03-01"]):
        assert run(COMMUTING, "--out", str(out), *dates).exit_code == 0
        pages.append(out.read_bytes())
    assert pages[0] != pages[1]
    assert b"2026-03-01" not in pages[0]


def test_refuted_still_gets_its_report(tmp_path):
    out = tmp_path / "r.html"
    done = run(PRINT_ERROR, "--out", str(out), "--json")
    assert done.exit_code == 1
    document = json.loads(done.stdout)
    assert document["schema"] == "nrs-design/report/1"
    assert document["verdict"] == "refuted"
    assert len(document["certificate_id"]) == 64
    assert document["certificate_id"] in out.read_text()


@pytest.mark.slow
def test_a_certificate_at_hand_is_shown(tmp_path):
    certificate, page = ROOT / "reports/commuting.cert.json", tmp_path / "a.html"
    given = ("--certificate", str(certificate), "--out", str(page))
    assert run(COMMUTING, *given).exit_code == 0
    text = page.read_text(encoding="utf-8")
    assert json.loads(certificate.read_text(encoding="utf-8"))["id"] in text
    assert "each of its statements was checked again exactly" in text
