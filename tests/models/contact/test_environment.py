from fractions import Fraction

from nrs_design.models.contact.environment import Contact, Environment, Interval

F = Fraction


def test_ends():
    assert Interval.point(F(2)).ends == (("", F(2)),)
    assert Interval(F(2), F(1), F(3)).ends == (("min", F(1)), ("max", F(3)))


def test_nominal_contact():
    hand = Environment("hand", Interval(F(2), F(1), F(3)), Interval(F(1), F(0), F(5)))
    assert hand.nominal == Contact("hand", F(2), F(1))
