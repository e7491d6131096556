"""A sampled law whose gains are in a box, and the box of its coefficients."""

from fractions import Fraction

import pytest

from nrs_design.controllers.laws import Admittance, ProportionalForce
from nrs_design.controllers.step_law import StepFrame
from nrs_design.errors import AssemblyError
from nrs_design.models.interval import Interval
from nrs_design.switched.gain_box import GainBox
from nrs_design.switched.sampled_frame import Frame
from nrs_design.switched.sampled_gains import RangedLaw

PERIOD = Fraction(1, 500)


def gains_of(Mt, Bt, Kt=(0, 0)):
    ranges = [Interval(*map(Fraction, (low, low, high))) for low, high in (Mt, Bt, Kt)]
    law = Admittance(*(interval.nominal for interval in ranges))
    names = ("Mt", "Bt", "Kt") if law.Kt else ("Mt", "Bt")
    box = GainBox(law, dict(zip(names, ranges, strict=False)))
    return RangedLaw.of(law.discretize(PERIOD, "exact"), box, PERIOD, "exact")


def test_a_point_is_the_law_that_ships():
    gains = gains_of(("0.01", "0.01"), (2, 2))
    assert not gains.box.ranges
    assert gains.at({"k": Fraction(3)}) is gains.law
    force = ProportionalForce(Fraction(1, 50)).discretize(PERIOD, "exact")
    assert (
        RangedLaw.of(force, GainBox.point(Admittance(*[Fraction(1)] * 2)), PERIOD, "").law is force
    )


def test_the_law_at_a_corner():
    gains = gains_of(("0.01", "0.01"), (1, 2), ("0.5", 1))
    assert set(gains.box.ranges) == {"a", "c", "Kt"}
    law = gains.at({"a": Fraction(1, 2), "c": Fraction(3, 4), "Kt": Fraction(1), "k": Fraction(9)})
    T = gains.law.numbers["T"]
    assert law.numbers == {"a": Fraction(1, 2), "b": Fraction(3, 8), "T": T, "Kt": 1}


def test_without_inertia_b_is_in_a_range_itself():
    gains = gains_of((0, 0), (1, 2))
    assert gains.at({"c": Fraction(3, 4)}).numbers["b"] == Fraction(3, 4)
    assert "b of x stays in [0.5, 1]" in " ".join(gains.texts("x"))


def test_corners_hold_what_lies_between_them():
    """The rows of a frame are affine in a, c and Kt: the box checks that exactly, and yields 8."""
    step = StepFrame(Fraction(10**5), Fraction(10**6))
    for springs in (("0.5", 1), (0, 0)):
        gains = gains_of(("0.01", "0.02"), (1, 2), springs)
        frame = Frame(PERIOD, step, (gains.law,), 1, Fraction(1, 20))
        motor = {"Km": Fraction(1, 2000), "E": Fraction(9, 10), "k": Fraction(43)}

        def rows_at(values, frame=frame, motor=motor, gains=gains):
            return frame.rows(gains.at(values), 0, {**motor, **values})

        assert len(list(gains.box.corners(rows_at, "x"))) == (
            8 if gains.law.numbers.get("Kt") else 4
        )


def test_a_box_in_which_single_precision_loses_a_coefficient_is_no_loop():
    with pytest.raises(AssemblyError, match="loses a coefficient"):
        gains_of((1, 10**7), (1, 1))
