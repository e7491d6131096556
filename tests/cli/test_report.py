import json

import pytest

from tests.support import COMMUTING, ROOT, run


def test_a_date_is_written_only_if_given(tmp_path):
    pages = []
    for dates in ((), ("--date", "2026-03-01")):
        run("report", COMMUTING, "--out", "c.html", *dates, cwd=tmp_path, code=0)
        pages.append((tmp_path / "c.html").read_bytes())
    assert [b"2026-03-01" in page for page in pages] == [False, True]


@pytest.mark.slow
def test_a_certificate_at_hand_is_shown(tmp_path):
    certificate = ROOT / "reports/commuting.cert.json"
    given = ("--certificate", certificate, "--out", "a.html")
    run("report", COMMUTING, *given, cwd=tmp_path, code=0)
    text = (tmp_path / "a.html").read_text(encoding="utf-8")
    assert json.loads(certificate.read_text(encoding="utf-8"))["id"] in text
    assert "each of its statements was checked again exactly" in text
