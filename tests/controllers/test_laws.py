from dataclasses import FrozenInstanceError
from fractions import Fraction

import pytest

from nrs_design.controllers.laws import Admittance, ProportionalDerivative


def test_zero_of_the_thesis():
    # Thesis 4.3: Kp = Kd z = 2060 * 56.9706 = 117359.43.
    law = ProportionalDerivative(Fraction("117359.436"), Fraction(2060))
    assert law.zero == Fraction("56.9706")


def test_laws_are_values():
    assert Admittance(Fraction(1), Fraction(2)) == Admittance(Fraction(1), Fraction(2))
    with pytest.raises(FrozenInstanceError):
        Admittance(Fraction(1), Fraction(2)).Bt = Fraction(3)
