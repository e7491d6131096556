"""Whether a run stayed inside: stiffness and contact are estimated, and decide nothing."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.errors import DataError, DesignError
from nrs_design.identification.running.bounds import Stiffness, read_run_bounds
from nrs_design.identification.running.check import BoundStatus
from nrs_design.identification.running.judge import judge_run
from nrs_design.identification.running.log import read_run
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
        "stiffness": "estimated",
        "contact": "estimated",
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
    assert 106.0 <= found.first.first.time < 106.6


def varying(k_of_angle):
    t, angle, _, command, mode = runs.run()
    return t, angle, k_of_angle(angle) * angle, command, mode


@pytest.mark.parametrize("rising", [1, -1])
@pytest.mark.parametrize("losable", [False, True])
def test_a_stiffness_that_varies_inside_its_range_is_not_outside(tmp_path, rising, losable):
    """The ratio of torque and angle is inside in every row; no window has a slope inside."""
    (low, high), *_ = SOFT.stiffness["insertion"].ranges
    middle, half = (low + high) / 2, 0.49 * (high - low)
    data = varying(lambda x: middle + rising * half * np.clip((x - 0.004) / 0.0016, -1, 1))
    ratio = data[2] / data[1]
    assert low < ratio.min() < ratio.max() < high
    found = judged(log(tmp_path, data), losable=losable)
    slopes = [w.value for w in found.windows]
    assert not any(low <= k <= high for k in slopes)
    assert found.verdict == "inconclusive"
    assert check(found, "stiffness").status == "estimated"


@pytest.mark.parametrize("stiffness", [60.0, 5.0])
def test_a_strange_stiffness_is_shown_and_never_inside(tmp_path, stiffness):
    data = runs.run(stiffness=stiffness)
    found = judged(log(tmp_path, data), replace(SOFT, torque=1.0), losable=True)
    assert found.verdict == "inconclusive"
    assert all(w.low < stiffness < w.high for w in found.windows)
    assert check(found, "stiffness").measured.endswith(" in 20 windows")
    assert found.estimates.startswith("estimated, not judged: stiffness: a window shows how much")


@pytest.mark.parametrize(
    ("bounds", "options", "status", "said"),
    [
        (SOFT, {"proved": True}, "estimated", ("kept all the time", "assumption of the proof")),
        (
            SOFT,
            {"proved": True, "losable": True},
            "inside",
            ("lost and made again at any time", "covered by the proof"),
        ),
        (
            SAMPLED,
            {"proved": False},
            "inside",
            ("lost and made again at any time", "asked for by the spec, not proved"),
        ),
        (
            SOFT,
            {"proved": False},
            "estimated",
            ("not said", "`contact` of the spec, or a certificate, says whether it may be lost"),
        ),
    ],
)
def test_lost_contact(tmp_path, bounds, options, status, said):
    """Little torque: an estimate, as that of the stiffness is."""
    found = judge_run(log(tmp_path, runs.run(free=2.0)), bounds, **options)
    contact = check(found, "contact")
    assert contact.measured == "about 20 % of the time free, 80 % in contact"
    assert (contact.status, (contact.allowed, contact.basis)) == (status, said)
    assert found.verdict == "inconclusive"


def test_noise_in_free_motion_is_no_contact(tmp_path):
    """Windows too noisy to tell a slope were counted as contact: 54 % of a run that had 2 %."""
    t, angle, _, command, mode = runs.run()
    torque = np.random.default_rng(5).normal(0.0, 2e-3, len(t))
    slow = t, 1e-4 * angle, torque, command, mode
    found = judged(log(tmp_path, slow), losable=True)
    assert check(found, "contact").measured == "about 0 % of the time free, 0 % in contact"
    assert found.share == 0.0


def test_a_torque_of_exactly_zero_is_free_motion(tmp_path):
    """Not contact with a stiffness of zero: its rows are in no window."""
    t, angle, torque, command, mode = runs.run(noise=0.0)
    torque = np.where(t < 2.0, 0.0, torque)
    found = judged(log(tmp_path, (t, angle, torque, command, mode)), losable=True)
    assert check(found, "contact").measured == "about 20 % of the time free, 80 % in contact"
    assert check(found, "stiffness").measured.startswith("slopes of 43")
    assert min(w.first for w in found.windows) == 1000
    assert found.share == 1.0


def test_the_share_of_time_that_tells_something_is_counted(tmp_path):
    """Windows in which nothing moves, gaps and short stays tell nothing."""
    t, angle, torque, command, mode = runs.run(noise=0.0)
    still = np.where(t < 5.0, angle[0], angle)
    found = judged(log(tmp_path, (t, still, 43.0 * still, command, mode)))
    assert found.share == pytest.approx(0.5)
    assert found.estimates.endswith("stiffness or free motion shows in 50 % of the time")
    kept = (t < 2.5) | (t >= 5.0)
    gap = log(tmp_path, tuple(c[kept] for c in (t, angle, torque, command, mode)))
    assert judged(gap).share == pytest.approx(0.75)
    short = np.where((t > 1.0) & (t < 1.02), "withdrawal", "insertion")
    found = judged(log(tmp_path, (t, angle, torque, command, short)))
    assert found.share == pytest.approx(1 - 9 / 5000)


def test_nothing_to_touch_leaves_nothing_open(tmp_path):
    """The rule of the verdict: inside needs every check, and an estimate is none."""
    found = judged(log(tmp_path))
    inside = tuple(replace(c, status=BoundStatus.INSIDE) for c in found.checks)
    assert replace(found, checks=inside).verdict == "inside"
    estimated = (replace(inside[0], status=BoundStatus.ESTIMATED), *inside[1:])
    assert replace(found, checks=estimated).verdict == "inconclusive"


def test_opposite_signs_are_named(tmp_path):
    t, angle, torque, command, mode = runs.run()
    found = judged(log(tmp_path, (t, angle, -torque, command, mode)))
    assert "opposite signs" in check(found, "stiffness").measured
    assert found.verdict == "inconclusive"


def test_a_linear_log(tmp_path):
    t, angle, torque, *_ = runs.run()
    rows = "\n".join(
        f"{a:.4f},{b:.8f},{c:.6f}" for a, b, c in zip(t, angle * 0.24, torque / 0.24, strict=True)
    )
    found = judged(log(tmp_path, text=f"time_s,deflection_m,force_N\n{rows}\n"))
    assert all(w.low < runs.STIFFNESS < w.high for w in found.windows)
    assert "0.2" in check(found, "force").measured


@pytest.mark.parametrize("name", ["angle", "torque"])
def test_missing_columns_are_said(tmp_path, name):
    record = log(tmp_path)
    columns = {key: values for key, values in record.columns.items() if key != name}
    found = judged(replace(record, columns=columns))
    assert check(found, "stiffness").measured == f"no column for {name}"


def test_saturation_and_force(tmp_path):
    t, angle, torque, command, mode = runs.run()
    torque = torque + np.where(np.arange(len(t)) == 3000, 0.3, 0.0)
    found = judged(log(tmp_path, (t, angle, torque, command, mode)), command_limit=1990.0)
    assert check(found, "force").first.time == pytest.approx(6.0)
    saturated = check(found, "saturation")
    assert saturated.first.time == pytest.approx(t[np.argmax(np.abs(np.round(command, 2)) >= 1990)])
    # A reading above the limit that noise explains is no violation.
    noisy = log(tmp_path, runs.run(stiffness=52.0, noise=0.02))
    assert check(judged(noisy), "force").status == "undecided"
    assert "give --command-limit" in check(judged(log(tmp_path)), "saturation").measured


def test_a_strange_mode(tmp_path):
    t, angle, torque, command, mode = runs.run()
    mode = np.where(mode == "insertion", "idle", mode)
    found = judged(log(tmp_path, (t, angle, torque, command, mode)))
    assert "'idle' is no controller" in check(found, "stiffness").measured
    assert check(found, "dwell times").status == "not judged"


def test_what_no_log_shows_is_not_judged_so_the_run_is_not_inside(tmp_path):
    bounds = read_run_bounds(read_spec(ROBOT / "concha.nrs.yaml"))
    unseen = check(judged(log(tmp_path), bounds, command_limit=3000), "preload of concha")
    assert (unseen.status, unseen.allowed) == ("not judged", "0.1 rad to 0.3 rad")
    assert SOFT.preloads == {}


def test_a_tissue_that_remembers(tmp_path):
    bounds = read_run_bounds(read_spec(ROBOT / "nose.nrs.yaml"))
    record = log(tmp_path, text=runs.without_modes(runs.run()))
    assert "remembers" in check(judged(record, bounds), "stiffness").measured


def test_windows_end_at_switches_and_gaps():
    time = np.concatenate([np.arange(100) / 100, 3 + np.arange(100) / 100])
    modes = np.repeat([0, 1, 1], [50, 50, 100])
    assert list(cut_windows(time, modes, 0.5)) == [(0, 50), (50, 100), (100, 150), (150, 200)]
    assert list(cut_windows(time, 0 * modes, 2.0)) == [(0, 100), (100, 200)]


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


def test_intervals_hold_what_noise_does():
    """Of a constant stiffness, 20 windows together leave it out in at most 5 %."""
    alarms = 0
    for seed in range(100):
        t, x, f, *_ = runs.run(seed, noise=0.005)
        spans = list(cut_windows(t, np.zeros(len(t)), 0.5))
        windows = stiffness_of(t, x, f, spans)
        alarms += any(not w.low <= runs.STIFFNESS <= w.high for w in windows)
    assert alarms <= 10


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
    assert (found.status, found.first) == ("not judged", None)
    assert "cannot be told apart" in found.measured
    several = check(judged(log(tmp_path, following([1.3, 3.7, 7.1])), asked), "delay")
    assert several.status == "inside"


def test_a_command_of_another_kind_than_the_spec_has_is_refused(tmp_path):
    text = runs.text(*runs.run()).replace("command_rpm", "command_V")
    with pytest.raises(DataError, match="the motor of the spec takes rpm") as caught:
        judged(log(tmp_path, text=text))
    assert "command_rpm" in caught.value.remedy
    assert judged(log(tmp_path, text=text), replace(SOFT, command="V")).checks


def test_without_modes_the_ranges_of_all_controllers_are_shown(tmp_path):
    other = Stiffness(((10.0, 20.0),), ())
    bounds = replace(SOFT, stiffness={"insertion": SOFT.stiffness["insertion"], "other": other})
    record = log(tmp_path, text=runs.without_modes(runs.run()))
    found = check(judged(record, bounds), "stiffness")
    assert found.allowed == "41.504 to 44.247 N m/rad or 10 to 20 N m/rad"
    free = replace(bounds, stiffness={**bounds.stiffness, "position": None})
    assert "no column for mode" in check(judged(record, free), "stiffness").measured


@pytest.mark.parametrize(("period", "said"), [(0.002, False), (0.0019, True), (0.001, False)])
def test_steps_that_are_not_those_of_the_loop_are_said(tmp_path, period, said):
    jitter = check(judged(log(tmp_path), replace(SAMPLED, period=period)), "jitter")
    assert ("no whole number of periods" in jitter.measured) is said
    assert f"sampled every {period:g} s" in jitter.allowed
    late = check(judged(log(tmp_path), replace(SAMPLED, period=period, late="0.001 s")), "jitter")
    assert late.allowed.startswith("0.001 s from a sample to its command")


def test_the_spec_may_say_where_the_driver_saturates(tmp_path):
    known = replace(SOFT, saturates=1500.0)
    assert check(judged(log(tmp_path), known), "saturation").status == "outside"
    found = check(judged(log(tmp_path), known, command_limit=3000.0), "saturation")
    assert (found.status, found.allowed) == ("inside", "below 3000 rpm")


@pytest.mark.parametrize("names", ["iw", "37"])
def test_modes_have_names(tmp_path, names):
    t, angle, torque, command, mode = runs.run(duration=6.0)
    mode = np.where(mode == "insertion", *names)
    path = tmp_path / "run.csv"
    path.write_text(runs.text(t, angle, torque, command, mode))
    log = read_run(path)
    assert log.labels == tuple(names)
    assert [log.labels[i] for i in log.modes] == mode.tolist()
    assert log.command_unit == "rpm"
