"""In which units the worst runs are shown, and what is said to be left out."""

from fractions import Fraction
from math import pi

import pytest

from nrs_design.reporting.worst_case import left_out, scale_of
from nrs_design.switched.coupled import AxesCoupling, couple_axes
from tests.search.support import thesis_robot


@pytest.mark.parametrize(
    ("name", "unit", "arm", "shown"),
    [
        ("force", "N*m", 0.24, (1.0, "N m")),
        ("velocity", "rad/s", None, (180 / pi, "deg/s")),
        ("deflection", "rad", 0.24, (240.0, "mm")),
        ("deflection", "rad", None, (180 / pi, "deg")),
        ("motor command", "rpm", 0.24, (1.0, "rpm")),
    ],
)
def test_units(name, unit, arm, shown):
    assert scale_of(name, unit, arm) == shown


def test_that_others_push_is_left_out_where_links_couple_axes():
    alone = thesis_robot(("41.5", "44.2"), ("2.15",), "0.01", load="1.213")
    among = couple_axes(alone, AxesCoupling(Fraction("1.213"), Fraction(0), Fraction("0.3")))
    assert left_out(among) == f"{left_out(alone)}, and what other axes do through the links"
    assert "the limit of the command" in left_out(alone)
