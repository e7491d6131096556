"""Whether a scenario fits the rest of its spec."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from nrs_design.proof.text import quoted
from nrs_design.spec.faults import did_you_mean, fault
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.scenarios import AXES, CommandProfileSpec, ScenarioSpec


def check_run_names(scenarios: Mapping[str, ScenarioSpec]) -> None:
    """Refuse a scenario that is called as one axis of another, ``NAME.theta1``."""
    for name in scenarios:
        whole, _, axis = name.rpartition(".")
        if axis in AXES and whole in scenarios and scenarios[whole].axes is not None:
            raise fault(
                f"{name!r} is the name of a run of {whole!r}",
                "give it another name",
                "scenarios",
                name,
            )


def check_scenario(
    name: str,
    scenario: ScenarioSpec,
    controllers: Mapping[str, Any],
    environments: Mapping[str, Any],
    largest: Quantity,
    *,
    logic: bool,
    robot: bool = False,
) -> None:
    """Refuse a scenario that does not fit the rest of its spec.

    Parameters
    ----------
    name : str
        Of the scenario.
    scenario : ScenarioSpec
        As written.
    controllers, environments : mapping
        Of the spec, by name.
    largest : Quantity
        Limit of the commanded velocity.
    logic : bool
        Whether the spec has a mode logic of thresholds.
    robot : bool
        Whether the spec names a robot whose links couple its axes.
    """
    given, at = (controllers, environments, largest), ("scenarios", name)
    if scenario.axes is None:
        _check_axis(scenario, *given, at, logic=logic)
        return
    if not robot:
        raise fault(
            "three axes move on the links of a robot, and the spec names none",
            "add `coupling: {robot: arm.nrs.yaml}`, or remove axes",
            *at,
            "axes",
        )
    if scenario.start is not None:
        raise fault("three axes begin in a pose", "write axes: {pose: ...}", *at, "start")
    for axis in AXES:
        alone = scenario.of_axis(axis)
        _check_axis(alone, *given, (*at, "axes", axis), logic=logic)


def _check_axis(
    scenario: ScenarioSpec,
    controllers: Mapping[str, Any],
    environments: Mapping[str, Any],
    largest: Quantity,
    at: tuple[str | int, ...],
    *,
    logic: bool,
) -> None:
    _check_velocity(scenario.command, largest, at)
    for i, surface in enumerate(scenario.surfaces):
        for j, name in enumerate((surface.environment, *surface.beside)):
            part: tuple[str | int, ...] = ("beside", j - 1) if j else ("environment",)
            if name not in environments:
                remedy = did_you_mean(name, environments)
                raise fault(f"there is no environment {name!r}", remedy, *at, "surfaces", i, *part)
            if surface.beside and environments[name].preloaded:
                raise fault(
                    f"{name} is not linear, and environments of one body are",
                    "leave beside out, or name linear environments",
                    *(*at, "surfaces", i, *part),
                )
        start = 0.0 if scenario.start is None else scenario.start.si
        depth = start - surface.at.si if surface.side == "above" else surface.at.si - start
        if depth > 0:
            raise fault(
                f"the axis rests inside {surface.environment!r} at the start",
                f"move the surface beyond {start:.6g} rad, or the start out of it",
                *at,
                "surfaces",
                i,
                "at",
            )
    if scenario.control is None:
        return
    for place, controller in scenario.control.named.items():
        if controller not in controllers:
            remedy = did_you_mean(controller, controllers)
            raise fault(f"there is no controller {controller!r}", remedy, *at, "control", *place)
    for environment in scenario.control.contact or {}:
        if environment not in environments:
            remedy = did_you_mean(environment, environments)
            place = (*at, "control", "contact", environment)
            raise fault(f"there is no environment {environment!r}", remedy, *place)
    if scenario.control.logic is not None and not logic:
        raise fault(
            "the spec has no mode_logic of type thresholds",
            "add one, or control in another way",
            *at,
            "control",
            "logic",
        )


def _check_velocity(
    command: CommandProfileSpec, largest: Quantity, at: tuple[str | int, ...]
) -> None:
    written: dict[tuple[str | int, ...], float] = {}
    if command.constant is not None:
        written["constant",] = command.constant.si
    for i, (_, quantity) in enumerate(command.points or ()):
        written["points", i, 1] = quantity.si
    if command.sinusoid is not None:
        offset = 0.0 if command.sinusoid.offset is None else command.sinusoid.offset.si
        written["sinusoid",] = abs(offset) + command.sinusoid.amplitude.si
    for place, velocity in written.items():
        # The same number in another unit may be a rounding above.
        if abs(velocity) > largest.si * (1 + 1e-12):
            raise fault(
                f"a velocity of {velocity:.6g} rad/s is beyond the limit of {quoted(largest.text)}",
                "command less, or raise limits.velocity",
                *at,
                "command",
                *place,
            )
