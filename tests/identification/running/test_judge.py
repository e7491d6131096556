"""Whether a run stayed inside: only what a whole interval shows is a violation."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.errors import DataError, DesignError
from nrs_design.identification.running import judge_run, read_run_bounds
from nrs_design.identification.running.bounds import Stiffness
from nrs_design.identification.running.stiffness import cut_windows, stiffness_of
from nrs_design.spec import read_spec
from tests.identification import runs
from tests.identification.running.support import SAMPLED, SOFT, check, judged, log
from tests.support import COMMUTING, ROBOT


def test_bounds_of_the_spec():
    """Thesis 6.1 and 6.3.1.1: 720.56 to 768.17 N/m at 0.24 m."""
    (pair,) = SOFT.stiffness["insertion"].ranges
    assert pair == pytest.approx((720.56 * 0.24**2, 768.17 * 0.24**2))
    assert (SOFT.torque, SOFT.transitions, SOFT.delay) == (0.3, None, None)
    with pytest.raises(DesignError, match="kind switched-system"):
        read_run_bounds(read_spec(COMMUTING))


def test_a_good_run(tmp_path):
    found = judged(log(tmp_path), command_limit=3000)
    assert {c.name: str(c.status) for c in found.checks} == {
        "stiffness": "inside",
        "contact": "inside",
        "dwell times": "inside",
        "delay": "not judged",
        "jitter": "not modelled",
        "saturation": "inside",
        "force": "inside",
    }
    assert found.verdict == "inconclusive"
    assert found.first is None


def test_nothing_is_inside_an_unproved_spec(tmp_path):
    text = "\n".join(line.rsplit(",", 2)[0] for line in runs.text(*runs.run()).split("\n"))
    found = judge_run(log(tmp_path, text=text), SOFT, proved=False)
    assert found.verdict == "inconclusive"
    assert check(found, "stiffness").basis == "range of the spec, not proved"


def test_the_first_violation_has_its_time(tmp_path):
    data = runs.run(stiffness=lambda t: np.where(t > 6, 50.0, runs.STIFFNESS))
    found = judged(log(tmp_path, data))
    assert found.verdict == "outside"
    assert found.first.name == "stiffness"
    assert 6.0 <= found.first.first.time < 6.6
    assert "k = 50" in found.first.first.words


def test_a_range_is_left_only_by_a_whole_interval(tmp_path):
    """1 % above the range, with noise of a size that hides it."""
    data = runs.run(stiffness=44.247 * 1.01, noise=0.02)
    assert str(check(judged(log(tmp_path, data)), "stiffness").status) == "undecided"


def test_lost_contact(tmp_path):
    found = judged(log(tmp_path, runs.run(free=2.0)))
    contact = check(found, "contact")
    assert str(contact.status) == "outside"
    assert contact.first.time == 0.0
    assert str(check(found, "stiffness").status) != "outside"


def test_lost_contact_that_the_proof_covers(tmp_path):
    found = judged(log(tmp_path, runs.run(free=2.0)), losable=True)
    contact = check(found, "contact")
    assert (str(contact.status), contact.basis) == ("inside", "covered by the proof")
    assert contact.measured == "4 of 20 windows without contact"
    assert found.verdict != "outside"
    asked = judge_run(log(tmp_path, runs.run(free=2.0)), SAMPLED, proved=False)
    assert check(asked, "contact").basis == "asked for by the spec, not proved"
    kept = judge_run(log(tmp_path, runs.run(free=2.0)), SAMPLED, proved=True)
    assert str(check(kept, "contact").status) == "outside"


def test_where_nothing_says_whether_contact_may_be_lost_no_loss_is_a_violation(tmp_path):
    """A spec without `contact` leaves it to its proof; without one, nothing was promised."""
    for free in (2.0, 1.8):
        found = judge_run(log(tmp_path, runs.run(free=free)), SOFT, proved=False)
        contact = check(found, "contact")
        assert (str(contact.status), contact.allowed) == ("undecided", "not said")
        assert str(check(found, "stiffness").status) != "outside"
    kept = judge_run(log(tmp_path, runs.run(free=2.0)), replace(SOFT, losable=False), proved=False)
    assert str(check(kept, "contact").status) == "outside"
    whole = judge_run(log(tmp_path), SOFT, proved=False)
    assert str(check(whole, "contact").status) == "inside"


def test_windows_that_do_not_tell_are_counted(tmp_path):
    """A torque that is exactly zero throughout may be free motion or a dead sensor."""
    t, angle, torque, command, mode = runs.run()
    data = log(tmp_path, (t, angle, np.where(t < 2.0, 0.0, torque), command, mode))
    assert check(judged(data, losable=True), "contact").measured == (
        "0 of 20 windows without contact, 4 undecided"
    )


def test_a_window_that_is_partly_free_is_no_stiffness(tmp_path):
    """Where the proof covers lost contact, what seems soft may have been free for a while."""
    t, angle, _, command, mode = runs.run()
    torque = runs.STIFFNESS * np.maximum(angle - angle.mean(), 0.0)
    data = log(tmp_path, (t, angle, torque, command, mode))
    assert str(check(judged(data), "stiffness").status) == "outside"
    found = judged(data, losable=True)
    assert str(check(found, "stiffness").status) == "undecided"
    assert found.verdict == "inconclusive"


def test_a_sampled_proof_is_not_called_continuous(tmp_path):
    found = judged(log(tmp_path), SAMPLED)
    assert "sampled every 0.002 s" in check(found, "jitter").allowed
    assert "continuous" in check(judged(log(tmp_path)), "jitter").allowed


def test_opposite_signs_are_named(tmp_path):
    t, angle, torque, command, mode = runs.run()
    found = judged(log(tmp_path, (t, angle, -torque, command, mode)))
    assert "opposite signs" in check(found, "stiffness").measured
    assert found.verdict == "inconclusive"


def test_time_in_the_log_counts(tmp_path):
    t, *rest = runs.run(stiffness=60.0)
    assert judged(log(tmp_path, (t + 100.0, *rest))).first.first.time == pytest.approx(100.0)


def test_a_linear_log(tmp_path):
    """The lever arm of the spec, 0.24 m."""
    t, angle, torque, *_ = runs.run()
    rows = "\n".join(
        f"{a:.4f},{b:.8f},{c:.6f}" for a, b, c in zip(t, angle * 0.24, torque / 0.24, strict=True)
    )
    found = judged(log(tmp_path, text=f"time_s,deflection_m,force_N\n{rows}\n"))
    assert str(check(found, "stiffness").status) == "inside"
    assert "0.2" in check(found, "force").measured


@pytest.mark.parametrize(
    ("name", "reason"),
    [("angle", "no column for angle"), ("torque", "no column for torque")],
)
def test_missing_columns_are_said(tmp_path, name, reason):
    record = log(tmp_path)
    columns = {key: values for key, values in record.columns.items() if key != name}
    found = judged(replace(record, columns=columns))
    assert check(found, "stiffness").measured == reason


def test_saturation_and_force(tmp_path):
    t, angle, torque, command, mode = runs.run()
    torque = torque + np.where(np.arange(len(t)) == 3000, 0.3, 0.0)
    found = judged(log(tmp_path, (t, angle, torque, command, mode)), command_limit=1990.0)
    assert check(found, "force").first.time == pytest.approx(6.0)
    saturated = check(found, "saturation")
    assert saturated.first.time == pytest.approx(t[np.argmax(np.abs(np.round(command, 2)) >= 1990)])
    # A reading above the limit that noise explains is no violation.
    noisy = log(tmp_path, runs.run(stiffness=52.0, noise=0.02))
    assert str(check(judged(noisy), "force").status) == "undecided"
    assert "give --command-limit" in check(judged(log(tmp_path)), "saturation").measured


def test_jitter_is_measured(tmp_path):
    t, *rest = runs.run()
    t = t + np.where(np.arange(len(t)) % 7 == 0, 0.0009, 0.0)
    assert "0.0011 to 0.0029" in check(judged(log(tmp_path, (t, *rest))), "jitter").measured


def test_a_strange_mode(tmp_path):
    t, angle, torque, command, mode = runs.run()
    mode = np.where(mode == "insertion", "idle", mode)
    found = judged(log(tmp_path, (t, angle, torque, command, mode)))
    assert "'idle' is no controller" in check(found, "stiffness").measured
    assert str(check(found, "dwell times").status) == "not judged"


@pytest.mark.parametrize(
    ("spec", "name", "allowed"),
    [
        ("soft-tissue-axes", "speed of all axes", "below 14 deg/s"),
        ("concha", "preload of concha", "0.1 rad to 0.3 rad"),
    ],
)
def test_what_no_log_shows_is_not_judged_so_the_run_is_not_inside(tmp_path, spec, name, allowed):
    bounds = read_run_bounds(read_spec(ROBOT / f"{spec}.nrs.yaml"))
    unseen = check(judged(log(tmp_path), bounds, command_limit=3000), name)
    assert (str(unseen.status), unseen.allowed) == ("not judged", allowed)
    assert SOFT.unseen == ()


def test_a_tissue_that_remembers(tmp_path):
    bounds = read_run_bounds(read_spec(ROBOT / "nose.nrs.yaml"))
    text = "\n".join(line.rsplit(",", 1)[0] for line in runs.text(*runs.run()).split("\n"))
    assert "remembers" in check(judged(log(tmp_path, text=text), bounds), "stiffness").measured


def test_windows_end_at_switches_and_gaps():
    time = np.concatenate([np.arange(100) / 100, 3 + np.arange(100) / 100])
    modes = np.repeat([0, 1, 1], [50, 50, 100])
    assert list(cut_windows(time, modes, 0.5)) == [(0, 50), (50, 100), (100, 150), (150, 200)]
    assert list(cut_windows(time, None, 2.0)) == [(0, 100), (100, 200)]


def test_noise_of_the_deflection_narrows_nothing():
    """Regression on a noisy deflection alone would give k/2, and be sure of it."""
    random = np.random.default_rng(0)
    t = np.arange(500) / 500
    x = 1e-3 * np.sin(9 * t)
    noisy = x + np.std(x) * random.normal(size=500)
    (window,) = stiffness_of(t, noisy, 43.0 * x, [(0, 500)])
    assert window.value < 30
    assert window.low < 43.0 < window.high


def test_no_window_where_nothing_moves():
    t = np.arange(100) / 100
    (window,) = stiffness_of(t, np.ones(100), np.ones(100), [(0, 100)])
    assert (window.low, window.high) == (-np.inf, np.inf)


def test_false_alarms_are_rare():
    """At the very end of the range, 20 windows together claim a violation in at most 5 %."""
    alarms = 0
    for seed in range(100):
        t, x, f, *_ = runs.run(seed, noise=0.005)
        spans = list(cut_windows(t, None, 0.5))
        windows = stiffness_of(t, x, f, spans)
        alarms += any(not w.low <= runs.STIFFNESS <= w.high for w in windows)
    assert alarms <= 10


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time_s,other\n" + "0,1\n" * 60, "no column beside the time"),
        ("angle_rad,torque_Nm\n" + "0,1\n" * 60, "time_s are missing"),
        ("time_s,angle_rad\n" + "0,1\n" * 60, "time repeats"),
        ("time_s,angle_rad\n0,1\n1,2\n", "has 2 rows"),
        ("time_s,torque_lbf\n" + "0,1\n" * 60, "unit 'lbf'"),
    ],
)
def test_wrong_logs(tmp_path, text, message):
    with pytest.raises(DataError, match=message) as caught:
        log(tmp_path, text=text)
    assert caught.value.remedy


@pytest.mark.slow
def test_a_delay_that_the_record_does_not_tell(tmp_path):
    """One slow swing fits any delay: no number is shown."""
    t = 0.001 * np.arange(8000)
    angle = 0.05 * (1 - np.cos(2 * np.pi * 0.4 * t))
    command = 50 * np.gradient(angle, t)
    torque = 43.0356 * angle / 20
    text = runs.text(t, angle, torque, command, np.full(len(t), "insertion"))
    found = check(judged(log(tmp_path, text=text)), "delay")
    assert "[" not in found.measured
    assert found.measured.startswith("not told by this record")


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
    assert (str(found.status), found.first) == ("not judged", None)
    assert "cannot be told apart" in found.measured
    several = check(judged(log(tmp_path, following([1.3, 3.7, 7.1])), asked), "delay")
    assert str(several.status) == "inside"


@pytest.mark.parametrize("unit", ["V", "mA", "counts"])
def test_a_command_of_another_kind_than_the_spec_has_is_refused(tmp_path, unit):
    text = runs.text(*runs.run()).replace("command_rpm", f"command_{unit}")
    with pytest.raises(DataError, match="the motor of the spec takes rpm") as caught:
        judged(log(tmp_path, text=text))
    assert "command_rpm" in caught.value.remedy
    volts = replace(SOFT, command="V")
    with pytest.raises(DataError, match="read in rpm, and the motor of the spec takes V"):
        judged(log(tmp_path), volts)
    if unit == "V":
        assert judged(log(tmp_path, text=text), volts).checks


def test_a_command_of_another_unit_of_its_kind_is_converted(tmp_path):
    text = runs.text(*runs.run()).replace("command_rpm", "command_deg_s")
    found = check(judged(log(tmp_path, text=text), command_limit=3000.0), "saturation")
    assert "largest command 333.33 rpm" in found.measured


def without_modes(data):
    return "\n".join(line.rsplit(",", 1)[0] for line in runs.text(*data).split("\n"))


def test_without_modes_inside_is_what_every_controller_may_meet(tmp_path):
    """A stiffness that one controller alone may meet is no proof of a run by any of them."""
    other = Stiffness(((10.0, 20.0),), ())
    bounds = replace(SOFT, stiffness={"insertion": SOFT.stiffness["insertion"], "other": other})
    record = log(tmp_path, text=without_modes(runs.run()))
    found = check(judged(record, bounds), "stiffness")
    assert str(found.status) == "undecided"
    assert "no column for mode" in found.measured
    assert str(check(judged(record), "stiffness").status) == "inside"
    stiff = log(tmp_path, text=without_modes(runs.run(stiffness=90.0)))
    assert str(check(judged(stiff, bounds), "stiffness").status) == "outside"


def test_stays_too_short_for_a_window_are_said(tmp_path):
    """What stands in no window may have any stiffness."""
    t, angle, torque, command, modes = runs.run()
    modes = np.where((t > 1.0) & (t < 1.02), "withdrawal", "insertion")
    found = check(judged(log(tmp_path, (t, angle, torque, command, modes))), "stiffness")
    assert str(found.status) == "undecided"
    assert "9 of 5000 rows in no window" in found.measured
    free = replace(SOFT, stiffness={**SOFT.stiffness, "withdrawal": None})
    found = check(judged(log(tmp_path, (t, angle, torque, command, modes)), free), "stiffness")
    assert str(found.status) == "inside"


def test_steps_that_are_not_those_of_the_loop_are_said(tmp_path):
    """2 ms in log and loop; a log in ms that is read in s has none of its periods."""
    assert "no whole" not in check(judged(log(tmp_path), SAMPLED), "jitter").measured
    slower = replace(SAMPLED, period=0.003)
    assert "no whole number of periods" in check(judged(log(tmp_path), slower), "jitter").measured
    faster = replace(SAMPLED, period=0.001)
    assert "no whole" not in check(judged(log(tmp_path), faster), "jitter").measured


def test_the_spec_may_say_where_the_driver_saturates(tmp_path):
    known = replace(SOFT, saturates=1500.0)
    assert str(check(judged(log(tmp_path), known), "saturation").status) == "outside"
    found = check(judged(log(tmp_path), known, command_limit=3000.0), "saturation")
    assert (str(found.status), found.allowed) == ("inside", "below 3000 rpm")
