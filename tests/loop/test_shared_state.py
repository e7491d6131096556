"""Impedance, position and force controllers in one state."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.laws import Admittance
from nrs_design.loop.assemble import assemble
from nrs_design.loop.modes import position_mode, velocity_mode
from nrs_design.models.actuator import Actuator
from nrs_design.models.contact import KelvinVoigt
from nrs_design.models.motion_loop import close_motion_loop, realize
from nrs_design.pipeline.runs import run_design
from tests.loop.support import assembled, loaded, polynomial
from tests.support import ROOT, replaced, words_of

F = Fraction
MIXED = ROOT / "docs" / "examples" / "mixed-controllers.nrs.yaml"
# Thesis 4.1 and 4.3.
GAIN, TAU, KD, KP = F("4.8417e-4"), F("0.0351"), F(2060), F("117359.43")
MOTION = realize(close_motion_loop(Actuator(GAIN, TAU), KP, KD))
positive = st.fractions("1/100", 100, max_denominator=100)


RESET = "decay: 20 1/s", "decay: 20 1/s, reset: true"


def mixed(*changes):
    return assembled(MIXED, *changes)


@given(k=positive, b=positive, Mt=positive, Bt=positive, massless=st.booleans())
def test_impedance_mode_has_the_poles_that_it_has_alone(k, b, Mt, Bt, massless):
    law, contact = Admittance(F(0) if massless else Mt, Bt), KelvinVoigt(k, b)
    shared = position_mode(MOTION, law, contact)
    assert polynomial(shared) == polynomial(velocity_mode(MOTION, law, contact))


def test_the_example_has_one_state_for_all():
    system = mixed()
    names = ["approach", "insertion/soft/k-min", "insertion/soft/k-max"]
    assert [mode.name for mode in system.modes][:3] == names
    assert system.states == ("xi1", "xi2", "vm [rad/s]", "reference [rad]")
    approach = system.modes[0].A.fractions()
    motion = run_design(loaded(MIXED)).design.motion
    own = realize(close_motion_loop(Actuator(GAIN, TAU), motion.Kp, motion.Kd)).A
    assert [row[:2] for row in approach[:2]] == [list(row) for row in own]
    assert approach[2:] == [[0, 0, -20, 0], [0, 0, 0, -20]]
    assert not system.switching.resets


def test_resets_lead_from_impedance_controllers_to_the_others():
    system = mixed(RESET)
    found = {(reset.source, reset.target) for reset in system.switching.resets}
    ends = [f"insertion/soft/k-{end}" for end in ("min", "max")]
    others = ["approach", "hold/soft/k-min", "hold/soft/k-max"]
    assert found == set(product(ends, others))
    kept = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]
    assert all(reset.map.fractions() == kept for reset in system.switching.resets)


def test_resets_are_between_all_contacts_that_rules_name():
    rules = "{transitions: [[insertion/soft, hold/soft], [hold/soft, insertion/soft]]}"
    system = mixed(RESET, ("switching: arbitrary", f"switching: {rules}"))
    assert {(r.source, r.target) for r in system.switching.resets} == {
        (reset.source, reset.target) for reset in mixed(RESET).switching.resets
    }
    assert ("insertion/soft/k-min", "approach") not in system.switching.transitions


def test_a_reset_leaves_what_shows_the_force_and_what_remembers_it():
    text = replaced(MIXED.read_text(), RESET)
    creeping = (
        "    model: kelvin-boltzmann\n    parallel_stiffness: 60 N*m/rad\n"
        "    series_stiffness: 80 N*m/rad\n    damping: 5 N*m*s/rad\n"
    )
    begin, end = text.index("    model: elastic"), text.index("\ncontrollers:")
    filtered = "sensor: {filter: {cutoff: 30 Hz}}\n"
    system = assembled(text[:begin] + creeping + text[end:], more=filtered)
    zeroed = {"vm [rad/s]", "reference [rad]"}
    assert {*system.states} - zeroed == {
        *("xi1", "xi2", "filtered 1 [N*m]", "soft: damper deflection [rad]")
    }
    for reset in system.switching.resets:
        for i, row in enumerate(reset.map.fractions()):
            kept = system.states[i] not in zeroed
            assert row == [F(i == j and kept) for j in range(len(system.states))]


def test_only_controllers_of_the_spec_are_named():
    found = run_design(loaded(MIXED))
    without = replace(found.design, controllers=found.design.controllers[:2])
    texts = " ".join(words_of(assemble(found.spec, found.plant, without)))
    assert "Impedance controllers integrate" in texts
    assert "While a position controller is active" in texts
    assert "force controller" not in texts


def test_decay_is_the_single_precision_number_that_the_robot_holds():
    system = mixed(("decay: 20 1/s", "decay: 0.1 1/s"))
    held = F(13421773, 2**27)
    assert abs(held - F("0.1")) < F(1, 10**8)
    assert system.modes[0].A.fractions()[2][2] == -held
