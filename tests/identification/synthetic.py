"""Synthetic records with the thesis's parameters, for tests and examples. None is a measurement.

The thesis shows its records in figures only. These have its parameters, the noise that its RMSE
tables suggest, and the resolution of its sensors:

- silicone specimens (6.1): a surface gauge presses by up to about 7 mm; deflection from a 4096
  count encoder at the end of a 100 mm handle (0.153 mm per count), force from a 10 V amplifier;
- nose and concha (2.5): rotations of up to 0.35 rad, long enough to see the relaxation; like the
  law, the tissue pulls where a real contact would be lost;
- actuator (4.1): sinusoidal commands to a motor with Coulomb friction that sticks at reversals,
  angle from a 14 bit encoder.

``python -m tests.identification.synthetic FOLDER`` writes the samples of ``specs/data``.
"""

from __future__ import annotations

import argparse
import math
from collections import deque
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nrs_design.models.contact import AbstractContactLaw, Elastic, KelvinBoltzmann
from nrs_design.models.contact.motion import Motion
from nrs_design.output import write_output

Array = NDArray[np.float64]

# Thesis 6.1: fits of three experiments, N/m, with their RMSE in N.
SOFT = ((768.17, 0.0969), (720.56, 0.1586), (752.69, 0.1491))
STIFF = ((1055.4, 0.2135), (1076.6, 0.1764), (1079.6, 0.1519))
# Thesis tables 2.4 and 2.5: mean coefficients in N m/rad and N m s/rad, RMSE in N m.
NOSE = KelvinBoltzmann(k1=0.233, k2=0.972, b=23.631)
CONCHA = KelvinBoltzmann(k1=0.479, k2=3.303, b=30.456)
NOSE_NOISE = (0.0216, 0.0165, 0.0062, 0.0111)
CONCHA_NOISE = (0.0157, 0.0085, 0.0128, 0.0055, 0.0080)
# Thesis 4.1: (rad/s)/rpm, s, rpm.
GAIN, TIME_CONSTANT, FRICTION = 4.8417e-4, 0.0351, 276.575
RATE = 500.0
FREQUENCIES = (0.5, 0.8, 1.2, 2.0, 3.0, 4.5, 6.0, 8.0, 11.0, 15.0)

COUNT = 0.1 * 2 * math.pi / 4096
ENCODER = 2 * math.pi / 2**14
_LABEL = "# synthetic record, made by tests.identification.synthetic: not a measurement"


def pressing(duration: float, rate: float, depth: float, period: float, seed: int) -> Motion:
    """Return presses by hand, no two alike: duration and period in s, depth in m (rad)."""
    generator = np.random.default_rng([seed, 1])
    time = np.arange(round(duration * rate) + 1) / rate
    deflection = np.zeros_like(time)
    for start in np.arange(0.0, duration, period).tolist():
        phase = (time - start) / period
        corners = np.array([0.08, 0.38, 0.62, 0.92]) + 0.04 * generator.uniform(-1, 1, 4)
        rise = np.interp(phase, corners, [0, 1, 1, 0], left=0, right=0)
        # No hand moves with corners: the ramp is eased at both ends.
        deflection += depth * generator.uniform(0.7, 1) * (3 * rise**2 - 2 * rise**3)
    return Motion(time, deflection)


def tissue_record(
    law: AbstractContactLaw, motion: Motion, noise: float, seed: int, resolution: float = 0.0
) -> tuple[Motion, Array]:
    """Return what sensors make of a tissue: noise in N (N m), resolution in m (rad), 0 for none."""
    generator = np.random.default_rng(seed)
    force = law.simulate(motion) + noise * generator.standard_normal(len(motion))
    deflection = motion.deflection
    if resolution:
        deflection = resolution * np.round(deflection / resolution)
    return Motion(motion.time, deflection), force


def actuator_record(
    frequency: float, seed: int, *, amplitude: float = 3000.0, periods: int = 8, noise: float = 3e-4
) -> tuple[Array, Array, Array]:
    """Return time, command and angle of a sinusoid of a frequency in Hz, an amplitude in rpm.

    Noise in rad comes before the rounding of the encoder.
    """
    generator = np.random.default_rng(seed)
    count = round(max(periods / frequency, 1.5) * RATE) + 1
    time = np.arange(count) / RATE
    command = np.round(amplitude * np.sin(2 * np.pi * frequency * time), 1)
    angle, _, _ = simulate_motor(command, count)
    angle = angle + noise * generator.standard_normal(count)
    return time, command, ENCODER * np.round(angle / ENCODER)


def simulate_motor(
    u, count, *, delay=0.0, friction=FRICTION, second=0.0, play=0.0, limit=math.inf, fine=20
):
    """Return angle, velocity and command at the samples, simulated in fine steps.

    The motor sticks while the command is below the friction. The command is an array, or a function
    of the number of the sample and the angle there; a delay and a second lag in s, a play in rad
    and a limit of the command may be added.
    """
    h = 1 / RATE / fine
    late = round(delay / h)
    decay = math.exp(-h / TIME_CONSTANT)
    angle = velocity = behind = lagged = 0.0
    angles, velocities, sent, queue = [], [], [], deque()
    for i in range(count * fine):
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


def samples() -> Iterator[tuple[str, str]]:
    for name, fits in (("soft", SOFT), ("stiff", STIFF)):
        for i, (k, rmse) in enumerate(fits, start=1):
            seed = 100 * len(name) + i
            motion = pressing(15.0, 100.0, 5.5 / k, 5.0, seed)
            data = tissue_record(Elastic(k), motion, rmse, seed, COUNT)
            yield f"silicone-{name}-{i}.csv", _tissue_text(data, "deflection_m,force_N", (6, 3))
    for name, law, noises in (("nose", NOSE, NOSE_NOISE), ("concha", CONCHA, CONCHA_NOISE)):
        for i, noise in enumerate(noises, start=1):
            seed = 1000 * len(name) + i
            data = tissue_record(law, pressing(80.0, 20.0, 0.35, 20.0, seed), noise, seed, 1e-4)
            yield f"{name}-{i}.csv", _tissue_text(data, "angle_rad,torque_Nm", (4, 5))
    for i, frequency in enumerate(FREQUENCIES):
        record = actuator_record(frequency, seed=40 + i)
        label = f"{frequency:g}".replace(".", "p")
        yield f"actuator-{label}hz.csv", _text("time_s,command_rpm,angle_rad", record, (3, 1, 6))


def _tissue_text(data: tuple[Motion, Array], names: str, digits: tuple[int, int]) -> str:
    motion, force = data
    return _text(f"time_s,{names}", (motion.time, motion.deflection, force), (2, *digits))


def _text(header: str, columns: Sequence[Array], digits: Sequence[int]) -> str:
    lines = [
        ",".join(f"{value:.{d}f}" for value, d in zip(row, digits, strict=True))
        for row in zip(*(column.tolist() for column in columns), strict=True)
    ]
    # Rounding must not write a negative zero.
    body = "\n".join(lines).replace("-0.000000,", "0.000000,").replace("-0.0000,", "0.0000,")
    return f"{_LABEL}\n{header}\n{body}\n"


def write_samples(folder: Path) -> None:
    for name, text in samples():
        write_output(folder / name, text)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Write the synthetic sample records.")
    parser.add_argument("folder", type=Path)
    write_samples(parser.parse_args().folder)
