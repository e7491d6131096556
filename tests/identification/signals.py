"""Synthetic pairs of a command and what follows it. None is a measurement."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from nrs_design.identification.datasets.records import SignalRecord
from tests.identification import motors
from tests.identification.support import source

COUNT, RATE, FINE = 2000, 500.0, 10
# In samples.
DELAY = 2.3


def copy(seed, *, delay=DELAY, noise=0.01, gain=0.9):
    """A smooth signal, later."""
    random = np.random.default_rng([seed, 5])
    before = 500
    fine = 0.01 * np.cumsum(random.normal(size=COUNT * FINE + before))
    fine = gaussian_filter1d(fine, 40.0)
    late = np.round(np.broadcast_to(delay, COUNT) * FINE).astype(int)
    at = before + FINE * np.arange(COUNT)
    seen = gain * fine[at - late] + noise * random.normal(size=COUNT)
    return pair(fine[at], seen)


def held(seed, delay, *, lasts=1.0, begins=0.0, noise=0.01, count=400):
    """A command that is held, later; it changes so many samples after one, and lasts so many."""
    random = np.random.default_rng([seed, 9])
    changes = begins + lasts * np.arange(-20, count / lasts + 20)
    levels = random.normal(size=len(changes))

    def at(times):
        return levels[np.searchsorted(changes, times + 1e-9, "right") - 1]

    samples = np.arange(count)
    seen = 0.9 * at(samples - delay) + noise * random.normal(size=count)
    return SignalRecord(source("held"), samples / RATE, at(samples), seen, names=("sent", "seen"))


def lag(seed, kind="PRBS", *, is_angle=False, second=0.0):
    """A motor without friction; its delay is that of `motors`."""
    noise = 3e-4 if is_angle else 0.01
    record = motors.record(kind, seed, is_angle=is_angle, friction=0.0, second=second, noise=noise)
    return pair(record.command, record.output)


def pair(sent, seen):
    return SignalRecord(source("pair"), np.arange(COUNT) / RATE, sent, seen, names=("sent", "seen"))
