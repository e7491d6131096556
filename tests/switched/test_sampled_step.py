"""How large the roundings of a sampled law are at most: in short numbers, never less."""

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.step_law import StepFrame
from nrs_design.switched.sampled_frame import Frame
from nrs_design.switched.sampled_step import short

MOTION = StepFrame(Fraction(117359), Fraction(1_030_000))


@given(st.fractions(max_denominator=10**6).filter(bool))
def test_a_short_number_is_not_smaller(size):
    """Of either sign: a sign says nothing of how large a rounding is."""
    found = short(size)
    assert abs(size) <= abs(found) <= abs(size) * (1 + Fraction(1, 64))
    assert (found > 0) == (size > 0)
    assert abs(found.numerator).bit_length() <= 9 or found.denominator == 1


def test_nothing_stays_nothing():
    assert short(Fraction(0)) == 0


def test_a_velocity_that_changes_its_sign_is_rounded_as_much():
    """Euler's method gives a negative a where Bt T > Mt."""
    values = {"Km": Fraction(1, 2000), "E": Fraction(9, 10)}
    a, sizes = Fraction(3, 7), []
    for sign in (1, -1):
        law = Admittance.discrete(sign * a, Fraction(1), Fraction(1, 500))
        frame = Frame(Fraction(1, 500), MOTION, (law,), 0, Fraction("0.0351"))
        row = len(frame.states) + [*frame.roundings].index("a vm")
        sizes.append(frame.rows(law, 0, values)[row][frame.states.index("vm [rad/s]")])
    assert sizes[0] == -sizes[1]
    assert sizes[0] >= frame.roundings["a vm"] * a
