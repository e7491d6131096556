from fractions import Fraction

from nrs_design.controllers.laws import ProportionalDerivative


def test_zero_of_the_thesis():
    # Thesis 4.3: Kp = Kd z = 2060 * 56.9706 = 117359.43.
    law = ProportionalDerivative(Fraction("117359.436"), Fraction(2060))
    assert law.zero == Fraction("56.9706")


def test_the_backward_difference_of_the_thesis_robot():
    """Kd = 2060 rpm s/rad over 2 ms is a single-precision number by itself."""
    law = ProportionalDerivative(Fraction(117359), Fraction(2060))
    assert law.over(Fraction(1, 500)) == 1_030_000
