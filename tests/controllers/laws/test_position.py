from fractions import Fraction

from nrs_design.controllers.laws import PositionControl
from nrs_design.spec import PositionControllerSpec

GIVEN = PositionControllerSpec(type="position")


def test_whatever_the_force_the_command_stays():
    command, rates = PositionControl().respond([Fraction(7), Fraction(-3)], [])
    assert (command, rates) == ([0, 0], [])


def test_there_is_no_gain_to_be_wrong():
    assert PositionControl.of({"Kp": Fraction(1)}) == PositionControl()
    assert PositionControl().gains == {}
    assert PositionControl().find_fault(GIVEN) is None
