"""The table of hazards leaves out no assumption, no goal and no limit."""

from pathlib import Path

import pytest

from nrs_design.assurance.hazards import ended_in, hazards, trace_hazards
from nrs_design.exporters.formats.monitor import KINDS
from nrs_design.gating.obligations import Obligation, Status
from nrs_design.gating.rules import CERTIFIED_GOAL, GOAL, RULES, SWITCHING_STABLE
from nrs_design.simulation.peak_metrics import PEAKS
from nrs_design.spec import load_spec
from nrs_design.spec.goals import GoalsSpec
from nrs_design.spec.motion import LimitsSpec
from nrs_design.switched.assumption import kinds
from tests.support import SOFT_TISSUE

LIMITS = load_spec(SOFT_TISSUE).limits
GAINS = {"motion": {"Kp": "1"}, "insertion": {"Mt": "1", "Bt": "2"}, "position": {}}


def test_every_assumption_is_in_a_hazard():
    assert {kind for h in hazards() for kind in h.assumptions} >= kinds().keys()


def test_every_goal_and_every_limited_quantity_is_in_a_hazard():
    assert {goal for h in hazards() for goal in h.goals} == GoalsSpec.model_fields.keys() | PEAKS


def test_every_limit_of_a_spec_is_in_a_hazard():
    assert {name for h in hazards() for name in h.limits} == LimitsSpec.model_fields.keys()


def test_every_alarm_of_the_monitor_tells_of_a_hazard():
    assert {name for h in hazards() for name in h.watched} >= KINDS.keys() - {"NONE"}


def test_rules_exist():
    assert {rule for h in hazards() for rule in h.rules} <= RULES.keys()


def obligation(rule, subject, status):
    return Obligation(rule, Path("x"), subject, status, "said")


def traced(*obligations, limits=LIMITS, gains=GAINS, monitor=""):
    found = trace_hazards(limits, gains, (), obligations, monitor)
    return {item.hazard.id: item for item in found}


def test_a_missed_goal_of_a_controller_leads_to_its_gains():
    missed = obligation(GOAL, "insertion: min_phase_margin", Status.MISSED)
    found = traced(missed, obligation(SWITCHING_STABLE, "system", Status.PROVED))
    assert found["late-loop"].missed == (missed,)
    assert found["late-loop"].gains == ("insertion: Mt, Bt",)
    assert found["unstable-switching"].missed == ()
    assert found["unstable-switching"].gains == ("motion: Kp", "insertion: Mt, Bt")
    assert found["large-force"].limits == ("torque: 0.3 N*m",)


def test_a_goal_that_is_not_proved_is_missed():
    item = obligation(CERTIFIED_GOAL, "system: peak_torque", Status.INCONCLUSIVE)
    assert traced(item)["large-force"].missed == (item,)


def test_only_what_the_monitor_has_is_told_by_it():
    monitor = "#define X_LEFT_FORCE 7\n#define X_LEFT_STAY 4\n"
    assert traced(monitor=monitor)["large-force"].watched == ("FORCE",)
    assert traced()["large-force"].watched == ()


def test_given_matrices_have_no_limits():
    assert traced(limits=None, gains={}) == {}


@pytest.mark.parametrize("hazard", hazards(), ids=lambda h: h.id)
def test_hazards_are_told_in_sentences(hazard):
    assert hazard.name[0].isupper()
    assert hazard.events.endswith(".")


def test_obligations_are_counted_by_how_they_ended():
    ends = (Status.PROVED, Status.MET, Status.MET, Status.MISSED)
    assert ended_in(obligation(GOAL, "x: y", end) for end in ends) == "1 proved, 2 met, 1 missed"
