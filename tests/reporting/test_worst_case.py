"""In which units the worst runs are shown, and what is said to be left out."""

from math import pi

import pytest

from nrs_design.reporting.worst_case import scale_of


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
