"""`nrs-design diff`, as a user types it."""

import json

from tests.support import COMMUTING, ROOT, run

CERTIFICATE = ROOT / "reports" / "commuting.cert.json"
OTHER = ROOT / "reports" / "ando-shih.cert.json"


def test_text_and_exit_codes(tmp_path):
    done = run("diff", COMMUTING, CERTIFICATE, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "the same: gains, verdict, assumptions" in done.stdout
    assert "Not compared, since not both files tell it: spec, margins." in done.stdout
    done = run("diff", CERTIFICATE, OTHER, cwd=tmp_path)
    assert done.returncode == 1
    assert "decay rate" in done.stdout
    assert "verdict, A: Every solution" in done.stdout
    assert list(tmp_path.iterdir()) == []


def test_json_and_page(tmp_path):
    done = run("diff", CERTIFICATE, OTHER, "--json", "--report", "diff.html", cwd=tmp_path)
    assert done.returncode == 1
    found = json.loads(done.stdout)
    assert found["schema"] == "nrs-design/diff/1"
    assert found["a"]["name"] == "commuting"
    assert {"part": "verdict", "what": "modes", "a": "2", "b": "2"} not in found["differences"]
    parts = {item["part"] for item in found["differences"]}
    assert parts == {"verdict"}
    assert "different" in (tmp_path / "diff.html").read_text()


def test_wrong_input(tmp_path):
    done = run("diff", COMMUTING, "nosuch.json", cwd=tmp_path)
    assert done.returncode == 2
    assert "nosuch.json" in done.stderr
    done = run("diff", COMMUTING, CERTIFICATE, "--report", "diff.txt", cwd=tmp_path)
    assert done.returncode == 2
    assert list(tmp_path.iterdir()) == []
