from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import AssemblyError
from nrs_design.models.contact import Elastic, KelvinBoltzmann, KelvinVoigt, Maxwell
from nrs_design.models.contact.environment import Environment, touch_at_once
from nrs_design.models.interval import Interval

F = Fraction
SPAN = Interval(F(2), F(1), F(3))
POINT = Interval.point(F(5))


def test_a_corner_for_every_end_of_what_has_a_range():
    nose = Environment("nose", KelvinBoltzmann, (SPAN, POINT, SPAN))
    assert [law.exact for law in nose.corners] == [(1, 5, 1), (1, 5, 3), (3, 5, 1), (3, 5, 3)]
    assert list(Environment("soft", Elastic, (POINT,)).corners) == [Elastic(F(5))]


def test_stiffness_is_that_of_a_sudden_motion():
    assert Environment("nose", KelvinBoltzmann, (POINT, SPAN, POINT)).stiffness == SPAN


def test_rates_of_a_memory_reach_from_the_softest_spring_to_the_stiffest():
    """k1 in [1, 3] and b in [1, 3]: k1/b in [1/3, 3], and k2/b of one k2."""
    nose = Environment("nose", KelvinBoltzmann, (SPAN, POINT, SPAN))
    k2 = POINT.nominal
    assert nose.memory_rates == (
        Interval(F(1), F(1, 3), F(3)),
        Interval(k2 / SPAN.nominal, k2 / 3, k2),
    )
    assert Environment("gel", Maxwell, (SPAN, SPAN)).memory_rates is None


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


SOFT = Environment("soft", Elastic, (Interval.point(F("747.1461") * F("0.24") ** 2),))
STIFF = Environment("stiff", Elastic, (Interval.point(F("1070.5") * F("0.24") ** 2),))
stiffnesses = st.fractions("1/2", 50, max_denominator=50)


def test_specimens_of_the_thesis_touched_at_once():
    """Thesis 6.4.1: 43.0356 and 61.6608 N m/rad; 104.7 together."""
    both = touch_at_once((SOFT, STIFF), losable=True)
    assert (both.name, both.law) == ("soft+stiff", Elastic)
    assert float(both.stiffness.high) == pytest.approx(104.6964, abs=1e-4)
    assert both.stiffness.low == SOFT.stiffness.low
    assert both.stiffness.nominal == both.stiffness.high
    kept = touch_at_once((SOFT, STIFF), losable=False)
    assert kept.stiffness == Interval.point(both.stiffness.high)


@given(
    parts=st.lists(
        st.tuples(stiffnesses, stiffnesses, st.fractions(0, 3, max_denominator=20)),
        min_size=2,
        max_size=4,
    ),
    depth=st.fractions("1/100", 5, max_denominator=100),
    at=st.lists(st.fractions(0, 1, max_denominator=10), min_size=4, max_size=4),
)
def test_each_from_where_its_surface_is(parts, depth, at):
    """The force of any surfaces, at any values of the ranges, is k delta with k in the range."""
    first = min(surface for *_, surface in parts)
    springs = []
    force = F(0)
    for (a, b, surface), share in zip(parts, at, strict=False):
        low, high = sorted((a, b))
        springs.append(Environment(f"e{len(springs)}", Elastic, (Interval(high, low, high),)))
        k = low + share * (high - low)
        force += k * max(F(0), depth - (surface - first))
    felt = touch_at_once(tuple(springs), losable=True).stiffness
    assert felt.low <= force / depth <= felt.high


def test_dampers_add_up_and_are_kept():
    hand = Environment("hand", KelvinVoigt, (SPAN, Interval(F(1), F(0), F(5))))
    both = touch_at_once((hand, SOFT), losable=False)
    assert both.law is KelvinVoigt
    assert both.parameters == {
        "k": Interval(*(end + SOFT.stiffness.low for end in (F(2), F(1), F(3)))),
        "b": Interval(F(1), F(0), F(5)),
    }


@pytest.mark.parametrize("losable", [True, False])
def test_parts_are_stretched_each_by_itself(losable):
    """A stretched sum still covers each part alone."""
    parts = tuple(Environment(n, Elastic, (Interval(F(4), F(3), F(6)),)) for n in "ab")
    stretched = touch_at_once(parts, losable=losable).scaled(F(1, 2))
    low = F(7, 2) if losable else F(7)
    assert stretched.stiffness == Interval(F(8), low, F(10))
    assert [part.stiffness for part in stretched.parts] == [Interval(F(4), F(7, 2), F(5))] * 2
