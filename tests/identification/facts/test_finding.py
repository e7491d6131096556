"""What the documents of all identifications have."""

from nrs_design.identification.facts.finding import estimate_numbers
from nrs_design.identification.statistics import Estimate


def test_unlimited_is_null_in_json():
    assert estimate_numbers(Estimate(2.0, 1.0, 3.0)) == {"value": 2.0, "low": 1.0, "high": 3.0}
    assert estimate_numbers(Estimate(2.0, 1.0, float("inf")))["high"] is None
