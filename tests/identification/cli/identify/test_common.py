"""What all identifications share: columns by name, and where results go."""

import pytest

from nrs_design.cli.destinations import Destinations
from nrs_design.errors import OutputError, SpecError
from nrs_design.identification.cli.identify.common import estimate_numbers
from nrs_design.identification.statistics import Estimate
from tests.support import SOFT_TISSUE


def test_unlimited_is_null_in_json():
    assert estimate_numbers(Estimate(2.0, 1.0, 3.0)) == {"value": 2.0, "low": 1.0, "high": 3.0}
    assert estimate_numbers(Estimate(2.0, 1.0, float("inf")))["high"] is None


def checked(write=None, report=None):
    return Destinations.checked(write, report, None)


def test_outputs_are_refused_before_the_work(tmp_path):
    with pytest.raises(OutputError, match=r"\.png is not a type of report"):
        checked(report=tmp_path / "page.png")
    with pytest.raises(OutputError, match="no ending"):
        checked(report=tmp_path / "page")
    with pytest.raises(SpecError):
        checked(write=tmp_path / "none.nrs.yaml")


def test_both_types_of_page_and_a_spec(tmp_path):
    for name in ("page.html", "page.HTM", "page.PDF"):
        assert checked(report=tmp_path / name).report == tmp_path / name
    assert checked(write=SOFT_TISSUE).spec.path == SOFT_TISSUE
