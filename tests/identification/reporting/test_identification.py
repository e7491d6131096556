"""The page of an identification."""

import shutil

import pytest

from nrs_design.identification.actuator.identify import identify_actuator
from nrs_design.identification.datasets.records import read_actuator, read_tissue
from nrs_design.identification.reporting.actuator import view_actuator
from nrs_design.identification.reporting.tissue import view_tissue
from nrs_design.identification.tissue.identify import identify_tissue
from nrs_design.reporting import render_html
from tests.support import ROOT

DATA = ROOT / "specs" / "data"


@pytest.fixture(scope="module")
def tissue():
    records = [read_tissue(path) for path in sorted(DATA.glob("silicone-soft-*.csv"))]
    return view_tissue(identify_tissue(records), 0.24).page()


@pytest.fixture(scope="module")
def actuator():
    paths = [DATA / f"actuator-{name}hz.csv" for name in ("2", "3", "4p5", "8", "15")]
    return view_actuator(identify_actuator([*map(read_actuator, paths)])).page()


def test_tissue_page(tissue):
    page = render_html(tissue)
    assert '<body class="identified">' in page
    assert page.count("SYNTHETIC") >= 5
    for text in ("Comparison of laws", "Doubts", "at the pivot", "BIC"):
        assert text in page
    assert "certificate" not in page
    assert [item.name for item in tissue.illustrations] == ["fit-1", "fit-2", "fit-3"]


@pytest.mark.slow
def test_actuator_page(actuator):
    page = render_html(actuator)
    held = "the range holds gain and time constant of the recorded motor, both at once with 95 %"
    for text in ("time constant", "Measured against fitted", held):
        assert text in page


@pytest.mark.slow
def test_names_of_records_are_text(tmp_path):
    """Not formulas, not markup, not marks that turn the direction of writing."""
    names = ["a$\\frac{$", 'b<i>&"$x$', "c\u202efdp", "a%\\frac{%", "שלום 中"]
    paths = [tmp_path / f"{name}.csv" for name in names]
    for i, path in enumerate(paths, 1):
        shutil.copy(DATA / f"concha-{i}.csv", path)
    found = identify_tissue([read_tissue(path) for path in paths], "kelvin-voigt")
    page = render_html(view_tissue(found).page())
    assert "b&lt;i&gt;&amp;&#34;$x$" in page
    assert "c\\u202efdp" in page
    assert "\u202e" not in page
