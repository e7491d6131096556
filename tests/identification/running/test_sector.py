"""The test of the monitor in C, on logs: told where no stiffness of the range explains the rows."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.identification.running.bounds import bounds_of_spec
from nrs_design.identification.running.judge import judge_run
from nrs_design.identification.running.sector import judge_sector
from nrs_design.spec import parse_spec
from tests.identification import runs
from tests.identification.runs import check, log
from tests.support import ROBOT

TEXT = (ROBOT / "soft-tissue-sampled.nrs.yaml").read_text()
LOW, HIGH = 720.56 * 0.24**2, 768.17 * 0.24**2
NOISE = 0.002


def bounds(surface="fixed", text=TEXT, more=""):
    said = f"monitoring: {{torque_noise: 2 N*mm, angle_noise: 0.005 deg, surface: {surface}{more}}}"
    return bounds_of_spec(parse_spec(f"{text}\n{said}\n"))


def pressed(stiffness=43.0, *, surface=0.0, seed=0, count=5000, late=True):
    """Return a log of presses: what is told of it is known, noise within its bounds."""
    random = np.random.default_rng(seed)
    t = 0.002 * np.arange(count)
    angle = 0.002 + 0.004 * np.sin(2 * np.pi * 0.7 * t) + 0.0005 * np.sin(2 * np.pi * 2.9 * t)
    k = stiffness(t, angle) if callable(stiffness) else np.full_like(t, stiffness)
    place = surface(t, angle) if callable(surface) else surface
    torque = k * np.maximum(angle - place, 0.0)
    if late:
        torque[1:] = np.where(random.random(count - 1) < 0.5, torque[:-1], torque[1:])
    torque += 0.95 * NOISE * random.uniform(-1, 1, count)
    angle = angle + 0.9 * np.radians(0.005) * random.uniform(-1, 1, count)
    mode = np.where((t // 0.3) % 2 == 0, "insertion", "withdrawal")
    return t, angle, torque, 2000 * np.sin(t), mode


def judged(tmp_path, data, known, **options):
    return judge_run(log(tmp_path, data), known, proved=True, losable=True, **options)


KINDS = {
    "constant": 43.0,
    "jumps": lambda t, x: np.where(np.sin(40 * t) > 0, LOW, HIGH),
    "sine": lambda t, x: (LOW + HIGH) / 2 + (HIGH - LOW) / 2 * np.sin(9 * t),
    "stiffening": lambda t, x: LOW + (HIGH - LOW) * np.clip(x / 0.004, 0, 1),
    "sign": lambda t, x: np.where(np.gradient(x) > 0, LOW, HIGH),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("surface", ["fixed", "free", "touched"])
def test_a_stiffness_inside_is_never_told(tmp_path, kind, surface):
    found = judged(tmp_path, pressed(KINDS[kind], seed=len(kind)), bounds(surface))
    stiffness = check(found, "stiffness")
    assert (str(stiffness.status), stiffness.time) == ("undecided", None)
    assert stiffness.measured.startswith("the range explains every row; 1.5 times the range would")
    assert found.judged_share > 0.3
    assert found.verdict == "inconclusive"


@pytest.mark.parametrize("factor", [0.5, 0.8, 1.2, 1.5, 2.0])
@pytest.mark.parametrize("surface", ["fixed", "free", "touched"])
def test_a_stiffness_outside_is_told_once_its_torque_is_enough(tmp_path, factor, surface):
    known = bounds(surface)
    k = factor * (HIGH if factor > 1 else LOW)
    data = pressed(lambda t, x: np.where(t > 4.0, k, 43.0), late=False)
    found = judged(tmp_path, data, replace(known, torque=5.0))
    first = check(found, "stiffness")
    assert found.verdict == "outside"
    assert found.first is first
    # By the need of the monitor, with the travel of two rows.
    need = float(known.sector.need(Fraction(factor), Fraction("0.0001")))
    enough = data[0][(data[0] > 4.0) & (data[2] > need + NOISE)]
    assert 4.0 < first.time <= (enough[0] if len(enough) else 10.0)


@pytest.mark.parametrize(
    ("surface", "known"),
    [
        # Pressed anew 1 mrad deeper each time.
        (lambda t, x: 0.001 * np.floor(t * 0.7 + 0.25), bounds("free")),
        (lambda t, x: 0.0005 * np.sin(2 * t), bounds(more=", surface_speed: 1e-3 rad/s")),
    ],
    ids=["in the air", "all the time"],
)
def test_a_surface_that_moves(tmp_path, surface, known):
    data = pressed(surface=surface)
    assert check(judged(tmp_path, data, bounds()), "stiffness").time is not None
    assert check(judged(tmp_path, data, known), "stiffness").time is None


def test_a_pull_is_told_unless_contact_is_kept(tmp_path):
    t, angle, torque, *rest = pressed()
    torque = np.where(np.arange(len(t)) == 700, -0.0021, torque)
    found = check(judged(tmp_path, (t, angle, torque, *rest), bounds()), "stiffness")
    assert found.time == pytest.approx(1.4)
    kept = bounds(text=TEXT.replace("contact: losable", "contact: kept"))
    pulling = (t, angle, 43.0 * angle, *rest)
    assert check(judged(tmp_path, pulling, kept), "stiffness").time is None
    assert check(judged(tmp_path, pulling, bounds()), "stiffness").time is not None
    assert check(judged(tmp_path, (t, angle, 30 * angle, *rest), kept), "stiffness").time


def test_the_speed_of_the_joint(tmp_path):
    data = pressed()
    slow, fast = (bounds(more=f", speed: {speed} rad/s") for speed in ("0.01", "0.2"))
    assert str(check(judged(tmp_path, data, slow), "speed of the joint").status) == "outside"
    assert str(check(judged(tmp_path, data, fast), "speed of the joint").status) == "inside"


def test_gaps_and_rows_that_are_missing(tmp_path):
    """The surface may move in a gap, unless it is fixed; nothing is told of the rows beside it."""
    t, angle, torque, *rest = pressed(surface=lambda t, x: np.where(t > 4.5, 0.003, 0.0))
    kept = (t < 3.0) | (t > 4.6)
    data = tuple(column[kept] for column in (t, angle, torque, *rest))
    assert check(judged(tmp_path, data, bounds()), "stiffness").time is not None
    assert check(judged(tmp_path, data, bounds("free")), "stiffness").time is None
    every = tuple(column[::3] for column in pressed())
    found = judged(tmp_path, every, bounds())
    assert str(check(found, "stiffness").status) == "not judged"


def test_a_linear_log_is_turned(tmp_path):
    t, angle, torque, *_ = pressed()
    rows = zip(t, angle * 0.24, torque / 0.24, strict=True)
    text = "time_s,deflection_m,force_N\n" + "\n".join(f"{a},{b},{c}" for a, b, c in rows) + "\n"
    record = log(tmp_path, csv=text)
    assert judge_sector(record, bounds())[0][0].time is None
    record.columns["force"][:] *= 1.5
    assert judge_sector(record, bounds())[0][0].time is not None


def test_without_bounds_or_columns_the_stiffness_is_not_judged(tmp_path):
    unknown = bounds_of_spec(parse_spec(TEXT))
    assert "no `monitoring`" in unknown.sector
    found = judged(tmp_path, runs.run(), unknown)
    assert str(check(found, "stiffness").status) == "not judged"
    assert found.judged_share is None
    record = log(tmp_path, runs.run())
    columns = {key: values for key, values in record.columns.items() if key != "torque"}
    (unseen,), share = judge_sector(replace(record, columns=columns), bounds())
    assert (str(unseen.status), share) == ("not judged", None)
