"""What a controller achieves at worst, and in which corner."""

import math
from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from nrs_design.cli import exit_codes
from nrs_design.controllers.laws import ProportionalForce
from nrs_design.design import measures
from nrs_design.design.force_loop import Approach
from nrs_design.design.goals import ForceRequirement, Requirement, corners_of
from nrs_design.design.impedance_optimum import ImpedanceLoop
from nrs_design.design.measures import (
    DELAY_MARGIN,
    FORCE_ERROR,
    FORCE_MEASURES,
    GAIN_MARGIN,
    IMPEDANCE_ERROR,
    IMPEDANCE_MEASURES,
    PHASE_MARGIN,
    SENSITIVITY_PEAK,
    GoalStanding,
)
from nrs_design.design.transfer import TransferFunction
from nrs_design.gating.examine import Examiner
from nrs_design.models.contact import Elastic, KelvinVoigt
from nrs_design.models.contact.environment import Environment
from nrs_design.models.interval import Interval
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_interaction
from nrs_design.spec import read_spec
from tests.design.classical import displayed_impedance_at, loop_margins
from tests.design.motion_loops import EXACT, PLACE, axis_with
from tests.support import run, spec_in
from tests.tables import rows, spec_text


def interval(nominal, low, high):
    return Interval(*(Fraction(value) for value in (nominal, low, high)))


ZERO = Interval.point(Fraction(0))
SOFT = Environment("soft", KelvinVoigt, (interval("43", "41.5", "44.25"), ZERO))
HAND = Environment("hand", KelvinVoigt, (interval("55", "50", "60"), interval("0.2", "0.1", "0.3")))


def impedance(environments, goals=(), desired=2.15):
    corners = corners_of(environments, "soft", (PLACE,))
    return Requirement(axis_with(EXACT), corners, goals, desired, 4 * math.pi)


def worst(requirement, Mt=0.01, Bt=2.15):
    found = requirement.achieved(IMPEDANCE_MEASURES, Mt, Bt)
    return {item.measure: item for item in found}


def test_margins_are_taken_at_every_corner_of_every_contact():
    found = worst(impedance((SOFT, HAND)))
    points = [(float(k), 0.0) for k in ("43", "41.5", "44.25")]
    points += [(k, b) for k, b in product((50.0, 60.0), (0.1, 0.3))]
    peaks = {
        point: loop_margins(ImpedanceLoop(EXACT, KelvinVoigt(*point)), 0.01, 2.15).sensitivity_peak
        for point in points
    }
    at = max(peaks, key=peaks.__getitem__)
    assert found[SENSITIVITY_PEAK].value == pytest.approx(peaks[at], rel=1e-6)
    assert found[SENSITIVITY_PEAK].where == f"hand, k = {at[0]:g} N*m/rad, b = {at[1]:g} N*m*s/rad"


def test_the_impedance_error_is_taken_in_the_environment_of_the_design_only():
    found = worst(impedance((SOFT, HAND)))[IMPEDANCE_ERROR]
    omega = np.linspace(0, 4 * math.pi, 20_001)
    errors = []
    for k in (43.0, 41.5, 44.25):
        Z = np.abs(displayed_impedance_at(ImpedanceLoop(EXACT, Elastic(k)), 0.01, 2.15, omega))
        errors.append(max(Z.max() / 2.15, 2.15 / Z.min()))
    assert found.value == pytest.approx(max(errors), rel=1e-6)
    assert found.where.startswith("soft, ")
    assert worst(impedance((SOFT,)))[IMPEDANCE_ERROR] == found


def test_an_unstable_corner_is_the_worst():
    """Mt = 0.01, Bt = 1.04: stable up to 75.9 N m/rad."""
    stiff = Environment("stiff", KelvinVoigt, (interval("60", "50", "90"), ZERO))
    found = worst(impedance((SOFT, stiff), ((SENSITIVITY_PEAK, 100.0),)), Bt=1.04)
    assert found[SENSITIVITY_PEAK].value == math.inf
    assert found[SENSITIVITY_PEAK].where == "stiff, k = 90 N*m/rad"
    assert found[SENSITIVITY_PEAK].standing is GoalStanding.MISSED
    assert found[DELAY_MARGIN].value == 0


def force(motion, Kp, goals=()):
    corners = corners_of((SOFT,), "soft", (PLACE,))
    return ForceRequirement(
        axis_with(motion), corners, goals, ProportionalForce(Fraction(Kp)), motion, Approach()
    )


def test_the_force_error_is_worst_in_the_softest_contact():
    """Thesis 6.3.3.1: Kp = 0.02 at 43.0356 N m/rad; G(0) = 1."""
    requirement = force(EXACT, "0.02", ((FORCE_ERROR, 0.6),))
    found = {item.measure: item for item in requirement.achieved(FORCE_MEASURES)}
    assert found[FORCE_ERROR].value == pytest.approx(1 / (1 + 0.02 * 41.5))
    assert found[FORCE_ERROR].where == "soft, k = 41.5 N*m/rad"
    assert found[FORCE_ERROR].standing is GoalStanding.MET
    assert found[SENSITIVITY_PEAK].goal is None


def test_force_margins_are_those_of_the_force_loop():
    """Peak of |1/(1 + Kp k G)| on a frequency grid, at the stiffest contact."""
    motion = TransferFunction((1.0,), (4e-4, 0.02, 1.0))
    requirement = force(motion, "0.2")
    found = {item.measure: item for item in requirement.achieved(FORCE_MEASURES)}
    s = 1j * np.geomspace(0.1, 1e4, 100_001)
    G = np.polyval(motion.numerator, s) / np.polyval(motion.denominator, s)
    peaks = [np.abs(1 / (1 + 0.2 * k * G)).max() for k in (43, 41.5, 44.25)]
    assert found[SENSITIVITY_PEAK].value == pytest.approx(max(peaks), rel=1e-5)
    assert found[SENSITIVITY_PEAK].where == "soft, k = 44.25 N*m/rad"


def test_a_spring_is_measured_too():
    corners = corners_of((SOFT,), "soft", (PLACE,), Fraction("0.8"))
    assert [corner.home for corner in corners] == [True] * 3
    requirement = Requirement(axis_with(EXACT), corners, (), 2.15, 4 * math.pi)
    found = worst(requirement)
    loops = [ImpedanceLoop(EXACT, Elastic(k), 0.8) for k in (43, 41.5, 44.25)]
    peaks = [loop_margins(loop, 0.01, 2.15).sensitivity_peak for loop in loops]
    assert found[SENSITIVITY_PEAK].value == pytest.approx(max(peaks), rel=1e-9)
    # Towards rest it shows a spring, which is no damping at all.
    assert found[IMPEDANCE_ERROR].value == math.inf


@pytest.mark.parametrize(
    ("measure", "value", "text"), rows(__file__, "test_text_is_rounded_to_the_unfavorable_side")
)
def test_text_is_rounded_to_the_unfavorable_side(measure, value, text):
    assert getattr(measures, measure).text(value) == text


def test_goals_are_written_in_the_units_of_the_spec():
    assert SENSITIVITY_PEAK.goal_text(2.0) == "at most 2"
    assert PHASE_MARGIN.goal_text(math.radians(30)) == "at least 30 deg"
    assert DELAY_MARGIN.goal_text(0.005) == "at least 5 ms"


@pytest.mark.parametrize(
    ("measure", "met", "goal", "missed"),
    [(SENSITIVITY_PEAK, 1.9, 2.0, 2.1), (GAIN_MARGIN, 2.1, 2.0, 1.9)],
)
def test_violation_is_positive_only_where_the_goal_is_missed(measure, met, goal, missed):
    assert measure.violation(met, goal) < 0
    assert measure.violation(goal, goal) == 0
    assert measure.violation(missed, goal) > 0


# A motor with a load, and contact whose margins are worst inside its range: Ms 3.42, a disk margin
# of 0.334 and a delay margin of 42.6 ms at 81.3 N m/rad, a phase margin of 27.8 deg at 60 N m/rad
# (python-control).
SPEC = spec_text("between-corners")
# Sampled, with a range: no proof covers what is between.
SAMPLED = (
    SPEC.replace(", load_inertia: 0.3039 kg*m^2", "")
    .replace("contact: kept", "contact: kept\nsampling: {period: 2 ms, delay: 1}")
    .replace("Bt: 2.128", "Bt: 40")
)


def written(folder, text, goals):
    return spec_in(folder, text.replace("{GOALS}", goals), "between")


@pytest.mark.parametrize(
    ("goals", "standing"),
    rows(__file__, "test_a_goal_is_met_over_the_whole_range_or_missed_between"),
)
def test_a_goal_is_met_over_the_whole_range_or_missed_between(tmp_path, goals, standing):
    loaded = read_spec(written(tmp_path, SPEC, goals))
    (item,) = run_analysis(run_interaction(loaded, "")).impedance
    (found,) = (one for one in item.judged if one.goal is not None)
    assert found.standing == standing


@pytest.mark.parametrize(
    ("text", "goals", "code"),
    [
        (SPEC, "{max_sensitivity_peak: 2.4}", 1),
        (SPEC, "{max_sensitivity_peak: 3.5}", 0),
        (SAMPLED, "{max_sensitivity_peak: 9}", 3),
        # One that is missed decides beside one that is open.
        (SAMPLED, "{max_sensitivity_peak: 9, min_gain_margin: 1e6}", 1),
        (
            SAMPLED.replace(", range: [25.71 N*m/rad, 257.1 N*m/rad], varies: false", ""),
            "{max_sensitivity_peak: 9}",
            0,
        ),
    ],
)
def test_optimize_and_gate_end_alike(tmp_path, text, goals, code):
    path = written(tmp_path, text, goals)
    run("optimize", path, cwd=tmp_path, code=code)
    loaded = read_spec(path)
    found = Examiner(loaded).goals(run_analysis(run_interaction(loaded, "")))
    assert exit_codes.SEVERITY_CODES[max(item.severity for item in found)] == code
