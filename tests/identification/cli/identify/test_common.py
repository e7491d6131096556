"""What all identifications share: columns by name, and where results go."""

from pathlib import Path

import pytest

from nrs_design.cli.destinations import Destinations
from nrs_design.errors import NrsDesignError, OutputError, SpecError
from nrs_design.identification.cli.identify.common import estimate_numbers, read_all, sources
from nrs_design.identification.datasets import Source
from nrs_design.identification.statistics import Estimate
from tests.support import SOFT_TISSUE


def test_unlimited_is_null_in_json():
    assert estimate_numbers(Estimate(2.0, 1.0, 3.0)) == {"value": 2.0, "low": 1.0, "high": 3.0}
    assert estimate_numbers(Estimate(2.0, 1.0, float("inf")))["high"] is None


def test_files_are_known_by_their_hash():
    found = sources([Source(Path("a.csv"), "ab" * 32, synthetic=True)])
    assert found == [{"file": "a.csv", "sha256": "ab" * 32, "synthetic": True}]


NAMES = {"Fz": "force_N"}


def test_columns_are_renamed_for_every_file():
    read = read_all(
        [Path("a"), Path("b")],
        lambda path, names, tell: (path.name, names),
        ["force_N=Fz"],
    )
    assert read == [("a", NAMES), ("b", NAMES)]


@pytest.mark.parametrize("entry", ["force", "=Fz", "force_N="])
def test_a_column_without_a_name(entry):
    with pytest.raises(NrsDesignError):
        read_all([], lambda path, names, tell: None, [entry])


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
