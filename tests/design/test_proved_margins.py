"""Margins over whole ranges: known answers, margins between corners, and what is not covered."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.sensor import LowPass
from nrs_design.design.goals import Achieved
from nrs_design.design.impedance_optimum import ImpedanceLoop
from nrs_design.design.loop_family import LoopFamily
from nrs_design.design.loops import Loops, hand_effort, transparency
from nrs_design.design.measures import (
    DELAY_MARGIN,
    DISK_MARGIN,
    GAIN_MARGIN,
    HAND_EFFORT,
    IMPEDANCE_ERROR,
    PHASE_MARGIN,
    SENSITIVITY_PEAK,
    TRANSPARENCY,
    GoalStanding,
)
from nrs_design.design.proved_margins import RangedLoop, add_proofs, ranged_loops
from nrs_design.models.contact import Elastic, Hand, KelvinBoltzmann, KelvinVoigt, Maxwell
from nrs_design.models.contact.environment import Environment
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from nrs_design.thesis import thesis
from tests.design.classical import displayed_impedance_at
from tests.design.motion_loops import interval
from tests.support import FORCE_LIMIT
from tests.tables import rows

SOFT = "41.504256", "44.246592"  # 720.56 N/m and 768.17 N/m at 0.24 m
FOUND = {
    SENSITIVITY_PEAK: Loops.sensitivity_peak,
    GAIN_MARGIN: Loops.gain_margin,
    PHASE_MARGIN: Loops.phase_margin,
    DELAY_MARGIN: Loops.delay_margin,
    DISK_MARGIN: Loops.disk_margin,
}


def contact(*stiffness, damping=("0", "0")):
    return Environment("soft", KelvinVoigt, (interval(*stiffness), interval(*damping)))


def loop(Mt, Bt, environment, axis=thesis.AXIS, **ranges):
    law = Admittance(Fraction(Mt), Fraction(Bt))
    boxes = {name: interval(*ends) for name, ends in ranges.items()}
    return RangedLoop(axis, law, environment, boxes, Fraction(Bt), 4 * Fraction(math.pi))


@pytest.mark.parametrize(
    ("Mt", "Bt", "stiffness", "peak"), rows(__file__, "test_known_peaks_over_stiffness")
)
def test_known_peaks_over_stiffness(Mt, Bt, stiffness, peak):
    """By Sturm chains elsewhere, to six digits: rounded up it is proved, rounded down it is not."""
    ranged, unit = loop(Mt, Bt, contact(*stiffness)), Fraction(1, 10**5)
    assert ranged.stable
    assert ranged.holds(SENSITIVITY_PEAK, Fraction(peak) + unit)
    assert not ranged.holds(SENSITIVITY_PEAK, Fraction(peak) - unit)


def grid_of(ranged, measure):
    """Return the worst margin on a dense grid of the stiffness, in floating point."""
    k = ranged.environment.parameters["k"]
    family = LoopFamily(ranged.axis, Elastic(Fraction(1)), Fraction(0), ranged.axis.places[0])
    stiffness = np.linspace(float(k.low), float(k.high), 301)
    gains = (np.full(301, float(ranged.law.gains[name])) for name in ("Mt", "Bt"))
    values = FOUND[measure](family.loops(*gains, stiffness))
    return float(values.max() if measure.upper else values.min())


@pytest.mark.parametrize("measure", FOUND)
@pytest.mark.parametrize(
    ("Mt", "Bt", "stiffness"), [("0.01", "1.04", SOFT), ("0.05", "3", ("25", "60"))]
)
def test_no_bound_is_beaten_on_a_dense_grid(measure, Mt, Bt, stiffness):
    ranged = loop(Mt, Bt, contact(*stiffness))
    value = grid_of(ranged, measure)
    better = 1 if measure.upper else -1
    assert ranged.holds(measure, Fraction(value * (1 + better * 2e-3)))
    assert not ranged.holds(measure, Fraction(value * (1 - better * 1e-4)))


@settings(max_examples=8)
@given(
    st.fractions(Fraction(1, 100), Fraction(1, 10), max_denominator=1000),
    st.fractions(Fraction(3, 2), 4, max_denominator=100),
    st.fractions(10, 30, max_denominator=10),
)
def test_what_is_proved_holds_at_any_stiffness(Mt, Bt, low):
    """Half a percent better than the worst on a dense grid is never proved."""
    ranged = loop(Mt, Bt, contact(low, 2 * low))
    if not ranged.stable:
        return
    for measure in (SENSITIVITY_PEAK, GAIN_MARGIN, DISK_MARGIN):
        value = grid_of(ranged, measure)
        beaten = Fraction(value * (0.995 if measure.upper else 1.005))
        assert not ranged.holds(measure, beaten)


def touching(stiffness):
    return ImpedanceLoop(thesis.EXACT_LOOP, Elastic(Fraction(stiffness)))


def test_the_displayed_impedance():
    ranged = loop("0.01", "2.15", contact(*SOFT))
    omega = np.linspace(1e-3, 4 * math.pi, 500)
    shown = np.concatenate(
        [
            np.abs(displayed_impedance_at(touching(k), 0.01, 2.15, omega))
            for k in np.linspace(*map(float, SOFT), 9)
        ]
    )
    error = max(shown.max() / 2.15, 2.15 / shown.min())
    assert ranged.holds(IMPEDANCE_ERROR, Fraction(error * 1.001))
    assert not ranged.holds(IMPEDANCE_ERROR, Fraction(error * 0.999))
    # With a spring it is the spring's towards rest.
    sprung = replace(ranged, law=Admittance(Fraction(1, 100), Fraction(2), Fraction(5)))
    assert not sprung.holds(IMPEDANCE_ERROR, Fraction(100))


def test_two_ranges_and_a_filter():
    """A margin over stiffness and damping is not better than at any of their corners."""
    axis = replace(thesis.AXIS, low_pass=LowPass(1, Fraction(50)))
    plain, filtered = (
        loop("0.01", "2.15", contact(*SOFT, damping=("0", "0.1")), each)
        for each in (thesis.AXIS, axis)
    )
    assert plain.stable
    assert filtered.stable
    assert plain.holds(SENSITIVITY_PEAK, Fraction("1.62"))
    assert not filtered.holds(SENSITIVITY_PEAK, Fraction("1.62"))
    assert not plain.holds(GAIN_MARGIN, Fraction("5.3"))


def test_what_is_not_stable_has_no_margins():
    ranged = loop("0.01", "1.04", contact("40", "80"))
    assert not ranged.stable
    found = (Achieved(SENSITIVITY_PEAK, 3.0, "soft"),)
    assert add_proofs(found, (ranged,), "soft", 2.15, 12.0) == found
    assert add_proofs(found, (), "soft", 2.15, 12.0) == found
    assert not ranged.holds(GAIN_MARGIN, Fraction(1, 2))


def test_angles_and_delays_beyond_a_half_turn_are_refused():
    ranged = loop("0.01", "2.15", contact(*SOFT))
    assert not ranged.holds(PHASE_MARGIN, Fraction(4))
    assert not ranged.holds(DELAY_MARGIN, Fraction(10))


def test_a_value_that_is_shown_is_the_one_that_is_proved():
    ranged = loop("0.01", "1.04", contact(*SOFT))
    peak, free, creep = add_proofs(
        (
            Achieved(SENSITIVITY_PEAK, 3.752975, "soft", goal=3.75299),
            Achieved(GAIN_MARGIN, math.inf, "soft"),
            Achieved(DISK_MARGIN, 0.9, "soft"),
        ),
        (ranged,),
        "soft",
        1.07,
        12.0,
    )
    # Shown, 3.753 would miss the goal, which is proved itself.
    assert peak.proved == Fraction(3.75299)
    assert peak.standing is GoalStanding.MET
    # What nothing limits, and what is wrong, is not proved.
    assert free.proved is None
    assert creep.proved is None


def test_goals_are_proved_and_what_has_none_only_for_who_wants_to_see_it(monkeypatch, tmp_path):
    """A gate asks for goals: to prove the other margins took longer than all else that it does."""
    said = "goals: {max_force_error: 0.55"
    text, file = FORCE_LIMIT.read_text(encoding="utf-8"), tmp_path / "a.nrs.yaml"
    assert said in text
    file.write_text(text.replace(said, f"{said}, min_gain_margin: 1.1"), encoding="utf-8")
    (item,) = run_analysis(run_design(read_spec(file))).measured
    asked, holds = [], RangedLoop.holds
    monkeypatch.setattr(RangedLoop, "holds", lambda *of: asked.append(of[1]) or holds(*of))
    assert [one.measure for one in item.judged_goals if one.proved] == [GAIN_MARGIN] == [*{*asked}]
    assert [one for one in item.judged if one.goal is not None] == [*item.judged_goals]
    assert {*asked} > {GAIN_MARGIN}


def test_what_is_covered():
    law, soft = Admittance(Fraction("0.01"), Fraction(2)), contact(*SOFT)
    assert len(ranged_loops(thesis.AXIS, law, [soft], {})) == 1
    many = {name: interval("1", "2") for name in ("Km", "tau")}
    standard = Environment("soft", KelvinBoltzmann, (interval("1", "2"),) * 3)
    assert ranged_loops(thesis.AXIS, law, [standard], many) == ()


def at_points(ranged, measure):
    """Return the worst margin on a grid of the contact's parameters, each loop cut exactly."""
    ends = ranged.environment.parameters
    sides = [[r.low + (r.high - r.low) * i / 12 for i in range(13)] for r in ends.values()]
    found = []
    for values in product(*sides):
        contact = ranged.environment.law(*values)
        cut = ranged.axis.find_loop(ranged.law, contact, ranged.axis.places[0])
        exact = [c - o for c, o in zip(cut.closed, cut.opened, strict=True)], cut.opened
        loops = Loops(*(np.array([p], dtype=np.float64) for p in exact))
        found.append(float(FOUND[measure](loops)[0]))
    return max(found) if measure.upper else min(found)


@pytest.mark.parametrize("measure", [SENSITIVITY_PEAK, GAIN_MARGIN, DISK_MARGIN])
@pytest.mark.parametrize(
    ("law", "ranges"),
    [
        (Maxwell, (("30", "60"), ("2", "8"))),
        (KelvinBoltzmann, (("10", "20"), ("20", "40"), ("5", "5"))),
        (Hand, (("25", "60"), ("0.2", "0.2"), ("0", "0.05"))),
    ],
)
def test_contacts_that_remember_or_have_a_mass(law, ranges, measure):
    """A bound holds of each point on a grid, and is at most 1 % worse than the worst of them."""
    environment = Environment("soft", law, tuple(interval(*ends) for ends in ranges))
    ranged = loop("0.05", "3", environment)
    value, better = at_points(ranged, measure), 1 if measure.upper else -1
    assert ranged.stable
    assert ranged.holds(measure, Fraction(value * (1 + better * 1e-2)))
    assert not ranged.holds(measure, Fraction(value * (1 - better * 1e-4)))


def test_what_a_hand_feels():
    """Against the responses in floating point, on a grid of stiffness and damping."""
    environment = contact("25", "60", damping=("0", "0.5"))
    ranged = loop("0.1", "4.6", environment)
    grid = product(np.linspace(25, 60, 8), np.linspace(0, 0.5, 6))
    found = []
    for k, b in grid:
        held = KelvinVoigt(Fraction(k), Fraction(b))
        one = LoopFamily(ranged.axis, held, Fraction(0), ranged.axis.places[0])
        loops = one.felt(np.array([0.1]), np.array([4.6]), k)
        band = float(ranged.bandwidth)
        found.append((transparency(loops, band)[0], hand_effort(loops, held, band)[0]))
    share, effort = min(s for s, _ in found), max(e for _, e in found)
    assert ranged.holds(TRANSPARENCY, Fraction(share * 0.999))
    assert not ranged.holds(TRANSPARENCY, Fraction(share * 1.001))
    assert ranged.holds(HAND_EFFORT, Fraction(effort * 1.001))
    assert not ranged.holds(HAND_EFFORT, Fraction(effort * 0.999))
