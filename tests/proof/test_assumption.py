"""An assumption is data: its id, and what its sentence is filled with."""

from fractions import Fraction

from nrs_design.proof.assumption import Assumption


def test_values_are_texts_and_empty_ones_are_left_out():
    made = Assumption.create("a.b", one=Fraction(1, 2), many=("x", "y"), none=None, no=False, e="")
    assert made == Assumption("a.b", (("one", ("1/2",)), ("many", ("x", "y"))))
    assert str(made) == "a.b (one: 1/2; many: x, y)"
    assert Assumption.create("a.b", none=()) == Assumption("a.b")
