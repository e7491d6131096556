"""From what a spec says of a scenario to SI numbers; and the scenario of a spec that has none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from nrs_design.controllers.threshold_logic import ThresholdLogic
from nrs_design.errors import DataError
from nrs_design.models.contact import HuntCrossley
from nrs_design.models.contact.environment import Environment
from nrs_design.models.contact.law import AbstractContactLaw, Element
from nrs_design.models.plant import Plant
from nrs_design.simulation.scenario import (
    COMMAND,
    DEPTH,
    TORQUE,
    Condition,
    Control,
    Errors,
    Profile,
    Scenario,
    Surface,
    Switch,
)
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.environment import EnvironmentSpec
from nrs_design.spec.interval import Interval
from nrs_design.spec.scenarios import (
    LONGEST,
    CommandProfileSpec,
    ControlSpec,
    ErrorsSpec,
    ScenarioSpec,
)

DEFAULT = "insertion-and-withdrawal"
# Thesis fig. 6.7 and 6.11: in free space to the largest command, down, again in contact, and out.
_SHAPE = ((0.0, 0.0), (1.0, 1.0), (2.0, 0.25), (3.0, 1.0), (4.0, 0.0), (5.0, -1.0), (6.0, -1.0),
          (7.0, 0.0), (7.5, 0.0))  # fmt: skip
# Where the surface of the default scenario lies: so many seconds of the largest command away.
_AWAY = 1.0


def build_scenario(
    spec: InteractionDesignSpec, plant: Plant, name: str, scenario: ScenarioSpec, folder: Path
) -> Scenario:
    """Convert a scenario to SI.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With its limits, environments and mode logic.
    plant : Plant
        Of that spec.
    name : str
        Of the scenario.
    scenario : ScenarioSpec
        As written.
    folder : Path
        Of the spec, for files that it names.

    Raises
    ------
    DataError
        If a file of commands cannot be read, is longer than is simulated, or commands more than
        the limit of the spec.
    """
    profile, length = _profile(scenario.command, folder, spec.limits.velocity.si)
    length = length if scenario.length is None else scenario.length.si
    wanted = spec.limits.torque if scenario.wanted_torque is None else scenario.wanted_torque
    surfaces = tuple(
        _surface(spec, plant, s.environment, s.parameters, s.at.si, 1 if s.side == "above" else -1)
        for s in scenario.surfaces
    )
    return Scenario(
        name,
        profile,
        length,
        surfaces,
        _control(spec, scenario.control, surfaces),
        0.0 if scenario.start is None else scenario.start.si,
        wanted.si,
        _errors(scenario.errors),
        scenario.seed,
    )


def default_scenario(spec: InteractionDesignSpec, plant: Plant) -> Scenario:
    """Return a run into the first environment that is touched, and out again (thesis fig. 6.7).

    Parameters
    ----------
    spec : InteractionDesignSpec
        Without scenarios.
    plant : Plant
        Of that spec.
    """
    largest = spec.limits.velocity.si
    times, shares = np.array(_SHAPE).T
    touched = [name for name in spec.environments if name in spec.touched]
    at = largest * _AWAY
    surfaces = tuple(_surface(spec, plant, name, "nominal", at, 1) for name in touched[:1])
    profile = Profile.through(times, shares * largest)
    control, wanted = _control(spec, None, surfaces), spec.limits.torque.si
    return Scenario(DEFAULT, profile, float(times[-1]), surfaces, control, wanted_torque=wanted)


def _profile(command: CommandProfileSpec, folder: Path, largest: float) -> tuple[Profile, float]:
    """Return the profile, and how long it is where that follows from it."""
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
    return _recorded(folder / command.csv, largest)


def _recorded(path: Path, largest: float) -> tuple[Profile, float]:
    from nrs_design.identification.datasets.table import read_table

    table = read_table(path, (("time", "velocity"),), {}, lambda done: None, ())
    columns = table.groups[""]
    times = columns["time"] - columns["time"][0]
    if len(times) < 2 or not (np.diff(times) >= 0).all() or not 0 < times[-1] <= LONGEST:
        raise DataError(
            "is no profile of commands: its times fall, or last no time or more than an hour",
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


def _surface(
    spec: InteractionDesignSpec, plant: Plant, name: str, end: str, at: float, sign: int
) -> Surface:
    law, element = _law(spec.environments[name], plant.environment(name), end)
    return Surface(name, law, element, at, sign)


def _law(
    written: EnvironmentSpec, environment: Environment, end: str
) -> tuple[AbstractContactLaw, Element | None]:
    """Return the law at one end of its ranges; a power law is not linear."""

    def pick(interval: Interval) -> float:
        return float({"lowest": interval.low, "highest": interval.high}.get(end, interval.nominal))

    if written.model == "hunt-crossley":
        tangent = written.exact_at_pivot()
        about = written.about.si
        if written.lever_arm is not None:
            about /= written.lever_arm.si
        exponent = {
            "lowest": written.exponent.range[0],
            "highest": written.exponent.range[1],
        }.get(end, written.exponent.nominal)
        k, b = pick(tangent["stiffness"]), pick(tangent["damping"])
        return HuntCrossley.through(k, b, float(exponent), about), None
    law = environment.law(*(pick(interval) for interval in environment.ranges))
    return law, law.element


def _control(
    spec: InteractionDesignSpec, written: ControlSpec | None, surfaces: tuple[Surface, ...]
) -> Control:
    first = next(iter(spec.controllers))
    thresholds = spec.mode_logic is not None and spec.mode_logic.type == "thresholds"
    if written is None:
        return by_logic(spec) if thresholds else _usual(spec, first)
    if written.fixed is not None:
        return Control(written.fixed)
    if written.schedule is not None:
        times = [(time.si, name) for time, name in written.schedule]
        return Control(times[0][1], schedule=tuple(times[1:]))
    if written.sign is not None:
        return by_sign(written.sign.insertion, written.sign.withdrawal)
    if written.threshold is not None:
        given = written.threshold
        return by_threshold(given.position, given.force, given.torque.si)
    if written.contact is not None:
        switches = tuple(_by_contact(written.contact, surfaces))
        return Control(next(iter(written.contact.values())), switches)
    return by_logic(spec)


def _usual(spec: InteractionDesignSpec, first: str) -> Control:
    """Return what fits names and kinds: signs, the threshold of the torque, or one controller."""
    kinds = {name: controller.type for name, controller in spec.controllers.items()}
    if {"insertion", "withdrawal"} <= kinds.keys():
        return by_sign("insertion", "withdrawal")
    position = next((n for n, kind in kinds.items() if kind == "position"), None)
    force = next((n for n, kind in kinds.items() if kind == "force"), None)
    if position and force:
        return by_threshold(position, force, spec.limits.torque.si)
    return Control(first)


def by_sign(insertion: str, withdrawal: str) -> Control:
    """Return insertion and withdrawal by the signs of command and torque (thesis 6.3.2).

    Parameters
    ----------
    insertion, withdrawal : str
        Controllers.
    """
    pushes_out = (Condition(COMMAND, high=-_TINY), Condition(TORQUE, low=_TINY))
    back = (Condition(COMMAND, low=_TINY),)
    lost = (Condition(TORQUE, high=0.0),)
    return Control(
        insertion,
        (
            Switch(insertion, withdrawal, pushes_out),
            Switch(withdrawal, insertion, back),
            Switch(withdrawal, insertion, lost),
        ),
    )


def by_threshold(position: str, force: str, torque: float) -> Control:
    """Return position control up to a torque in N m, force control beyond it (thesis 6.3.3).

    Parameters
    ----------
    position, force : str
        Controllers.
    torque : float
        The threshold.
    """
    reached = (Condition(TORQUE, low=torque), Condition(COMMAND, low=_TINY))
    return Control(
        position,
        (
            Switch(position, force, reached),
            Switch(force, position, (Condition(COMMAND, high=-_TINY),)),
        ),
    )


# The sign of a signal is told beyond this, in rad/s and N m: not from rounding.
_TINY = 1e-9


def _by_contact(contacts: Mapping[str, str], surfaces: Sequence[Surface]) -> Iterator[Switch]:
    """Yield a switch into the controller of what is met; what is listed later comes first."""
    listed = list(contacts)
    for place, (environment, target) in enumerate(contacts.items()):
        later = tuple(
            Condition(f"{DEPTH}{i}", high=0.0)
            for i, surface in enumerate(surfaces)
            if surface.environment in listed[place + 1 :]
        )
        for source in dict.fromkeys(contacts.values()):
            for i, surface in enumerate(surfaces):
                if source != target and surface.environment == environment:
                    yield Switch(source, target, (Condition(f"{DEPTH}{i}", low=0.0), *later))


def by_logic(spec: InteractionDesignSpec) -> Control:
    """Return the thresholds and timers of the mode logic of a spec."""
    assert spec.mode_logic is not None
    assert spec.mode_logic.type == "thresholds"
    logic = ThresholdLogic.of(spec.mode_logic)
    switches = (
        Switch(source, target, tuple(Condition(signal, *ends) for signal, ends in bounds.items()))
        for source, target, bounds in logic.conditions()
    )
    return Control(logic.initial, tuple(switches), logic.stays, ships=True)


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
