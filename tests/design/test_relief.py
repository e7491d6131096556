"""What would hold where a contact is too stiff."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.design.impedance import ImpedanceLoop
from nrs_design.design.margins import stiffness_limit
from nrs_design.design.relief import doubt_stiffness, enough_damping
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.contact import Elastic
from nrs_design.models.contact.environment import Environment
from nrs_design.spec.interval import Interval

F = Fraction
EXACT = TransferFunction((0.99739, 56.8219), (0.0351, 1.99739, 56.8219))  # thesis 6.1
LOOP = ImpedanceLoop(EXACT, Elastic(43.0))


def contact(name, k):
    return Environment(name, Elastic, (Interval.point(F(k)),))


def test_withdrawal_of_the_thesis_and_both_specimens():
    """Mt 0.01, Bt 1.04: unstable from 75.9 N m/rad on; 104.7 is what both make."""
    contacts = (contact("soft", "43.0356"), contact("soft+stiff", "104.6964"))
    (doubt,) = doubt_stiffness("withdrawal", LOOP, contacts, 0.01, 1.04)
    assert doubt.at == ("controllers", "withdrawal")
    assert "soft+stiff, up to 104.696 N*m/rad" in doubt.message
    assert "Bt = 1.29 N*m*s/rad would hold one such contact, all else nominal" in doubt.message


@settings(max_examples=30)
@given(k=st.floats(80, 1000), Bt=st.floats(0.5, 1.04))
def test_it_is_enough_and_a_little_less_is_not(k, Bt):
    enough = enough_damping(LOOP, 0.01, Bt, k)
    assert stiffness_limit(LOOP, 0.01, enough) > k
    assert stiffness_limit(LOOP, 0.01, 0.98 * enough) <= k


def test_no_damping_may_be_enough():
    """A motion loop that is unstable by itself."""
    loop = ImpedanceLoop(TransferFunction((1.0,), (1.0, -1.0, 1.0)), Elastic(43.0))
    assert enough_damping(loop, 0.01, 1.0, 50.0) is None
    (doubt,) = doubt_stiffness("a", loop, (contact("soft", 50),), 0.01, 1.0)
    assert "no Bt would hold" in doubt.message


@pytest.mark.parametrize("Bt", [1.04, 2.15])
def test_nothing_is_said_of_what_holds(Bt):
    assert not [*doubt_stiffness("a", LOOP, (contact("soft", "43.0356"),), 0.01, Bt)]
