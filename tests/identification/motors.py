"""Synthetic motors under any command. None is a measurement."""

import numpy as np

from nrs_design.identification.datasets.records import SignalRecord
from tests.identification import synthetic
from tests.identification.support import source

# Thesis 4.1.
GAIN, TIME_CONSTANT, FRICTION = synthetic.GAIN, synthetic.TIME_CONSTANT, synthetic.FRICTION
RATE = synthetic.RATE
DURATION = 4.0
DELAY = 0.0073
AMPLITUDE = 3000.0


def time():
    return np.arange(round(DURATION * RATE)) / RATE


def command(kind, seed=0):
    t, random = time(), np.random.default_rng([seed, 2])
    if kind == "step":
        return np.where(t > 0.5, 1.0, 0.0)
    if kind == "stair":
        return np.floor(t / 0.5 % 4) / 4 * np.where(t < 2, 1, -1)
    if kind == "chirp":
        return np.sin(2 * np.pi * (0.5 * t + 1.2 * t**2))
    if kind == "PRBS":
        return np.repeat(random.choice([-1.0, 1.0], len(t) // 25 + 1), 25)[: len(t)]
    if kind == "multisine":
        phases = random.uniform(0, 2 * np.pi, 6)
        hertz = (0.5, 1, 2, 4, 7, 11)
        waves = [np.sin(2 * np.pi * f * t + p) for f, p in zip(hertz, phases, strict=True)]
        return sum(waves) / 3
    raise ValueError(kind)


def simulate(u, *, delay=DELAY, **options):
    return synthetic.simulate_motor(u, len(time()), delay=delay, **options)


def follow(seed):
    """A position loop that follows steps, with the noise of its sensor in its command."""
    random = np.random.default_rng([seed, 4])
    wanted = np.repeat(random.uniform(-0.6, 0.6, len(time()) // 200 + 1), 200)
    noise = 1e-3 * random.normal(size=len(time()))
    return lambda i, angle: 2e4 * (wanted[i] - angle - noise[i])


def record(kind, seed=0, *, noise=None, is_angle=True, **options):
    u = follow(seed) if kind == "closed loop" else AMPLITUDE * command(kind, seed)
    angle, velocity, sent = simulate(u, **options)
    noise = (3e-4 if is_angle else 0.01) if noise is None else noise
    random = np.random.default_rng([seed, 3])
    output = angle if is_angle else velocity
    output = output + noise * random.normal(size=len(output))
    return SignalRecord(source(f"{kind}-{seed}"), time(), sent, output, is_angle)
