from fractions import Fraction

import pytest

from nrs_design.models.linear_form import combine, coordinates, zero

F = Fraction


def test_a_sum_of_forms_is_exact():
    third = [F(1, 3), F(0)]
    assert combine((F(3), third), (F(-1, 2), [F(2), F(4)])) == [0, -2]
    assert combine((F(0), third)) == zero(2)


def test_forms_of_different_states_have_no_sum():
    with pytest.raises(ValueError, match="zip"):
        combine((F(1), coordinates(1)[0]), (F(1), coordinates(2)[0]))
