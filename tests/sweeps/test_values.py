"""Values of a field: lists and ranges, exactly as a spec writes them."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_exact
from nrs_design.sweeps.values import parse_values
from tests.tables import rows


def listed(text):
    values = parse_values(text)
    return [values[at] for at in range(len(values))]


@pytest.mark.parametrize(("text", "values"), rows(__file__, "test_values"))
def test_values(text, values):
    assert listed(text) == values


def test_a_range_is_exact_and_as_long_as_it_says():
    """No value passes through a float, and none is written before it is asked for."""
    values = parse_values("1..250/1000000000 N")
    assert len(values) == 10**9
    assert parse_exact(values[10**9 - 1].partition(" ")[0]) == 250
    assert parse_exact(values[1].partition(" ")[0]) == 1 + parse_exact("249/999999999")


REFUSED = "|,|1,|2..1/3 N|1..1 N|1..2/0 N|1..2/1|1.5..2|1...2 N|a..b|1..2/-3|1..|[1, 2]|1,2,1 N"


@pytest.mark.parametrize("text", REFUSED.split("|"))
def test_what_has_no_values_is_refused(text):
    with pytest.raises(SpecError):
        parse_values(text)
