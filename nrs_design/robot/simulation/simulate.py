"""Run tracks at the rate of their controllers, in lockstep."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.progress import Progress, silent
from nrs_design.robot.design.motion_control import LawState
from nrs_design.robot.models.geometry import PoseError
from nrs_design.robot.models.kinematics import JointMotion, direct_kinematics
from nrs_design.robot.models.vectors import Array
from nrs_design.robot.simulation.experiment import TrackingRecord
from nrs_design.robot.simulation.plant import JointState, Stepper, batch_of
from nrs_design.robot.simulation.track import Track

# Steps of the mechanism between two ticks: more do not change the fourth digit of any error.
STEPS_PER_TICK = 1
# Phase of the sine in rad with constant mass matrix and bias, at least a step: 2 ms at 0.1 Hz, 34
# ms at 0.0571 rad/s. A quarter of this phase does not change the fourth digit.
HELD_PHASE = 2e-3
# Arrays of so many ticks still fit into memory.
MOST_TICKS = 2_000_000
# Effects that the simulation leaves out.
LEFT_OUT = (
    "compliance of the capstan's cable, of the links and of the joints",
    "backlash of the gearhead, and its efficiency (at most 70 %, thesis table 4.1)",
    "friction in passive joints and springs; viscous friction beyond that in the motor's gain",
    "static friction above the Coulomb value, and friction that varies with position or load",
    "limits of the driver's voltage, current and speed, and steps of its command",
    "computation delay, filters and errors of the encoder beyond its counts, noise",
    "differences between the robot's model and the robot, beyond the simplified dynamics",
)


def simulate(tracks: Sequence[Track], report: Progress = silent) -> list[TrackingRecord]:
    """Simulate the experiment of every track; records are in their order.

    Experiments of the same rate run in lockstep, which does not change what they give. A motion
    that leaves what the robot can reach is a `DesignError`.
    """
    groups: dict[tuple[float, float, float], list[int]] = {}
    for index, track in enumerate(tracks):
        groups.setdefault(_clock(track), []).append(index)
    records: dict[int, TrackingRecord] = {}
    for (duration, rate, period), indices in sorted(groups.items()):
        noun = "experiment" if len(indices) == 1 else "experiments together"
        report(f"{len(indices)} {noun}, {duration:.4g} s")
        hold_steps = max(1, int(HELD_PHASE / rate * STEPS_PER_TICK / period))
        found = _lockstep([tracks[index] for index in indices], hold_steps)
        records |= zip(indices, found, strict=True)
    return [records[index] for index in range(len(tracks))]


def _clock(track: Track) -> tuple[float, float, float]:
    """Return what tracks must have in common to run in lockstep."""
    return track.experiment.duration, track.experiment.rate, track.law.period


def _ticks(batch: Sequence[Track]) -> Array:
    duration, _, period = _clock(batch[0])
    if duration > MOST_TICKS * period:
        raise DesignError(
            f"{duration:.4g} s at a sample period of {period:.4g} s are more than {MOST_TICKS} "
            "ticks",
            remedy="choose a shorter --period, or a longer sample_period in the spec",
        )
    return np.asarray(period * np.arange(round(duration / period) + 1), dtype=np.float64)


def _lockstep(batch: Sequence[Track], hold_steps: int) -> list[TrackingRecord]:
    time, period = _ticks(batch), batch[0].law.period
    motion = _join([one.experiment.reference(one.mechanism.robot, time) for one in batch])
    drives = batch_of(one.drive for one in batch)
    state = JointState(motion.position[0], *np.zeros((2, len(batch), 3)))
    benches = _group_rows(batch, lambda one: (one.law, one.encoder))
    plants = _group_rows(batch, lambda one: (one.mechanism.robot, one.mechanism.balance))
    memory = [LawState() for _ in benches]
    angles, positions, commands = np.empty((3, len(time), len(batch), 3))
    origin: JointState | None = None
    for tick in range(len(time)):
        positions[tick] = state.position
        reference = motion.select(tick)
        try:
            for index, (track, rows) in enumerate(benches):
                angles[tick, rows] = track.encoder.read(state.position[rows])
                commands[tick, rows], memory[index] = track.law.step(
                    memory[index], reference.select(rows), angles[tick, rows]
                )
            for step in range(tick * STEPS_PER_TICK, (tick + 1) * STEPS_PER_TICK):
                if origin is None or (step % hold_steps == 0 and not state.is_like(origin)):
                    origin, h = state, period / STEPS_PER_TICK
                    stepper = Stepper.create(drives, h, *_mass_and_bias(plants, state))
                state = stepper.step(state, commands[tick])
        except PoseError as error:
            raise _out_of_reach(batch, time[tick]) from error
    return [
        TrackingRecord(
            controller=one.controller,
            experiment=one.experiment,
            time=time,
            reference=one.experiment.motion(time)[0],
            measured=direct_kinematics(one.mechanism.robot, angles[:, row] / one.encoder.ratio),
            actual=direct_kinematics(one.mechanism.robot, positions[:, row]),
            command=commands[:, row],
        )
        for row, one in enumerate(batch)
    ]


def _out_of_reach(batch: Sequence[Track], time: float) -> DesignError:
    names = ", ".join(dict.fromkeys(one.controller for one in batch))
    return DesignError(
        f"a simulated motion ({names}) leaves the reach of the robot at {time:.4g} s",
        remedy="check the gains and the sample period: the loop may be unstable",
    )


def _group_rows(
    batch: Sequence[Track], part: Callable[[Track], tuple[object, ...]]
) -> list[tuple[Track, list[int]]]:
    """Group the rows of tracks that share a part: the first of them, and their rows."""
    groups: dict[tuple[int, ...], list[int]] = {}
    for row, one in enumerate(batch):
        groups.setdefault(tuple(map(id, part(one))), []).append(row)
    return [(batch[rows[0]], rows) for rows in groups.values()]


def _mass_and_bias(plants: list[tuple[Track, list[int]]], state: JointState) -> tuple[Array, Array]:
    mass, bias = np.empty((*state.position.shape, 3)), np.empty(state.position.shape)
    for track, rows in plants:
        found = track.mechanism.mass_and_bias(state.position[rows], state.velocity[rows])
        mass[rows], bias[rows] = found
    return mass, bias


def _join(references: list[JointMotion]) -> JointMotion:
    """Join the references of all rows; shapes (ticks, n, 3)."""
    parts = ((one.position, one.velocity, one.acceleration) for one in references)
    return JointMotion(*(np.stack(arrays, axis=1) for arrays in zip(*parts, strict=True)))
