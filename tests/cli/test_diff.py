"""`nrs-design diff`, as a user types it."""

from tests.support import COMMUTING, ROOT, document_of, run

CERTIFICATE = ROOT / "reports" / "commuting.cert.json"
OTHER = ROOT / "reports" / "ando-shih.cert.json"


def test_text_and_exit_codes(tmp_path):
    done = run("diff", COMMUTING, CERTIFICATE, cwd=tmp_path, code=0)
    assert "the same: gains, verdict, assumptions" in done.stdout
    assert "Not compared, since not both files tell it: spec, margins." in done.stdout
    done = run("diff", CERTIFICATE, OTHER, "-v", cwd=tmp_path, code=1)
    assert "decay rate" in done.stdout
    assert "verdict, A: Every solution" in done.stdout
    short = run("diff", CERTIFICATE, OTHER, cwd=tmp_path, code=1).stdout
    assert "verdict: 2 texts differ (-v shows them)" in short
    assert list(tmp_path.iterdir()) == []


def test_json_and_page(tmp_path):
    found = document_of("diff", CERTIFICATE, OTHER, "--report", "diff.html", cwd=tmp_path, code=1)
    assert found["schema"] == "nrs-design/diff/1"
    assert found["a"]["name"] == "commuting"
    assert {"part": "verdict", "what": "modes", "a": "2", "b": "2"} not in found["differences"]
    parts = {item["part"] for item in found["differences"]}
    assert parts == {"verdict"}
    assert "different" in (tmp_path / "diff.html").read_text()


def test_wrong_input(tmp_path):
    assert "nosuch.json" in run("diff", COMMUTING, "nosuch.json", cwd=tmp_path, code=2).stderr
    run("diff", COMMUTING, CERTIFICATE, "--report", "diff.txt", cwd=tmp_path, code=2)
    assert list(tmp_path.iterdir()) == []
