"""Synthetic motors under any command, simulated in fine steps. None is a measurement."""

import math
from collections import deque

import numpy as np

from nrs_design.identification.datasets.records import SignalRecord
from tests.identification.support import source

RATE = 500.0
DURATION = 4.0
GAIN, TIME_CONSTANT, FRICTION, DELAY = 4.8417e-4, 0.0351, 276.575, 0.0073
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


def simulate(u, *, delay=DELAY, friction=FRICTION, second=0.0, play=0.0, limit=math.inf, fine=20):
    """Return angle, velocity and command at the samples.

    The command is an array, or a function of the number of the sample and the angle there; a second
    lag in s, a play in rad and a limit of the command may be added.
    """
    h = 1 / RATE / fine
    late = round(delay / h)
    decay = math.exp(-h / TIME_CONSTANT)
    angle = velocity = behind = lagged = 0.0
    angles, velocities, sent, queue = [], [], [], deque()
    for i in range(len(time()) * fine):
        if i % fine == 0:
            angles.append(behind if play else angle)
            velocities.append(lagged if second else velocity)
            sent.append(float(u(i // fine, angles[-1]) if callable(u) else u[i // fine]))
            if not queue:
                queue.extend([sent[0]] * late)
        queue.append(min(max(sent[-1], -limit), limit))
        value = queue.popleft()
        before = lagged if second else velocity
        if not (velocity == 0.0 and abs(value) <= friction):
            direction = math.copysign(1.0, velocity or value)
            target = GAIN * (value - friction * direction)
            new = target + (velocity - target) * decay
            if new * velocity < 0:
                # The motor stops within this step; what is left of it, it sticks or turns.
                part = velocity / (velocity - new)
                angle += h * part * velocity / 2
                turned = GAIN * (value + friction * direction)
                new = turned * (1 - part) * h / TIME_CONSTANT if abs(value) > friction else 0.0
                angle -= h * (before + new) / 2 - h * (1 - part) * new / 2
            velocity = new
        if second:
            lagged += (velocity - lagged) * -math.expm1(-h / second)
        angle += h * (before + (lagged if second else velocity)) / 2
        behind = min(max(behind, angle - play / 2), angle + play / 2)
    return np.array(angles), np.array(velocities), np.array(sent)


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
