from fractions import Fraction

import pytest

from nrs_design.errors import AssemblyError
from nrs_design.models.contact import Elastic, KelvinBoltzmann, KelvinVoigt, Maxwell
from nrs_design.models.contact.environment import Environment
from nrs_design.spec.interval import Interval

F = Fraction
SPAN = Interval(F(2), F(1), F(3))
POINT = Interval.point(F(5))


def test_nominal_law():
    hand = Environment("hand", KelvinVoigt, (SPAN, Interval(F(1), F(0), F(5))))
    assert hand.nominal == KelvinVoigt(F(2), F(1))
    assert hand.stiffness == SPAN


def test_a_corner_for_every_end_of_what_has_a_range():
    nose = Environment("nose", KelvinBoltzmann, (SPAN, POINT, SPAN))
    assert [law.exact for law in nose.corners] == [(1, 5, 1), (1, 5, 3), (3, 5, 1), (3, 5, 3)]
    assert list(Environment("soft", Elastic, (POINT,)).corners) == [Elastic(F(5))]


def test_stiffness_is_that_of_a_sudden_motion():
    assert Environment("nose", KelvinBoltzmann, (POINT, SPAN, POINT)).stiffness == SPAN


def test_creep_reaches_from_the_softest_spring_to_the_stiffest():
    """k1 in [1, 3] and b in [1, 3]: k1/b in [1/3, 3]."""
    nose = Environment("nose", KelvinBoltzmann, (SPAN, POINT, SPAN))
    assert nose.creep == Interval(F(1), F(1, 3), F(3))
    assert Environment("gel", Maxwell, (SPAN, SPAN)).creep is None


@pytest.mark.parametrize(
    ("law", "ranges", "reached"),
    [
        (Elastic, (SPAN,), "stiffness"),
        (KelvinVoigt, (POINT, SPAN), "damping"),
        (Maxwell, (POINT, SPAN), "damping"),
        (KelvinBoltzmann, (SPAN, POINT, POINT), "stiffness"),
        (KelvinBoltzmann, (POINT, POINT, SPAN), "damping"),
    ],
)
def test_ranges_stay_physical(law, ranges, reached):
    environment = Environment("x", law, ranges)
    assert environment.scaled(F(19, 10)).ranges == tuple(i.scaled(F(19, 10)) for i in ranges)
    with pytest.raises(AssemblyError, match=f"environment x reaches a {reached}"):
        environment.scaled(F(3))


def test_only_parallel_damping_may_vanish():
    assert Environment("x", KelvinVoigt, (POINT, SPAN)).scaled(F(2)).ranges[1].low == 0
    for law in (Maxwell, KelvinVoigt):
        with pytest.raises(AssemblyError):
            Environment("x", law, (SPAN, POINT)).scaled(F(2))
    with pytest.raises(AssemblyError, match="damping"):
        Environment("x", Maxwell, (POINT, SPAN)).scaled(F(2))
