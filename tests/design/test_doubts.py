"""What a design without goals is doubted for."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.design.doubts import doubt_stiffness, enough_damping
from nrs_design.design.goals import Requirement, corners_of
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.contact import Elastic
from nrs_design.models.contact.environment import Environment
from nrs_design.models.interval import Interval
from nrs_design.pipeline.runs import run_design
from nrs_design.pipeline.scenarios import run_judgement
from nrs_design.spec import read_spec
from tests.design.motion_loops import PLACE, axis_with
from tests.support import spec_in
from tests.tables import edited, rows, spec_text


def warnings(path):
    loaded = read_spec(path)
    return [str(doubt) for doubt in run_judgement(run_design(loaded)).warnings]


@pytest.mark.parametrize("case", rows(__file__, "test_a_design_is_doubted"))
def test_a_design_is_doubted(tmp_path, case):
    """Each doubt of a controller in turn begins as its row says, and says these words."""
    text = edited(spec_text(case["base"]), case.get("edit", []))
    found = warnings(spec_in(tmp_path, text))
    found = [doubt for doubt in found if doubt.startswith(case.get("about", ""))]
    assert len(found) == len(case["says"])
    for doubt, words in zip(found, case["says"], strict=True):
        assert all(word in doubt for word in words[1:])
        assert doubt.startswith(words[0])
        assert not any(word in doubt for word in case.get("never", []))


F = Fraction
EXACT = TransferFunction((0.99739, 56.8219), (0.0351, 1.99739, 56.8219))  # thesis 6.1


def loops(*contacts, motion=EXACT):
    return Requirement(axis_with(motion), corners_of(contacts, contacts[0].name, (PLACE,)))


def contact(name, k):
    return Environment(name, Elastic, (Interval.point(F(k)),))


def test_withdrawal_of_the_thesis_and_both_specimens():
    """Mt 0.01, Bt 1.04: unstable from 75.9 N m/rad on; 104.7 is what both make."""
    contacts = (contact("soft", "43.0356"), contact("soft+stiff", "104.6964"))
    (doubt,) = doubt_stiffness("withdrawal", loops(*contacts), contacts, 0.01, 1.04)
    assert doubt.at == ("controllers", "withdrawal")
    assert "soft+stiff is up to 104.696 N*m/rad stiff" in doubt.message
    assert "Bt = 1.29 N*m*s/rad would just hold it, while constant" in doubt.message


@settings(max_examples=30)
@given(k=st.floats(80, 1000), Bt=st.floats(0.5, 1.04))
def test_it_is_enough_and_a_little_less_is_not(k, Bt):
    required = loops(contact("soft", 43))
    enough = enough_damping(required, "soft", 0.01, Bt, k)
    assert required.stiffness_limits(0.01, enough)["soft"][0] > k
    assert required.stiffness_limits(0.01, 0.98 * enough)["soft"][0] <= k


def test_no_damping_may_be_enough():
    """A motion loop that is unstable by itself."""
    motion = TransferFunction((1.0,), (1.0, -1.0, 1.0))
    required = loops(contact("soft", 50), motion=motion)
    assert enough_damping(required, "soft", 0.01, 1.0, 50.0) is None
    (doubt,) = doubt_stiffness("a", required, (contact("soft", 50),), 0.01, 1.0)
    assert "no Bt would hold" in doubt.message


@pytest.mark.parametrize("Bt", [1.04, 2.15])
def test_nothing_is_said_of_what_holds(Bt):
    soft = contact("soft", "43.0356")
    assert not [*doubt_stiffness("a", loops(soft), (soft,), 0.01, Bt)]
