"""An answer fits a screen: words and columns of what commands print unless -v is given."""

import pytest

from tests.support import ROOT, SOFT_TISSUE, run

EXAMPLES, DATA = ROOT / "docs/examples", ROOT / "specs/data"
RECORDS = [DATA / f"silicone-soft-{i}.csv" for i in (1, 2, 3)]
CERTIFICATE = ROOT / "reports/soft-tissue.cert.json"


@pytest.mark.parametrize(
    ("most", "code", "arguments"),
    [
        (45, 0, ("certify-switching", SOFT_TISSUE)),
        (60, 1, ("certify-switching", EXAMPLES / "hand-range.nrs.yaml", "--no-optimize-rate")),
        # With two changes that are proved, one of them of the gains.
        (105, 3, ("certify-switching", EXAMPLES / "pulling.nrs.yaml")),
        (15, 0, ("check", SOFT_TISSUE)),
        (30, 0, ("verify", CERTIFICATE, SOFT_TISSUE)),
        (60, 0, ("identify", "tissue", *RECORDS)),
        (70, 0, ("simulate", EXAMPLES / "scenarios.nrs.yaml", "--no-bound")),
        (125, 0, ("optimize", SOFT_TISSUE)),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else None,
)
def test_words_and_columns(tmp_path, monkeypatch, most, code, arguments):
    monkeypatch.delenv("COLUMNS")
    shown = run(*arguments, cwd=tmp_path, code=code).stdout
    # Paths are as long as this folder is deep.
    shown = shown.replace(str(ROOT), "")
    assert 0 < len(shown.split()) <= most
    assert max(map(len, shown.splitlines())) <= 100


def test_a_green_gate_needs_no_more_than_a_line(tmp_path):
    run("gate", SOFT_TISSUE, "--no-reports", "--lock", "nrs.lock", cwd=tmp_path, code=0)
    shown = run("gate", SOFT_TISSUE, "--locked", cwd=tmp_path, code=0).stdout
    assert shown.count("\n") == 1
    assert len(shown.split()) <= 20
