import json

import pytest
from typer.testing import CliRunner

from nrs_design.cli.app import make_app
from tests.support import COMMUTING, PRINT_ERROR, ROOT

COMMUTING, PRINT_ERROR = map(str, (COMMUTING, PRINT_ERROR))


def run(*arguments: str):
    return CliRunner().invoke(make_app(), ["report", *arguments])


def test_a_date_is_written_only_if_given(tmp_path):
    out = tmp_path / "c.html"
    pages = []
    for dates in ([], ["--date", "2026-03-01"]):
        assert run(COMMUTING, "--out", str(out), *dates).exit_code == 0
        pages.append(out.read_bytes())
    assert pages[0] != pages[1]
    assert b"2026-03-01" not in pages[0]


@pytest.mark.slow
def test_a_certificate_at_hand_is_shown(tmp_path):
    certificate, page = ROOT / "reports/commuting.cert.json", tmp_path / "a.html"
    given = ("--certificate", str(certificate), "--out", str(page))
    assert run(COMMUTING, *given).exit_code == 0
    text = page.read_text(encoding="utf-8")
    assert json.loads(certificate.read_text(encoding="utf-8"))["id"] in text
    assert "each of its statements was checked again exactly" in text
