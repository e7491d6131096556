"""Creep in free motion: what it is beside a simulation, and what goals for it make of a design."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.step_law import StepFrame
from nrs_design.design.measures import CREEP, CREEP_ANGLE, GoalStanding
from nrs_design.errors import DesignError
from nrs_design.loop.program import INPUTS
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.loop.frames import frame_of
from tests.support import SOFT_TISSUE, replaced, spec_in

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
SENSOR = """
sensor:
  bias: 0.0273 N*m
"""
BT = "Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad}"
# 0.797 kg at 0.2 m, where the direction of gravity is off by 1 deg.
ERROR = 0.0273


def designed(path, more="", *changes, sensor=SENSOR):
    text = replaced(TEXT, *changes)
    found = run_design(read_spec(spec_in(path, f"{text}{sensor}{more}\n", "sensed")))
    assert found is not None
    return found


def achieved(item):
    return {found.measure: found for found in item.achieved}


def test_the_thesis_robot_creeps_at_a_fifth_of_its_command(tmp_path):
    withdrawal = run_analysis(designed(tmp_path)).impedance[1]
    assert withdrawal.Bt == pytest.approx(1.04, rel=1e-6)
    found = achieved(withdrawal)[CREEP]
    assert np.degrees(found.value) == pytest.approx(1.504, abs=1e-3)
    assert found.value / np.radians(8) == pytest.approx(0.188, abs=1e-3)
    assert found.where == "free motion"
    assert achieved(withdrawal)[CREEP_ANGLE].value == np.inf


def test_a_goal_raises_the_damping(tmp_path):
    plain = run_analysis(designed(tmp_path)).impedance[1]
    wanted = run_analysis(designed(tmp_path, "goals: {max_creep: 1 deg/s}")).impedance[1]
    assert not achieved(plain)[CREEP].goal
    assert achieved(wanted)[CREEP].standing is GoalStanding.MET
    assert wanted.Bt >= ERROR / np.radians(1) > plain.Bt


def test_a_spring_ends_it_at_an_angle(tmp_path):
    sprung = (BT, BT + "\n    Kt: 0.25 N*m/rad")
    with pytest.raises(DesignError, match=r"the best is 6\.257 deg"):
        designed(tmp_path, "goals: {max_creep_angle: 5 deg}", sprung)
    found = run_analysis(designed(tmp_path, "goals: {max_creep_angle: 7 deg}", sprung))
    creep = achieved(found.impedance[0])
    assert creep[CREEP].value == 0
    assert creep[CREEP_ANGLE].value == pytest.approx(ERROR / 0.25, rel=1e-12)
    assert creep[CREEP_ANGLE].standing is GoalStanding.MET


FILTER = "\n  filter: {order: 2, cutoff: 60 Hz}\n"


@pytest.mark.parametrize("spring", [None, "2 N*m/rad"])
def test_simulated(tmp_path, spring):
    """The sampled law in the air under the largest error gets there, but for what it rounds."""
    changes = [] if spring is None else [(BT, f"{BT}\n    Kt: {spring}")]
    found = designed(
        tmp_path, "sampling: {period: 2 ms, delay: 1}", *changes, sensor=SENSOR + FILTER
    )
    item = run_analysis(found).impedance[1]
    period, law = Fraction(1, 500), found.design.controllers[1].law
    low_pass = found.design.sensor.filter.discretize(period)
    motion, held = found.design.motion, law.discretize(period, "exact")
    step = StepFrame(motion.Kp, motion.difference_gain(period), low_pass)
    frame = frame_of(period, step, (held,), 1, Fraction("0.0351"))
    rows = frame.rows(held, 1, {"Km": Fraction("4.8417e-4")})
    n = len(frame.states)
    assert n == 8
    M = np.array(rows[:n], dtype=float)
    force_error = n + INPUTS.index("force error")
    step = np.eye(n + 1)
    step[:n, :n], step[:n, n] = M[:, :n], M[:, force_error] * float(found.design.sensor.lasting)
    before = np.linalg.matrix_power(step, 20_000)[:, n]
    x = step @ before
    if spring is None:
        velocity = abs(x[n - 1] - before[n - 1]) / 0.002
        assert velocity == pytest.approx(achieved(item)[CREEP].value, rel=1e-6)
    else:
        assert abs(x[n - 1]) == pytest.approx(achieved(item)[CREEP_ANGLE].value, rel=1e-6)


def test_without_a_sensor_nothing_is_said(tmp_path):
    item = run_analysis(designed(tmp_path, sensor="")).impedance[0]
    assert CREEP not in achieved(item)


def test_a_goal_out_of_reach_is_named(tmp_path):
    with pytest.raises(
        DesignError, match=r"max_creep, .* the best is 0\.07821 deg/s \(free motion\)"
    ):
        designed(tmp_path, "goals: {max_creep: 0.01 deg/s}")
