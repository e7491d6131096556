from dataclasses import FrozenInstanceError, replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import Contact, Mode, Reset, Stay, Switching, Time
from tests.proof.systems import bouncing_in_steps, family, matrix


def test_order_is_the_number_of_states():
    assert family([[1, 2, 3], [4, 5, 6], [7, 8, 9]]).order == 3


def test_times_by_name():
    assert [str(time) for time in Time] == ["continuous", "discrete"]


def test_frozen():
    system = family([[1]])
    with pytest.raises(FrozenInstanceError):
        system.modes = ()
    with pytest.raises(FrozenInstanceError):
        system.modes[0].A = None


def test_dwell_time_of_numpy_becomes_one_of_python():
    switching = Switching(np.int64(3))
    assert switching == Switching(Fraction(3))
    assert type(switching.dwell_time.numerator) is int


@pytest.mark.parametrize(
    ("rules", "reason"),
    [
        ({"dwell_time": Fraction(-1)}, "a dwell time is negative"),
        ({"stays": (("m0", Stay(Fraction(-1))),)}, "a dwell time is negative"),
        ({"transitions": (("m0", "m0"),)}, "a transition does not lead"),
        ({"transitions": (("m0", "m9"),)}, "a transition does not lead"),
        ({"resets": (Reset("m0", "m1", RationalMatrix(((1,),), 0)),)}, "not a matrix over"),
        ({"resets": (Reset("m0", "m1", RationalMatrix(((1,),), -1)),)}, "not a matrix over"),
        ({"resets": (Reset("m0", "m1", RationalMatrix(((1,), (1, 2)))),)}, "not a matrix over"),
        ({"fixed_ends": (("m0", "m0"),)}, "not the ends of one"),
        ({"fixed_ends": (("m0", "m1"), ("m0", "m1"))}, "not the ends of one"),
    ],
)
def test_rules_that_make_no_sense(rules, reason):
    found = family([[-1]], [[-1]], switching=Switching(**rules)).find_contradiction()
    assert reason in str(found)


def test_rules_that_make_sense():
    rules = Switching(Fraction(1), (("m0", "m1"),), fixed_ends=(("m0", "m1"),))
    assert family([[-1]], [[-1]], switching=rules).find_contradiction() is None


def test_a_time_of_a_step_needs_steps():
    system = bouncing_in_steps()
    assert system.find_contradiction() is None
    for odd in (replace(system, sample_time=Fraction(0)), replace(family([[1]]), sample_time=1)):
        assert "the time of a step is not positive" in odd.find_contradiction()


def test_contact_needs_a_state_beside_the_deflection():
    contact = Contact((Mode("free", matrix([[0]])),))
    system = replace(family([[-1]]), contact=contact)
    assert "do not share a deflection" in system.find_contradiction()
    unequal = replace(family([[-1]], [[-1, 0], [0, -1]]), contact=contact)
    assert "do not share a deflection" in unequal.find_contradiction()
