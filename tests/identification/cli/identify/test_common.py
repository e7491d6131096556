"""What all identifications share: where results go."""

import pytest

from nrs_design.cli.destinations import Destinations
from nrs_design.errors import OutputError, SpecError
from tests.support import SOFT_TISSUE


def checked(write=None, report=None):
    return Destinations.checked(write, report, None)


def test_outputs_are_refused_before_the_work(tmp_path):
    with pytest.raises(OutputError, match="is not the name of a page"):
        checked(report=tmp_path / "page.png")
    with pytest.raises(OutputError, match="is not the name of a page"):
        checked(report=tmp_path / "page")
    with pytest.raises(SpecError):
        checked(write=tmp_path / "none.nrs.yaml")


def test_a_page_and_a_spec(tmp_path):
    for name in ("page.html", "page.HTM"):
        assert checked(report=tmp_path / name).report == tmp_path / name
    assert checked(write=SOFT_TISSUE).spec.path == SOFT_TISSUE
