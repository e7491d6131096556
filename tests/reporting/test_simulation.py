"""Numbers that have a limit are rounded away from it."""

import pytest

from nrs_design.reporting.simulation import four_digits_up


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.3, "0.3"),
        (0.1, "0.1"),
        (0.30001, "0.3001"),
        (0.99999, "1"),
        (3.2e-10, "3.2e-10"),
        (1234567.0, "1.235e+06"),
    ],
)
def test_a_torque_above_its_limit_is_never_shown_at_it(value, text):
    assert four_digits_up(value) == text
