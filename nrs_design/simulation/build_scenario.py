"""Scenarios of a spec in SI units, and the default scenario."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from nrs_design.errors import DataError
from nrs_design.models.contact.law import AbstractNonlinearLaw, Element
from nrs_design.models.interval import Interval
from nrs_design.models.plant import Plant
from nrs_design.simulation.build_control import build_control
from nrs_design.simulation.scenario import Errors, Profile, Scenario, Surface
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.scenarios import (
    LONGEST,
    CommandProfileSpec,
    ErrorsSpec,
    ScenarioSpec,
    SurfaceSpec,
)
from nrs_design.wings import load_wing

Pick = Callable[[Interval], float]

DEFAULT = "insertion-and-withdrawal"
# Thesis fig. 6.7 and 6.11: in free space to the largest command, down, again in contact, and out.
_SHAPE = ((0.0, 0.0), (1.0, 1.0), (2.0, 0.25), (3.0, 1.0), (4.0, 0.0), (5.0, -1.0), (6.0, -1.0),
          (7.0, 0.0), (7.5, 0.0))  # fmt: skip
# Time in s to the surface of the default scenario under the largest command.
_AWAY = 1.0


def build_scenario(
    spec: InteractionDesignSpec, plant: Plant, name: str, scenario: ScenarioSpec, folder: Path
) -> Scenario:
    """Convert a scenario to SI; files that it names are relative to the folder of the spec.

    A `DataError` if a file of commands cannot be read, is longer than is simulated, or commands
    more than the limit of the spec.
    """
    profile, length = _profile(scenario.command, folder, spec.limits.velocity.si)
    length = length if scenario.length is None else scenario.length.si
    wanted = spec.limits.torque if scenario.wanted_torque is None else scenario.wanted_torque
    surfaces = tuple(_surface(spec, plant, written) for written in scenario.surfaces)
    return Scenario(
        name,
        profile,
        length,
        surfaces,
        build_control(spec, scenario.control, surfaces),
        0.0 if scenario.start is None else scenario.start.si,
        wanted.si,
        _errors(scenario.errors),
        scenario.seed,
        {} if scenario.limits is None else {n: q.si for n, q in scenario.limits.named.items()},
    )


def check_recordings(spec: InteractionDesignSpec, folder: Path) -> None:
    """Read every file of commands that a spec names, relative to its folder.

    A `DataError` if one cannot be read, is no profile, or commands more than the limit of the spec.
    """
    for scenario in spec.scenarios.values():
        _profile(scenario.command, folder, spec.limits.velocity.si)


def default_scenario(spec: InteractionDesignSpec, plant: Plant) -> Scenario:
    """Return a run into the first environment that is touched, and out again (thesis fig. 6.7)."""
    largest = spec.limits.velocity.si
    times, shares = np.array(_SHAPE).T
    touched = [name for name in spec.environments if name in spec.touched]
    at = largest * _AWAY
    surfaces = tuple(
        Surface(name, _law(spec, plant, name, "nominal"), at, 1) for name in touched[:1]
    )
    profile = Profile.through(times, shares * largest)
    control, wanted = build_control(spec, None, surfaces), spec.limits.torque.si
    return Scenario(DEFAULT, profile, float(times[-1]), surfaces, control, wanted_torque=wanted)


def _profile(command: CommandProfileSpec, folder: Path, largest: float) -> tuple[Profile, float]:
    """Return the profile, and its length in s; zero where it has none."""
    if command.constant is not None:
        return Profile.constant(command.constant.si), 0.0
    if command.sinusoid is not None:
        mean = 0.0 if command.sinusoid.offset is None else command.sinusoid.offset.si
        swing = command.sinusoid
        return Profile.sinusoid(swing.amplitude.si, swing.frequency.si, mean), 0.0
    if command.points is not None:
        points = [(time.si, velocity.si) for time, velocity in command.points]
        times, velocities = np.array(points).T
        return Profile.through(times, velocities), float(times[-1])
    assert command.csv is not None
    _check_inside(folder / command.csv, folder)
    return _recorded(folder / command.csv, largest)


def _check_inside(path: Path, folder: Path) -> None:
    """Refuse a link out of the folder of the spec: it would be another file elsewhere."""
    if not Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder)):
        raise DataError(
            "is a link that leads out of the spec's folder",
            path=path,
            remedy="put the file itself below that folder",
        )


def _recorded(path: Path, largest: float) -> tuple[Profile, float]:
    # Columns are named and scaled as in records of measurements.
    read_table = load_wing("identification", "tables.table").read_table
    table = read_table(path, (("time", "velocity"),), {})
    columns = table.values
    times = columns["time"] - columns["time"][:1]
    if len(times) < 2 or not (np.diff(times) >= 0).all() or not 0 < times[-1] <= LONGEST:
        raise DataError(
            "is no profile of commands: it has fewer than two rows, its times fall, or last no "
            "time or more than an hour",
            path=path,
            remedy="give at least two rows, with times that rise",
        )
    peak = float(np.abs(columns["velocity"]).max())
    if not peak <= largest * (1 + 1e-12):
        raise DataError(
            f"commands {peak:.6g} rad/s, beyond the spec's limit of {largest:.6g} rad/s",
            path=path,
            remedy="command less, or raise limits.velocity",
        )
    return Profile.through(times, columns["velocity"]), float(times[-1])


def _surface(spec: InteractionDesignSpec, plant: Plant, written: SurfaceSpec) -> Surface:
    sign, name = 1 if written.side == "above" else -1, written.environment
    return Surface(name, _law(spec, plant, name, written.parameters), written.at.si, sign)


_PICKS: Mapping[str, Pick] = {
    "nominal": lambda interval: float(interval.nominal),
    "lowest": lambda interval: float(interval.low),
    "highest": lambda interval: float(interval.high),
}


def _law(
    spec: InteractionDesignSpec, plant: Plant, name: str, end: str
) -> Element | AbstractNonlinearLaw:
    """Return the law of an environment with every parameter picked from its range."""
    environment, pick = plant.environment(name), _PICKS[end]
    if environment.nonlinear is not None:
        return environment.nonlinear.drawn(spec.environments[name].drawn_at_pivot(pick))
    return environment.law(*(pick(interval) for interval in environment.ranges)).element


def _errors(written: ErrorsSpec | None) -> Errors:
    if written is None:
        return Errors()
    values = {
        name: getattr(written, name).si
        for name in ("friction", "encoder_step", "force_step", "force_noise")
        if getattr(written, name) is not None
    }
    jitter = 0.0 if written.jitter is None else float(written.jitter)
    return Errors(**values, jitter=jitter)
