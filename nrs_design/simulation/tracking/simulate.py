"""Run tracks at the rate of their controllers, in lockstep."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import pi
from typing import Any

import numpy as np

from nrs_design.controllers.motion import JointReference, LawState
from nrs_design.models.robot import direct_kinematics
from nrs_design.models.robot.vectors import Array
from nrs_design.simulation.tracking.experiment import Experiment
from nrs_design.simulation.tracking.plant import DriveArrays, JointState, Stepper
from nrs_design.simulation.tracking.track import Track

# Steps of the mechanism between two ticks: more do not change the fourth digit of any error.
STEPS_PER_TICK = 1
# Phase of the sine in rad for which mass matrix and bias are held, at least one step: 2 ms at
# 0.1 Hz, 34 ms at 0.0571 rad/s. A quarter of it does not change the fourth digit either.
HELD_PHASE = 2e-3
# From rad and m to what the thesis prints of (phi, psi, d).
DISPLAY = np.array([180 / pi, 180 / pi, 1e3])


@dataclass(frozen=True, slots=True)
class Record:
    """What one experiment gave.

    Parameters
    ----------
    controller : str
        Which one.
    experiment : Experiment
        What was asked for.
    time : ndarray
        Ticks in s, shape (n,).
    wanted, measured, actual : ndarray
        Poses (phi, psi, d), shape (n, 3), in rad and m; measured through the encoders.
    command : ndarray
        Shape (n, 3), in rpm.
    """

    controller: str
    experiment: Experiment
    time: Array
    wanted: Array
    measured: Array
    actual: Array
    command: Array

    @property
    def rmse(self) -> Array:
        """Root mean square of wanted less measured, shape (3,), in rad and m.

        Over the whole record, with the time that the pose is held.
        """
        return root_mean_square(self.wanted - self.measured)

    @property
    def actual_rmse(self) -> Array:
        """Root mean square of wanted less actual, shape (3,), in rad and m."""
        return root_mean_square(self.wanted - self.actual)

    def summary(self) -> dict[str, Any]:
        """Return what to print: angles in deg, lengths in mm, commands in rpm, times in s."""
        return {
            "controller": self.controller,
            "moved": self.experiment.moved,
            "period": 2 * pi / self.experiment.rate,
            "duration": self.experiment.duration,
            "rmse": (self.rmse * DISPLAY).tolist(),
            "actual_rmse": (self.actual_rmse * DISPLAY).tolist(),
            "largest_command": np.abs(self.command).max(axis=0).tolist(),
        }


def root_mean_square(error: Array) -> Array:
    """Return the root mean square over the first axis."""
    return np.asarray(np.sqrt(np.mean(error**2, axis=0)), dtype=np.float64)


def simulate(
    tracks: Iterable[Track],
    *,
    steps: int = STEPS_PER_TICK,
    held_phase: float = HELD_PHASE,
    tell: Callable[[str], None] = lambda step: None,
) -> list[Record]:
    """Simulate every experiment of every track.

    Experiments of the same rate run in lockstep, which does not change what they give.

    Parameters
    ----------
    tracks : iterable of Track
        With controllers of one sample period.
    steps : int
        Steps of the mechanism between two ticks.
    held_phase : float
        Phase of the sine in rad for which mass matrix and bias are held.
    tell : callable, optional
        Told what begins, for people who wait.

    Returns
    -------
    list of Record
        In the order of the tracks and their experiments.

    Raises
    ------
    PoseError
        If an experiment leaves what the robot can reach.
    """
    single = [one for track in tracks for one in track.split()]
    order = sorted(range(len(single)), key=lambda index: single[index].experiments[0].duration)
    records: dict[int, Record] = {}
    for _, group in groupby(order, key=lambda index: single[index].experiments[0].duration):
        indices = list(group)
        batch = [single[index] for index in indices]
        rate = batch[0].experiments[0].rate
        many = "experiment" if len(batch) == 1 else "experiments together"
        tell(f"{len(batch)} {many}, {batch[0].experiments[0].duration:.4g} s")
        held = max(1, int(held_phase / rate * steps / batch[0].law.period))
        records |= zip(indices, _lockstep(batch, steps, held), strict=True)
    return [records[index] for index in range(len(single))]


def _lockstep(batch: Sequence[Track], steps: int, held: int) -> list[Record]:
    period = batch[0].law.period
    ticks = round(batch[0].experiments[0].duration / period) + 1
    time = np.asarray(period * np.arange(ticks), dtype=np.float64)
    wanted = _stacked([one.experiments[0].reference(one.mechanism.robot, time) for one in batch])
    drives = DriveArrays.of([one.drive for one in batch])
    state = JointState(wanted.position[0], *np.zeros((2, len(batch), 3)))
    benches = _shared(batch, lambda one: (one.law,))
    plants = _shared(batch, lambda one: one.mechanism.parts)
    memory = [LawState() for _ in benches]
    angles, positions, commands = np.empty((3, len(time), len(batch), 3))
    seen: JointState | None = None
    for tick in range(len(time)):
        positions[tick] = state.position
        reference = wanted.at(tick)
        for index, (track, rows) in enumerate(benches):
            angles[tick, rows] = track.encoder.read(state.position[rows])
            commands[tick, rows], memory[index] = track.law.step(
                memory[index], reference.of(rows), angles[tick, rows]
            )
        for step in range(tick * steps, (tick + 1) * steps):
            if seen is None or (step % held == 0 and not state.is_like(seen)):
                seen = state
                stepper = Stepper.at(drives, period / steps, *_mass_and_bias(plants, state))
            state = stepper.step(state, commands[tick])
    return [
        _record(one, time, angles[:, row], positions[:, row], commands[:, row])
        for row, one in enumerate(batch)
    ]


def _shared(
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


def _stacked(references: list[JointReference]) -> JointReference:
    """Join the references of all rows; shapes (ticks, n, 3)."""
    return JointReference(
        *(
            np.stack([getattr(one, name) for one in references], axis=1)
            for name in ("position", "velocity", "acceleration")
        )
    )


def _record(track: Track, time: Array, angles: Array, positions: Array, commands: Array) -> Record:
    robot, experiment = track.mechanism.robot, track.experiments[0]
    return Record(
        controller=track.controller,
        experiment=experiment,
        time=time,
        wanted=experiment.motion(time)[0],
        measured=direct_kinematics(robot, angles / track.encoder.ratio),
        actual=direct_kinematics(robot, positions),
        command=commands,
    )
