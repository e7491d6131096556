from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.errors import DesignError
from nrs_design.robot.simulation.simulate import simulate
from nrs_design.robot.simulation.track import CONTROLLERS, build_tracks
from tests.support import ROOT

# Fast, after a short hold, so that little simulated time shows everything.
PERIOD, HOLD = 2.0, 0.5


@pytest.fixture(scope="module")
def tracks(spec, tilted):
    """Each controller moves d, phi and psi in turn."""
    return [
        replace(one, experiment=replace(one.experiment, hold_time=HOLD))
        for name in CONTROLLERS
        for one in build_tracks(spec, tilted, name, PERIOD)
    ]


@pytest.fixture(scope="module")
def records(tracks):
    return simulate(tracks)


@pytest.mark.slow
def test_one_record_for_each_experiment(records):
    found = [(record.controller, record.experiment.coordinate) for record in records]
    assert found == [(name, moved) for name in CONTROLLERS for moved in ("d", "phi", "psi")]
    for record in records:
        assert record.time[[0, -1]] == pytest.approx([0, 2.5])
        assert record.reference.shape == record.measured.shape == record.command.shape == (1251, 3)


@pytest.mark.slow
def test_the_pose_is_held_before_the_sine(records):
    for record in records:
        if record.controller == "independent-joint":
            start = record.actual[record.time <= HOLD]
            assert np.ptp(start, axis=0) == pytest.approx(np.zeros(3), abs=1e-12)


@pytest.mark.slow
def test_measured_is_actual_to_the_count(records):
    # Half a count is 3.8e-4 rad at the encoder, 7.7e-5 rad at the joint.
    for record in records:
        assert np.abs(record.measured - record.actual)[:, :2].max() < 2e-4
        assert np.abs(record.measured - record.actual)[:, 2].max() < 5e-5


@pytest.mark.slow
def test_more_steps_change_nothing(tracks, records, monkeypatch):
    # Two steps for each tick, and mass and bias anew at every one of them.
    monkeypatch.setattr("nrs_design.robot.simulation.simulate.STEPS_PER_TICK", 2)
    monkeypatch.setattr("nrs_design.robot.simulation.simulate.HELD_PHASE", 0.0)
    again = simulate([tracks[2], tracks[5]])
    for fine, coarse in zip(again, (records[2], records[5]), strict=True):
        moved = fine.rmse[1]
        assert coarse.rmse == pytest.approx(fine.rmse, rel=2e-3, abs=2e-3 * moved)


@pytest.mark.slow
def test_independent_joints_beat_computed_torque(records):
    # The ranking of thesis 4.3.4, on the same motions.
    for torque, joint, place in zip(records[:3], records[3:6], (2, 0, 1), strict=True):
        assert joint.rmse[place] < torque.rmse[place] / 5


@pytest.mark.slow
def test_tracks_that_differ_in_one_part_are_told_apart(tracks, records):
    # The same law and mechanism, another encoder and another drive.
    track = tracks[4]
    ideal = replace(track, encoder=replace(track.encoder, counts=None))
    smooth = replace(track, drive=replace(track.drive, friction=0.0))
    rounded, exact, without_friction = simulate([track, ideal, smooth])
    assert np.array_equal(rounded.measured, records[4].measured)
    assert exact.measured == pytest.approx(exact.actual, abs=1e-12)
    assert np.abs(rounded.measured - rounded.actual).max() > 1e-5
    assert without_friction.rmse[0] < rounded.rmse[0]


def test_an_unstable_loop_is_said_to_be_one(tracks):
    track = tracks[4]
    wild = replace(
        track,
        law=replace(track.law, motion=ProportionalDerivative(Fraction(10**7), Fraction(10**6))),
    )
    with pytest.raises(DesignError, match=r"independent-joint.*leaves the reach of the robot"):
        simulate([wild], report=(told := []).append)
    assert told == ["1 experiment, 2.5 s"]


def test_too_many_ticks(tracks):
    fine = replace(tracks[3], law=replace(tracks[3].law, period=1e-9))
    with pytest.raises(DesignError, match="more than 2000000 ticks"):
        simulate([fine])


@pytest.mark.slow
def test_the_page_states_what_is_simulated(spec, tilted):
    found = simulate([one for name in CONTROLLERS for one in build_tracks(spec, tilted, name)])
    page = (ROOT / "docs/robot/motion-control.md").read_text()
    first = page.index("| computed-torque |")
    rows = [line.strip("| ").split(" | ") for line in page[first:].splitlines()[:3]]
    moves, measured = ("d", "phi", "psi"), ("phi", "psi", "d")
    stated = {row[0]: dict(zip(moves, map(float, row[1:4]), strict=True)) for row in rows}
    for record in found:
        moved = record.experiment.coordinate
        error = record.summary()["rmse"][measured.index(moved)]
        expected = stated[record.controller].pop(moved)
        assert error == pytest.approx(expected, rel=1e-2, abs=2e-4)
    assert not any(stated.values())
