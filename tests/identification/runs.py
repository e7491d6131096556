"""Synthetic logs of a robot at soft tissue, and their audits. None is a measurement."""

import numpy as np

from nrs_design.identification.running.bounds import read_run_bounds
from nrs_design.identification.running.judge import judge_run
from nrs_design.identification.running.log import read_run
from nrs_design.spec import read_spec
from tests.support import ROBOT, SOFT_TISSUE

RATE = 500.0
# soft-tissue: 747.1461 N/m at 0.24 m.
STIFFNESS = 43.0356


def run(seed=0, *, duration=10.0, stiffness=STIFFNESS, noise=0.0005, free=0.0, step=1 / RATE):
    """Return time, angle, torque, command and modes; contact begins after ``free`` s.

    The torque is at the limit of nothing: presses stay below 0.3 N m.
    """
    random = np.random.default_rng(seed)
    t = step * np.arange(round(duration / step))
    angle = 0.004 + 0.0008 * np.sin(2 * np.pi * 1.3 * t) + 0.0008 * np.sin(2 * np.pi * 2.9 * t)
    k = stiffness(t) if callable(stiffness) else np.full_like(t, stiffness)
    torque = np.where(t < free, 0.0, k * angle) + noise * random.normal(size=len(t))
    modes = np.where((t // 2.5) % 2 == 0, "insertion", "withdrawal")
    return t, angle, torque, 2000 * np.sin(2 * np.pi * 0.7 * t), modes


def text(t, angle, torque, command, modes):
    rows = zip(t, angle, torque, command, modes, strict=True)
    body = "\n".join(f"{a:.4f},{b:.7f},{c:.6f},{d:.2f},{e}" for a, b, c, d, e in rows)
    return f"# synthetic\ntime_s,angle_rad,torque_Nm,command_rpm,mode\n{body}\n"


def without_modes(data):
    return "\n".join(line.rsplit(",", 1)[0] for line in text(*data).split("\n"))


SOFT = read_run_bounds(read_spec(SOFT_TISSUE))
SAMPLED = read_run_bounds(read_spec(ROBOT / "soft-tissue-sampled.nrs.yaml"))


def log(tmp_path, data=None, csv=None):
    path = tmp_path / "run.csv"
    path.write_text(text(*(data or run())) if csv is None else csv)
    return read_run(path)


def judged(record, bounds=SOFT, **options):
    return judge_run(record, bounds, proved=True, **options)


def check(found, name):
    return next(item for item in found.checks if item.name == name)
