"""An answer fits a screen: words and columns of what commands print unless -v is given."""

import pytest

from tests.support import ROOT, SOFT_TISSUE, run
from tests.tables import rows, words_in


@pytest.mark.parametrize(
    ("most", "code", "arguments"),
    rows(__file__, "test_words_and_columns"),
    ids=lambda value: str(value).split()[0],
)
def test_words_and_columns(tmp_path, monkeypatch, most, code, arguments):
    monkeypatch.delenv("COLUMNS")
    shown = run(*words_in(arguments), cwd=tmp_path, code=code).stdout
    # Paths are as long as this folder is deep.
    shown = shown.replace(str(ROOT), "")
    assert 0 < len(shown.split()) <= most
    assert max(map(len, shown.splitlines())) <= 100


def test_a_green_gate_needs_no_more_than_a_line(tmp_path):
    run("gate", SOFT_TISSUE, "--no-reports", "--lock", "nrs.lock", cwd=tmp_path, code=0)
    shown = run("gate", SOFT_TISSUE, "--locked", cwd=tmp_path, code=0).stdout
    assert shown.count("\n") == 1
    assert len(shown.split()) <= 20
