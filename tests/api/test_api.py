"""The library at the door."""

import doctest

import pytest

import nrs_design as nrs
from nrs_design.api import identified, matrices, study
from tests.support import ROOT, started


def test_import_loads_nothing_heavy():
    code = (
        "import sys, nrs_design; print(sorted({'numpy', 'pydantic', 'scipy'} & set(sys.modules)))"
    )
    assert started("-c", code, cwd=ROOT).stdout.strip() == "[]"
    assert set(nrs.__all__) <= set(dir(nrs))
    with pytest.raises(AttributeError, match="no attribute 'nope'"):
        _ = nrs.nope


def test_examples_in_docstrings(monkeypatch):
    monkeypatch.chdir(ROOT)
    found = [doctest.testmod(module) for module in (identified, matrices, study)]
    assert all(result.attempted for result in found)
    assert not any(result.failed for result in found)


def test_the_readme_runs_as_it_stands():
    text = (ROOT / "README.md").read_text()
    code = text.partition("## From Python\n\n```python\n")[2].partition("```")[0]
    names: dict[str, object] = {}
    exec(code, names)
    assert names["decision"].verdict == "proved"
