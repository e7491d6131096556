"""Intervals that are drawn into a map."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import read_spec
from nrs_design.sweeps.marks import Mark, declared_marks, read_marks
from nrs_design.sweeps.tiles import read_tiles
from tests.support import ROOT

TWO = ROOT / "specs" / "neuroboscope" / "tissue-and-tool.nrs.yaml"


def tiles(*said):
    return read_tiles(read_spec(TWO), TWO, list(said))


def test_ranges_of_all_environments_are_marked():
    """Thesis 6.1: the fits of soft silicone, and of what stands for a tool."""
    grid = tiles("actuator.time_constant=30,35 ms", "environments.soft.stiffness=300..1100/4 N/m")
    assert declared_marks(grid) == (
        Mark(1, "soft", 720.56, 768.17),
        Mark(1, "stiff", 1055.4, 1079.6),
    )


def test_what_has_another_unit_is_not():
    assert declared_marks(tiles("actuator.time_constant=30..40/2 ms")) == ()


def test_own_marks():
    grid = tiles("environments.soft.stiffness=300..1100/4 N/m")
    assert read_marks(grid, ["hand = 434..1570 N/m"]) == (Mark(0, "hand", 434, 1570),)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("434..1570 N/m", "marks nothing"),
        ("hand=434 N/m", "marks nothing"),
        ("hand=a..b N/m", "marks nothing"),
        ("hand=1570..434 N/m", "not an interval"),
        ("hand=25..90 N*m/rad", "not an interval of a field"),
    ],
)
def test_bad_marks(said, words):
    with pytest.raises(SpecError, match=words):
        read_marks(tiles("environments.soft.stiffness=300..1100/4 N/m"), [said])
