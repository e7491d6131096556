"""What the parts of an interaction design must be for each other."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from nrs_design.spec.constant_force import check_constant_force
from nrs_design.spec.controllers import (
    ControllerSpec,
)
from nrs_design.spec.coupling import check_coupling
from nrs_design.spec.dwell import DwellObstacle
from nrs_design.spec.environment import EnvironmentSpec
from nrs_design.spec.faults import all_of, fault
from nrs_design.spec.goals import check_applicable
from nrs_design.spec.initial_force import check_initial_force
from nrs_design.spec.interaction_parts import AbstractInteractionSpec
from nrs_design.spec.mixture import check_mixture, check_offsets
from nrs_design.spec.mode_logic import check_kept
from nrs_design.spec.motion import check_commands
from nrs_design.spec.sampled_loop import check_sampled
from nrs_design.spec.sampling import (
    check_delay,
    check_disturbances,
    check_motor,
    check_peak,
)
from nrs_design.spec.scenario_checks import check_run_names, check_scenario
from nrs_design.spec.switching import DwellTime, check_names
from nrs_design.spec.touched import (
    check_at_once,
    check_controller_names,
    check_free,
    check_hands,
    check_memories,
    check_references,
    check_springs,
)


def checks_across(spec: AbstractInteractionSpec) -> tuple[Callable[[], object], ...]:
    """Return the checks between parts: contacts, goals, disturbances, the motor, switching.

    Each asks for its parts when it is called, see `SpecModel.across`.
    """
    return tuple(partial(check, spec) for check in _CHECKS)


def _check_mixture(spec: AbstractInteractionSpec) -> None:
    check_mixture(spec.controllers, spec.environments, spec.idle_states, spec.coordinates)


def _check_references(spec: AbstractInteractionSpec) -> None:
    _check_each(spec, check_references)


def _check_free(spec: AbstractInteractionSpec) -> None:
    check_free(spec.environments)


def _check_controller_names(spec: AbstractInteractionSpec) -> None:
    check_controller_names(spec.controllers)


def _check_own_goals(spec: AbstractInteractionSpec) -> None:
    """Refuse goals of a controller that do not apply to its law."""
    all_of(
        *(
            partial(check_applicable, c.goals, {c.type}, "controllers", name, "goals")
            for name, c in spec.controllers.items()
        )
    )


def _check_springs(spec: AbstractInteractionSpec) -> None:
    _check_each(spec, check_springs)


def _check_each(
    spec: AbstractInteractionSpec,
    check: Callable[[str, ControllerSpec, dict[str, EnvironmentSpec]], None],
) -> None:
    """Check every controller against the environments."""
    environments = spec.environments
    all_of(*(partial(check, *item, environments) for item in spec.controllers.items()))


def _check_disturbances(spec: AbstractInteractionSpec) -> None:
    check_disturbances(spec.disturbances, spec.sampling)


def _check_peak(spec: AbstractInteractionSpec) -> None:
    check_peak(spec.goals, spec.disturbances)


def _check_delay(spec: AbstractInteractionSpec) -> None:
    check_delay(spec.goals, spec.sampling)


def _check_motor(spec: AbstractInteractionSpec) -> None:
    check_motor(
        spec.actuator,
        spec.sampling,
        spec.controllers,
        given_loop=spec.motion_loop.transfer_function is not None,
        among_axes=spec.coupling is not None,
        preloaded=_preloaded(spec),
    )


def _preloaded(spec: AbstractInteractionSpec) -> list[str]:
    """Environments that are touched, and known within a preload."""
    return [
        name
        for name, environment in spec.environments.items()
        if environment.preloaded and name in spec.touched
    ]


def _check_coupling(spec: AbstractInteractionSpec) -> None:
    check_coupling(
        spec.coupling,
        loaded=spec.actuator.load_inertia is not None,
        disturbed=spec.disturbances is not None,
        deflection=spec.coordinates == "deflection",
    )


def _check_memories(spec: AbstractInteractionSpec) -> None:
    check_memories(spec.controllers, spec.environments, spec.coordinates)


def _check_offsets(spec: AbstractInteractionSpec) -> None:
    check_offsets(spec.controllers, spec.idle_states)


def _check_preloads(spec: AbstractInteractionSpec) -> None:
    all_of(*(partial(_check_preload, spec, name) for name in _preloaded(spec)))


def _check_preload(spec: AbstractInteractionSpec, name: str) -> None:
    """Refuse what is not modelled about an environment that is known within a preload."""
    known = f"{name!r} is known within its preload only"
    if spec.contact == "losable":
        raise fault(f"loss of contact is not modelled: {known}", "use `contact: kept`", "contact")
    if spec.disturbances is not None:
        raise fault(
            f"bounds from rest are not modelled: {known}", "remove disturbances", "disturbances"
        )
    if spec.coordinates == "force":
        raise fault(
            f"force coordinates do not apply to {name!r}: its deflection does not jump",
            "use `coordinates: deflection`",
            "coordinates",
        )


def _check_at_once(spec: AbstractInteractionSpec) -> None:
    all_of(
        *(
            partial(check_at_once, *item, spec.environments, spec.contact)
            for item in spec.controllers.items()
        )
    )


def _check_common_goals(spec: AbstractInteractionSpec) -> None:
    """Refuse goals that apply to none of the laws."""
    with_goals = (c for c in spec.controllers.values() if "goals" in type(c).model_fields)
    check_applicable(spec.goals, {c.type for c in with_goals}, "goals")


def _check_switching_names(spec: AbstractInteractionSpec) -> None:
    known = spec.contact_names if spec.switching.names_contacts else spec.controllers
    check_names(spec.switching, known, "controller")


def _check_logic(spec: AbstractInteractionSpec) -> None:
    check_kept(spec.mode_logic, spec.switching, spec.controllers, spec.environments)


def _check_dwell_times(spec: AbstractInteractionSpec) -> None:
    if spec.sampling is not None:
        return  # Those of a sampled loop are refused as such: no other way to write them helps.
    all_of(
        *(
            partial(_check_dwell_time, dwell, spec.find_dwell_obstacle, ("switching", *at))
            for at, dwell in spec.switching.dwell_times()
        )
    )


def _check_scenarios(spec: AbstractInteractionSpec) -> None:
    """Refuse scenarios that do not fit the rest of the spec."""
    logic = spec.mode_logic is not None and spec.mode_logic.thresholds is not None
    given = (spec.controllers, spec.environments, spec.limits.velocity)
    robot = spec.coupling is not None and spec.coupling.robot is not None
    all_of(
        partial(check_run_names, spec.scenarios),
        *(
            partial(check_scenario, name, scenario, *given, logic=logic, robot=robot)
            for name, scenario in spec.scenarios.items()
        ),
        lambda: check_commands(
            spec.actuator.command,
            {
                ("scenarios", name, "errors", "friction"): scenario.errors.friction
                for name, scenario in spec.scenarios.items()
                if scenario.errors is not None and scenario.errors.friction is not None
            },
        ),
    )


def _check_commands(spec: AbstractInteractionSpec) -> None:
    """Refuse a gain or a friction about commands that the motor does not take."""
    loop, disturbances = spec.motion_loop, spec.disturbances
    written = {
        ("motion_loop", "derivative_gain"): loop.derivative_gain,
        ("limits", "command"): spec.limits.command,
        ("disturbances", "friction"): None if disturbances is None else disturbances.friction,
    }
    check_commands(
        spec.actuator.command, {at: item for at, item in written.items() if item is not None}
    )


def _check_contact_names(spec: AbstractInteractionSpec) -> None:
    """Refuse rules about single contacts where modes are not made one by one."""
    if not spec.switching.names_contacts:
        return
    if spec.flies_like_a_mode:
        raise fault(
            "rules of switching about controllers in one contact each say nothing of free motion, "
            "which is a mode of its own where an admittance has a spring Kt",
            "name controllers alone in the rules, or use `contact: kept`",
            "switching",
        )
    offset = None if spec.offset == "none" else spec.offset
    beside = (("idle_states", spec.idle_states), ("sampling", spec.sampling), ("offset", offset))
    for at, what in beside:
        if what is not None:
            raise fault(
                f"rules of switching about controllers in one contact each, beside {at}, are not "
                "modelled",
                f"name controllers alone in the rules, or leave {at} out",
                "switching",
            )


def _check_sensor(spec: AbstractInteractionSpec) -> None:
    """Refuse a filter that is not modelled, errors that are there twice, and goals without any."""
    sensor = spec.sensor
    goals = (
        ("goals", spec.goals),
        *((f"controllers.{n}", c.goals) for n, c in spec.controllers.items()),
    )
    for at, given in goals:
        errors = sensor is not None and sensor.has_errors
        if not errors and given is not None and given.wants_creep:
            raise fault(
                "a goal for the creep, and no errors of a sensor that the robot creeps by",
                "add `sensor: {bias: 5e-3 N*m}`, or remove the goal",
                *at.split("."),
            )
    if sensor is None:
        return
    if sensor.filter is not None and any(
        c.commands != "velocity" for c in spec.controllers.values()
    ):
        raise fault(
            "a filter of the force is modelled for impedance controllers only",
            "leave filter out, or position and force controllers",
            "sensor",
            "filter",
        )
    if spec.disturbances is not None and spec.disturbances.force_step is not None:
        raise fault(
            "the sensor says how far its signal is off, and force_step does, too",
            "move it to `sensor: {resolution: ...}`",
            "disturbances",
            "force_step",
        )


def _check_dwell_time(
    dwell: DwellTime, find_obstacle: Callable[[], DwellObstacle | None], at: tuple[str, ...]
) -> None:
    """Check that nothing changes during a dwell time."""
    if dwell.unit != "s":
        raise fault(f"{dwell.text!r} is not a time", "write seconds, such as '2.76 s'", *at)
    obstacle = find_obstacle()
    if obstacle is not None:
        raise fault(obstacle.message, f"leave {at[1]} out, or {obstacle.remedy}", *at)


# In the order in which their faults are told.
_CHECKS: tuple[Callable[[AbstractInteractionSpec], None], ...] = (
    _check_mixture,
    _check_references,
    _check_free,
    _check_controller_names,
    _check_own_goals,
    _check_springs,
    _check_disturbances,
    _check_sensor,
    _check_peak,
    _check_commands,
    _check_delay,
    _check_motor,
    check_sampled,
    check_constant_force,
    check_initial_force,
    _check_coupling,
    _check_memories,
    check_hands,
    _check_offsets,
    _check_preloads,
    _check_at_once,
    _check_common_goals,
    _check_switching_names,
    _check_contact_names,
    _check_logic,
    _check_scenarios,
    _check_dwell_times,
)
