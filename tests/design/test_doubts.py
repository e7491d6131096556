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
from tests.support import FORCE_LIMIT, SOFT_TISSUE, replaced, spec_in
from tests.tables import spec_text


def warnings(path):
    loaded = read_spec(path)
    return [str(doubt) for doubt in run_judgement(run_design(loaded)).warnings]


def changed(tmp_path, *replacements, source=SOFT_TISSUE):
    return spec_in(tmp_path, replaced(source.read_text(), *replacements), "changed")


def about(found, name):
    return [text for text in found if text.startswith(f"{name}: ") and " is on its " not in text]


def test_the_withdrawal_of_the_thesis_is_doubted_and_its_bounds_are_named(tmp_path):
    """Mt = 0.01, Bt = 1.04: Ms 3.58 at the nominal stiffness, more at the stiffest tissue."""
    found = warnings(SOFT_TISSUE)
    assert about(found, "insertion") == []
    (text,) = about(found, "withdrawal")
    assert "sensitivity peak Ms 3.753 (usual: at most 2)" in text
    assert "gain margin 1.716 (usual: at least 2)" in text
    assert text.endswith("max_sensitivity_peak, min_gain_margin, min_phase_margin")
    assert "insertion: Mt is on its lower bound 0.01 kg*m^2" in found
    assert not any("Bt is on" in text for text in found)


def test_a_goal_for_the_peak_speaks_of_gain_and_phase_too(tmp_path):
    path = changed(tmp_path, ("switching:", "goals: {max_sensitivity_peak: 4}\nswitching:"))
    assert about(warnings(path), "withdrawal") == []


def test_a_goal_for_the_phase_does_not_speak_of_the_gain(tmp_path):
    path = changed(tmp_path, ("switching:", "goals: {min_phase_margin: 20 deg}\nswitching:"))
    (text,) = about(warnings(path), "withdrawal")
    assert "phase margin" not in text
    assert "gain margin" in text


def test_an_impedance_ten_times_off_and_an_upper_bound(tmp_path):
    """3 N m over 8 deg/s are 21.5 N m s/rad, and Bt is at most 2."""
    replacements = (("max: 20 N*m*s/rad", "max: 2 N*m*s/rad"), ("0.3 N*m", "3 N*m"))
    found = warnings(changed(tmp_path, *replacements))
    (text,) = about(found, "insertion")
    assert "factor off the desired impedance 10." in text
    assert "insertion: Bt is on its upper bound 2 N*m*s/rad" in found


@pytest.mark.parametrize("goal", [None, "max_force_error: 0.6"])
def test_a_steady_force_error_of_half_the_command(tmp_path, goal):
    """Thesis 6.3.3.1: Kp = 0.02 leaves 0.537 of the command at the nominal stiffness."""
    given = "    goals: {max_force_error: 0.55}\n"
    replaced = (given, f"    goals: {{{goal}}}\n" if goal else "")
    found = warnings(changed(tmp_path, replaced, source=FORCE_LIMIT))
    found = [text for text in found if text.startswith("force: ")]
    assert len(found) == (goal is None)
    if goal is None:
        assert "steady force error over command 0.5465 (usual: at most 0.5)" in found[0]


def test_given_gains_are_on_no_bound(tmp_path):
    path = changed(tmp_path, ("Mt: {min: 0.01 kg*m^2, max: 1 kg*m^2}", "Mt: 0.01 kg*m^2"))
    assert not any(" is on its " in text for text in warnings(path))


def test_the_worst_fact_leads(tmp_path):
    """2.0 limits of the torque, 1.55 of the force error, 1.22 of the impedance; bounds are met."""
    path = spec_in(tmp_path, spec_text("useless"), "holder")
    said = [
        "simulated, insertion-and-withdrawal: a torque of 0.9968 N*m",
        "limit: steady force error over command 0.774",
        "insert: factor off the desired impedance 2",
        "withdraw: factor off the desired impedance 2",
        "withdraw: the same law, gains and contacts as insert",
        "insert: Bt is on its lower bound 7 N*m*s/rad",
        "withdraw: Bt is on its lower bound 7 N*m*s/rad",
    ]
    found = warnings(path)
    assert [text[: len(start)] for text, start in zip(found, said, strict=True)] == said


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
