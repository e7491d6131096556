from fractions import Fraction

from nrs_design.models.environment import Contact, Environment, Interval

F = Fraction


def test_ends():
    assert Interval.point(F(2)).ends == (("", F(2)),)
    assert Interval(F(2), F(1), F(3)).ends == (("min", F(1)), ("max", F(3)))


def test_point_environment_has_one_corner():
    soft = Environment("soft", Interval.point(F(43)), Interval.point(F(0)))
    assert list(soft.vertices()) == [Contact("soft", F(43), F(0))]
    assert soft.nominal == Contact("soft", F(43), F(0))


def test_box_has_four_corners():
    hand = Environment("hand", Interval(F(2), F(1), F(3)), Interval(F(1), F(0), F(5)))
    assert list(hand.vertices()) == [
        Contact("hand/k-min/b-min", F(1), F(0)),
        Contact("hand/k-min/b-max", F(1), F(5)),
        Contact("hand/k-max/b-min", F(3), F(0)),
        Contact("hand/k-max/b-max", F(3), F(5)),
    ]
    assert hand.nominal == Contact("hand", F(2), F(1))


def test_one_uncertain_parameter():
    jelly = Environment("jelly", Interval.point(F(2)), Interval(F(1), F(0), F(5)))
    assert [contact.label for contact in jelly.vertices()] == ["jelly/b-min", "jelly/b-max"]
