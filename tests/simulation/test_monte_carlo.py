"""Runs are drawn from ranges, and the share above a limit is what a dense grid says."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nrs_design.errors import DataError
from nrs_design.pipeline import run_design
from nrs_design.pipeline.monte_carlo import MonteCarlo, run_monte_carlo
from nrs_design.pipeline.scenarios import Runs
from nrs_design.simulation.monte_carlo import Outcome, Share, draw, held_against, shares
from nrs_design.simulation.outcomes_file import appending, read_outcomes
from nrs_design.spec import parse_spec
from nrs_design.spec.load import LoadedSpec
from tests.simulation.interactions import text_of

WIDE = {
    "soft": "{model: elastic, stiffness: {nominal: 40 N*m/rad, range: [20 N*m/rad, 60 N*m/rad]}}"
}
ONE = {"insertion": "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad}"}
# Pressed until nothing moves any more: the depth is F/k, with F = Bt v whatever k is (thesis 6.2).
PRESSED = (
    "command: {constant: 8 deg/s}, duration: 0.3 s, surfaces: [{environment: soft, at: 0 deg}], "
    "limits: {deflection: 0.4 deg}"
)


def study(runs, seed=0, scenario=PRESSED, more=""):
    text = text_of(ONE, WIDE, scenario=scenario, more=more)
    designed = run_design(LoadedSpec(Path("small"), "", text, parse_spec(text)))
    return MonteCarlo(designed, Runs(), runs, seed)


def drawn_from(designed, scenarios, seed, index):
    return draw(designed.spec, designed.plant, designed.design, scenarios, seed, index)


@pytest.mark.slow
def test_the_share_is_that_of_a_dense_grid():
    """The peak falls with the stiffness, so the share above is where it crosses the limit."""
    asked = study(60)
    found = list(run_monte_carlo(asked))
    stiffness = np.array([one.parameters["soft k"] for one in found])
    assert 20 < stiffness.min() < 23
    assert 57 < stiffness.max() < 60
    order = np.argsort(stiffness)
    peaks = np.array([one.peaks["deflection"] for one in found])[order]
    assert (np.diff(peaks) < 0).all()
    # Between the softest run below the limit and the stiffest above it lies the crossing.
    limit = asked.limits["run"]["deflection"]
    above = peaks > limit
    crossing = np.interp(-limit, -peaks, stiffness[order])
    probability = (crossing - 20) / 40
    share = shares(found, asked.limits)["deflection"]
    assert (share.above, share.runs) == (above.sum(), 60)
    assert 0.1 < probability < 0.9
    assert share.low < probability < share.high


def test_the_interval_is_exact():
    """Clopper and Pearson 1934: at 95 %, 0 of n gives 1 - 0.025^(1/n), 5 of 10 0.187 to 0.813."""
    none, all_, half = Share.of(0, 20), Share.of(20, 20), Share.of(5, 10)
    assert (none.low, none.high) == (0, pytest.approx(1 - 0.025 ** (1 / 20)))
    assert (all_.low, all_.high) == (pytest.approx(0.025 ** (1 / 20)), 1)
    assert (half.low, half.high) == (
        pytest.approx(0.1871, abs=1e-4),
        pytest.approx(0.8129, abs=1e-4),
    )


def test_a_run_depends_on_seed_and_index_alone():
    asked = study(4)
    scenarios = asked.scenarios

    def drawn(seed, index):
        return drawn_from(asked.designed, scenarios, seed, index)

    assert drawn(1, 2).parameters == drawn(1, 2).parameters
    assert drawn(1, 2).parameters != drawn(1, 3).parameters
    assert drawn(2, 2).parameters != drawn(1, 2).parameters
    assert [one.index for one in run_monte_carlo(asked, 2)] == [2, 3]
    assert list(run_monte_carlo(asked))[2:] == list(run_monte_carlo(asked, 2))


def test_gains_are_drawn_from_their_ranges():
    """In one stiffness, the force of a run grows with its Bt (thesis 6.2: at rest, F = Bt v)."""
    ranged = "{nominal: 2.15 N*m*s/rad, range: [1.72 N*m*s/rad, 2.58 N*m*s/rad]}"
    law = f"{{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: {ranged}}}"
    tissue = {"soft": "{model: elastic, stiffness: 40 N*m/rad}"}
    text = text_of({"insertion": law}, tissue, scenario=PRESSED)
    designed = run_design(LoadedSpec(Path("small"), "", text, parse_spec(text)))
    found = list(run_monte_carlo(MonteCarlo(designed, Runs(), 30, 0)))
    gains = [one.parameters["insertion Bt"] for one in found]
    assert 1.72 < min(gains) < 1.9
    assert 2.4 < max(gains) < 2.58
    assert [float(np.float32(gain)) for gain in gains] == gains
    peaks = np.array([one.peaks["torque"] for one in found])[np.argsort(gains)]
    assert (np.diff(peaks) > 0).all()
    assert (peaks > np.deg2rad(8) * np.sort(gains) * 0.99).all()


def test_the_motor_is_drawn_from_its_ranges():
    asked = study(1)
    text = text_of(ONE, WIDE, scenario=PRESSED).replace(
        "gain: 4.8417e-4 rad/s/rpm",
        "gain: {nominal: 4.8417e-4 rad/s/rpm, range: [4.7e-4 rad/s/rpm, 5e-4 rad/s/rpm]}",
    )
    designed = run_design(LoadedSpec(Path("small"), "", text, parse_spec(text)))
    scenarios = replace(asked, designed=designed).scenarios
    drawn = [drawn_from(designed, scenarios, 0, i) for i in range(20)]
    gains = [float(one.plant.actuator.gain) for one in drawn]
    assert 4.7e-4 < min(gains) < 4.8e-4 < 4.9e-4 < max(gains) < 5e-4
    assert [one.parameters["motor gain"] for one in drawn] == gains
    assert {one.parameters["motor time constant"] for one in drawn} == {0.0351}
    assert "motor gain" not in next(run_monte_carlo(asked)).parameters


def test_what_a_drawn_run_does_beyond_a_proof_is_kept():
    """Soft tissue lets the angle come further than at its nominal stiffness."""
    more = "sampling: {period: 2 ms, delay: 0}\ndisturbances: {largest_angle: 0.5 deg}\n"
    found = list(run_monte_carlo(study(8, more=more)))
    beyond = {bool(one.uncovered): [] for one in found}
    for one in found:
        beyond[bool(one.uncovered)].append(one.parameters["soft k"])
    assert max(beyond[True]) < min(beyond[False])
    for one in found:
        assert not one.uncovered or "the angle is larger" in one.uncovered[0]
    # As written, the scenario may keep what the proof takes for granted.
    level, reasons = held_against((0.5, ("some reason",)), found)
    assert level == 0.5
    assert reasons[:2] == ("some reason", "the angle is larger than the proof takes it for")
    kept = [one for one in found if not one.uncovered]
    assert held_against((0.5, ()), kept) == (0.5, ())
    assert not any(one.uncovered for one in run_monte_carlo(study(3)))


@pytest.mark.slow
def test_processes_change_nothing():
    asked = study(10)
    assert list(run_monte_carlo(asked, jobs=2)) == list(run_monte_carlo(asked, jobs=1))


def test_what_was_stopped_counts_as_above():
    calm = {"torque": 0.1, "deflection": 0.0, "velocity": 0.0}
    limits = {"run": {"torque": 0.3}}
    ended = Outcome(0, "run", 0, calm, None, {}, [])
    stopped = Outcome(1, "run", 0, calm, "the budget is used up", {}, [])
    assert shares([ended, stopped], limits)["torque"].above == 1
    assert shares([ended], limits).keys() == {"torque"}


HEAD = {"spec": "small", "spec_sha256": "0" * 64, "runs": 5, "seed": 0}


def outcome(index):
    peaks = dict.fromkeys(("torque", "deflection", "velocity"), 0.1 / 3)
    return Outcome(index, "run", 7, peaks, None, {"soft k": 41.5}, [])


def test_a_place_that_is_no_file_is_named(tmp_path):
    with pytest.raises(DataError, match=r"cannot be read \(it is not a regular file\)") as caught:
        read_outcomes(tmp_path, HEAD)
    assert caught.value.path == tmp_path


def test_a_file_keeps_runs_and_drops_a_torn_line(tmp_path):
    path = tmp_path / "folder" / "runs.jsonl"
    assert read_outcomes(path, HEAD) == []
    with appending(path, HEAD) as file:
        for index in range(3):
            file.add(outcome(index))
    whole = path.read_bytes()
    path.write_bytes(whole[:-9])
    assert read_outcomes(path, HEAD) == [outcome(0), outcome(1)]
    with appending(path, HEAD) as file:
        file.add(outcome(2))
    assert path.read_bytes() == whole
    path.write_bytes(whole[:20])
    with pytest.raises(DataError):
        read_outcomes(path, HEAD)


def test_a_file_is_not_read_beyond_the_runs_of_its_study(tmp_path):
    """However long a stranger has made it: what it takes is what the study takes."""
    path = tmp_path / "runs.jsonl"
    with appending(path, HEAD) as file:
        for index in range(HEAD["runs"] + 1):
            file.add(outcome(index))
    with pytest.raises(DataError, match="in order"):
        read_outcomes(path, HEAD)
    with path.open("ab") as file:
        file.write(b"[" * (2**20 + 2) + b"\n")
    with pytest.raises(DataError, match="in order"):
        read_outcomes(path, HEAD)
    path.write_bytes(path.read_bytes().split(b"\n")[0] + b"\n" + b"[" * (2**20 + 2) + b"\n")
    with pytest.raises(DataError, match="a line is longer"):
        read_outcomes(path, HEAD)


@pytest.mark.parametrize(
    ("content", "head", "message"),
    [
        (b"my thesis\n", HEAD, "keeps no runs"),
        (None, HEAD | {"spec_sha256": "1" * 64}, "other content of the spec"),
        (None, HEAD | {"seed": 1}, "other seed"),
        (None, HEAD | {"runs": 6}, "other number of runs"),
        (b'{"schema": "nrs-design/monte-carlo/1"}\n{"index": 0}\n', HEAD, "keeps no runs"),
    ],
)
def test_a_file_of_something_else_is_refused_and_kept(tmp_path, content, head, message):
    path = tmp_path / "runs.jsonl"
    if content is None:
        with appending(path, HEAD) as file:
            file.add(outcome(0))
    else:
        path.write_bytes(content)
    before = path.read_bytes()
    with pytest.raises(DataError, match=message):
        read_outcomes(path, head)
    assert path.read_bytes() == before
