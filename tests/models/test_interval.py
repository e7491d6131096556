from fractions import Fraction

from nrs_design.models.interval import Interval

F = Fraction


def test_ends():
    assert Interval.point(F(2)).ends == (("", F(2)),)
    assert Interval(F(2), F(1), F(3)).ends == (("min", F(1)), ("max", F(3)))


def test_scaled_about_the_nominal_value():
    assert Interval(F(2), F(1), F(5)).scaled(F(1, 2)) == Interval(F(2), F(3, 2), F(7, 2))
    assert Interval(F(2), F(1), F(5)).scaled(F(0)) == Interval.point(F(2))
    assert Interval(F(2), F(1), F(5)).middle == 3
