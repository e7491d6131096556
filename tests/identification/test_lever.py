"""From a linear motion to a rotation about the pivot."""

import pytest

from nrs_design.errors import DataError
from nrs_design.identification.lever import parse_arm
from nrs_design.models.contact import Elastic


def test_thesis_arm():
    # Thesis 6.3.1.1: 747.1461 N/m at 0.24 m are 43.0356 N m/rad.
    arm = parse_arm("240 mm", rotational=False)
    assert Elastic(747.1461).at_pivot(arm).k == pytest.approx(43.0356, abs=5e-5)


@pytest.mark.parametrize(
    ("text", "rotational", "reason"),
    [
        ("0.24 m", True, "are rotational"),
        ("0 m", False, "not positive"),
        ("-0.24 m", False, "not positive"),
        ("0.24", False, "unit"),
        ("0.24 N", False, "not a length"),
        ("240 m", False, "longer than any arm"),
    ],
)
def test_bad_arm(text, rotational, reason):
    with pytest.raises(DataError, match=reason):
        parse_arm(text, rotational=rotational)
