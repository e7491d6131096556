"""Whether a run stayed inside."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.errors import DesignError
from nrs_design.identification.errors import DataError
from nrs_design.identification.running.bounds import (
    bounds_of_spec,
    read_run_bounds,
)
from nrs_design.identification.running.judge import judge_run
from nrs_design.spec import parse_spec, read_spec
from tests.identification import runs
from tests.identification.runs import SAMPLED, SOFT, check, judged, log
from tests.support import COMMUTING, ROBOT, ROOT
from tests.tables import rows

LIMITED = replace(SOFT, saturates=3000.0)


def test_bounds_of_the_spec():
    assert (SOFT.torque, SOFT.transitions, SOFT.delay, SOFT.latency) == (0.3, None, None, "")
    arm = read_run_bounds(read_spec(ROOT / "docs/examples/torque-arm.nrs.yaml"))
    assert (arm.command, arm.latency) == ("N*m", "0.0003 s")
    with pytest.raises(DesignError, match="kind switched-system"):
        read_run_bounds(read_spec(COMMUTING))


def test_a_good_run(tmp_path):
    found = judged(log(tmp_path), LIMITED)
    assert {c.name: str(c.status) for c in found.checks} == {
        "stiffness": "not judged",
        "contact": "not judged",
        "dwell times": "inside",
        "delay": "not judged",
        "jitter": "not modelled",
        "saturation": "inside",
        "force": "inside",
    }
    assert found.verdict == "inconclusive"
    assert found.first is None


def test_the_first_violation_has_its_time(tmp_path):
    t, *rest = runs.run(stiffness=lambda t: np.where(t > 6, 60.0, runs.STIFFNESS))
    found = judged(log(tmp_path, (t + 100.0, *rest)))
    assert found.verdict == "outside"
    assert found.first.name == "force"
    assert 106.0 <= found.first.time < 106.6


@pytest.mark.parametrize(
    ("sampled", "options", "status", "said"), rows(__file__, "test_lost_contact")
)
def test_lost_contact(tmp_path, sampled, options, status, said):
    bounds = SAMPLED if sampled else SOFT
    found = judge_run(log(tmp_path, runs.run(free=2.0)), bounds, **options)
    contact = check(found, "contact")
    assert (contact.status, [contact.allowed, contact.basis]) == (status, said)
    assert found.verdict == "inconclusive"


def test_nothing_to_touch_leaves_nothing_open(tmp_path):
    """The rule of the verdict: inside needs every check."""
    found = judged(log(tmp_path))
    inside = tuple(replace(c, status="inside") for c in found.checks)
    assert replace(found, checks=inside).verdict == "inside"
    unknown = (replace(inside[0], status="not judged"), *inside[1:])
    assert replace(found, checks=unknown).verdict == "inconclusive"


def test_saturation_and_force(tmp_path):
    t, angle, torque, command, mode = runs.run()
    torque = torque + np.where(np.arange(len(t)) == 3000, 0.3, 0.0)
    found = judged(
        log(tmp_path, (t, angle, torque, command, mode)), replace(SOFT, saturates=1990.0)
    )
    assert check(found, "force").time == pytest.approx(6.0)
    saturated = check(found, "saturation")
    assert saturated.time == pytest.approx(t[np.argmax(np.abs(np.round(command, 2)) >= 1990)])
    # A reading above the limit that noise explains is no violation.
    noisy = log(tmp_path, runs.run(stiffness=52.0, noise=0.02))
    assert check(judged(noisy), "force").status == "undecided"
    assert "give the spec `limits: command`" in check(judged(log(tmp_path)), "saturation").measured


def test_a_strange_mode(tmp_path):
    t, angle, torque, command, mode = runs.run()
    mode = np.where(mode == "insertion", "idle", mode)
    found = judged(log(tmp_path, (t, angle, torque, command, mode)))
    assert check(found, "dwell times").status == "not judged"


def test_what_no_log_shows_is_not_judged_so_the_run_is_not_inside(tmp_path):
    bounds = read_run_bounds(read_spec(ROBOT / "concha.nrs.yaml"))
    unseen = check(judged(log(tmp_path), bounds), "preload of concha")
    assert (unseen.status, unseen.allowed) == ("not judged", "0.1 rad to 0.3 rad")
    assert SOFT.preloads == {}


def test_a_tissue_that_remembers(tmp_path):
    text = (ROBOT / "nose.nrs.yaml").read_text()
    noise = "{torque_noise: 3 N*mm, angle_noise: 1e-5 rad, surface: fixed}"
    bounds = bounds_of_spec(parse_spec(f"{text}\nmonitoring: {noise}\n"))
    record = log(tmp_path, csv=runs.without_modes(runs.run()))
    assert "does not follow from" in check(judged(record, bounds), "stiffness").measured


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time_s,other\n" + "0,1\n" * 60, "no column beside the time"),
        ("time_s,angle_rad\n0,1\n1,2\n", "has 2 rows"),
        ("time_s,torque_lbf\n" + "0,1\n" * 60, "unit 'lbf'"),
    ],
)
def test_wrong_logs(tmp_path, text, message):
    with pytest.raises(DataError, match=message) as caught:
        log(tmp_path, csv=text)
    assert caught.value.remedy


@pytest.mark.slow
def test_a_delay_that_the_record_does_not_tell(tmp_path):
    """One slow swing fits any delay: no number is shown."""
    t = 0.001 * np.arange(8000)
    angle = 0.05 * (1 - np.cos(2 * np.pi * 0.4 * t))
    command = 50 * np.gradient(angle, t)
    torque = 43.0356 * angle / 20
    text = runs.text(t, angle, torque, command, np.full(len(t), "insertion"))
    found = check(judged(log(tmp_path, csv=text)), "delay")
    assert "[" not in found.measured
    assert found.measured.startswith("not determined by this record")


def following(frequencies, noise=0.001):
    """A log of a loop that follows its command as a first-order lag of 50 ms, 10 ms late."""
    random = np.random.default_rng(4)
    t = runs.run()[0]
    swings = [(w := 2 * np.pi * f, np.arctan(w / 20), np.hypot(1, w / 20)) for f in frequencies]
    command = sum(1000 * np.sin(w * t) for w, _, _ in swings)
    angle = sum(0.004 / size * np.sin(w * (t - 0.01) - late) for w, late, size in swings)
    angle = angle + noise * 0.004 * random.normal(size=len(t))
    return t, angle, 43.0 * angle, command, np.full(len(t), "insertion")


@pytest.mark.slow
def test_one_swing_tells_no_delay_from_a_lag(tmp_path):
    """Its lag of phase is that of a longer delay, too, and that is no violation."""
    asked = replace(SOFT, delay=0.03)
    found = check(judged(log(tmp_path, following([1.3])), asked), "delay")
    assert (found.status, found.time) == ("not judged", None)
    assert "cannot separate a delay from a lag" in found.measured
    told = following([1.3, 3.7, 7.1])
    assert check(judged(log(tmp_path, told), asked), "delay").status == "inside"
    # Beside a gap, the rows of the longest stretch say nothing of the others.
    gap = np.r_[0:900, 950:5000]
    parted = log(tmp_path, [column[gap] for column in told])
    assert check(judged(parted, asked), "delay").status == "undecided"
    assert check(judged(parted, replace(SOFT, delay=1e-4)), "delay").status == "outside"


def test_a_command_of_another_kind_than_the_spec_has_is_refused(tmp_path):
    text = runs.text(*runs.run()).replace("command_rpm", "command_V")
    with pytest.raises(DataError, match="the motor of the spec takes rpm") as caught:
        judged(log(tmp_path, csv=text))
    assert "command_rpm" in caught.value.remedy
    assert judged(log(tmp_path, csv=text), replace(SOFT, command="V")).checks


@pytest.mark.parametrize(
    ("column", "command"),
    [("rad_s", "rad/s"), ("deg_s", "rad/s"), ("rad", "rad"), ("deg", "rad"), ("Nm", "N*m")],
)
def test_a_robot_is_judged_in_the_unit_that_it_takes(tmp_path, column, command):
    csv = runs.text(*runs.run()).replace("command_rpm", f"command_{column}")
    bounds = replace(SOFT, command=command, saturates=1e4)
    found = check(judged(log(tmp_path, csv=csv), bounds), "saturation")
    assert found.allowed == f"below 10000 {command}"
    largest = float(found.measured.split()[2])
    assert largest == pytest.approx(2000 * np.radians(1) if "deg" in column else 2000, rel=1e-3)
    with pytest.raises(DataError, match="motor of the spec takes") as caught:
        judged(log(tmp_path, csv=csv.replace(f"command_{column}", "command_V")), bounds)
    assert f"command_{column.replace('deg', 'rad')}" in caught.value.remedy


@pytest.mark.parametrize(("period", "said"), [(0.002, False), (0.0019, True), (0.001, False)])
def test_steps_that_are_not_those_of_the_loop_are_said(tmp_path, period, said):
    jitter = check(judged(log(tmp_path), replace(SAMPLED, period=period)), "jitter")
    assert ("no whole number of periods" in jitter.measured) is said
    assert f"sampled every {period:g} s" in jitter.allowed
    late = replace(SAMPLED, period=period, latency="0.001 s")
    assert check(judged(log(tmp_path), late), "jitter").allowed.startswith(
        "0.001 s from a sample to its command"
    )


def test_the_spec_may_say_where_the_driver_saturates(tmp_path):
    known = replace(SOFT, saturates=1500.0)
    assert check(judged(log(tmp_path), known), "saturation").status == "outside"
    found = check(judged(log(tmp_path), LIMITED), "saturation")
    assert (found.status, found.allowed) == ("inside", "below 3000 rpm")


@pytest.mark.parametrize("names", ["iw", "37"])
def test_modes_have_names(tmp_path, names):
    data = *_, mode = runs.run(duration=6.0)
    mode[:] = np.where(mode == "insertion", *names)
    found = log(tmp_path, data)
    assert found.labels == tuple(names)
    assert [found.labels[i] for i in found.modes] == mode.tolist()
