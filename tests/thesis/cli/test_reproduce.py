"""``nrs-design reproduce`` as typed."""

import json
from dataclasses import replace

import pytest
from typer.testing import CliRunner

from nrs_design.cli.app import make_app
from nrs_design.thesis import table
from nrs_design.thesis.comparison import PrintVerdict
from nrs_design.thesis.table import topic_rows


@pytest.fixture
def short(monkeypatch):
    monkeypatch.setattr(table, "read_data", lambda name: ["specimens"])


@pytest.fixture
def drifting(short, monkeypatch):
    good = topic_rows("specimens")
    bad = replace(good[1], verdict=PrintVerdict.DRIFT, value="700")
    monkeypatch.setattr(table, "topic_rows", lambda topic: (good[0], bad, *good[2:]))


def run(*arguments):
    return CliRunner().invoke(make_app(), ["reproduce", *arguments])


@pytest.mark.usefixtures("short")
def test_text_json_and_page_agree(tmp_path):
    page = tmp_path / "new" / "page.html"
    text, result = run().stdout, run("--json", "--html", str(page))
    found, last = json.loads(result.stdout), text.splitlines()[-1].strip()
    assert run("--quiet").output == ""
    assert "6.1 elastic fits, soft specimen: Not reproducible, because the records" in text
    assert "converted by machine" in text
    assert last == found["summary"] == table.counts_line(topic_rows("specimens"))
    parts = [f"{count} {verdict}" for verdict, count in found["counts"].items()]
    assert sum(found["counts"].values()) == len(found["rows"])
    assert all(part in found["summary"] for part in parts)
    (error,) = found["errors_of_the_print"]
    assert (error["id"], len(error["rows"])) == ("6.1 largest error", 2)
    assert "(errors of the print: 1)" in found["summary"]
    assert "page written to" in result.stderr
    assert page.read_text(encoding="utf-8").rstrip().endswith("</html>")
    assert [path.name for path in page.parent.iterdir()] == ["page.html"]


@pytest.mark.usefixtures("drifting")
def test_a_drift_exits_1_and_is_named():
    result = run("--json")
    assert result.exit_code == 1
    found = json.loads(result.stdout)
    assert found["drift"] == ["mean of the fits, soft specimen"]
    assert ", 1 drift." in found["summary"]
    assert "drift: 6.1 mean of the fits, soft specimen: 700 N/m, printed 747.14" in result.stderr


def test_a_page_is_named_as_one(tmp_path):
    done = run("--html", str(tmp_path / "table.txt"))
    assert "is not the name of a page in HTML" in str(done.exception)
    assert list(tmp_path.iterdir()) == []
