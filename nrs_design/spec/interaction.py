"""The spec of an interaction design: one robot, its environments and its controllers."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from nrs_design.spec.certification import CertificationSpec
from nrs_design.spec.constant_force import check_constant_force
from nrs_design.spec.controllers import (
    ControllerSpec,
    IdleStatesSpec,
    Offset,
    contact_name,
    touched_in,
)
from nrs_design.spec.coupling import CouplingSpec, check_coupling
from nrs_design.spec.dwell import DwellObstacle, find_changing_contact
from nrs_design.spec.environment import EnvironmentSpec
from nrs_design.spec.faults import all_of, fault
from nrs_design.spec.fields import Digits, Label, Name, Title
from nrs_design.spec.goals import GoalsSpec, check_applicable
from nrs_design.spec.initial_force import check_initial_force
from nrs_design.spec.mixture import check_mixture, check_offsets
from nrs_design.spec.mode_logic import ModeLogicSpec, check_kept, rules_of
from nrs_design.spec.model import SpecModel
from nrs_design.spec.motion import ActuatorSpec, LimitsSpec, MotionLoopSpec, check_commands
from nrs_design.spec.provenance import IdentifiedSpec
from nrs_design.spec.sampled_loop import check_sampled
from nrs_design.spec.sampling import (
    DisturbancesSpec,
    SamplingSpec,
    check_delay,
    check_disturbances,
    check_motor,
    check_peak,
    takes_motor_ranges,
)
from nrs_design.spec.scenario_checks import check_run_names, check_scenario
from nrs_design.spec.scenarios import ScenarioSpec
from nrs_design.spec.sensor import SensorSpec
from nrs_design.spec.switching import MODE_LOGIC, DwellTime, LogicalRule, check_names
from nrs_design.spec.touched import (
    check_at_once,
    check_controller_names,
    check_free,
    check_hands,
    check_memories,
    check_references,
    check_springs,
)

MAX_ENTRIES = 64


class DesignSpec(SpecModel):
    """How gains are written down."""

    significant_digits: Digits = Field(
        default=4,
        description="designed gains are rounded to so many digits, 1 to 7, then to float32",
    )


class InteractionDesignSpec(SpecModel):
    """Controllers to be designed for the contact with given environments."""

    kind: Literal["interaction-design"] = Field(description="what this file describes")
    name: Name = Field(description="short name: lower-case letters, digits, '.', '_', '-'")
    title: Title = Field(default="", description="one line for people, at most 200 characters")
    actuator: ActuatorSpec = Field(description="the velocity-controlled motor")
    motion_loop: MotionLoopSpec = Field(description="the position loop around the motor")
    limits: LimitsSpec = Field(description="what the interaction must respect")
    environments: Annotated[dict[Label, EnvironmentSpec], Field(max_length=MAX_ENTRIES)] = Field(
        default_factory=dict, description="what the robot touches: name -> environment"
    )
    controllers: Annotated[
        dict[Label, ControllerSpec], Field(min_length=1, max_length=MAX_ENTRIES)
    ] = Field(description="what the robot switches between: name -> controller")
    idle_states: IdleStatesSpec | None = Field(
        default=None,
        description="what the states of impedance controllers do while a position or force "
        "controller is active, and the integral of a pi-force controller while another one is; "
        "required where there are both",
    )
    goals: GoalsSpec | None = Field(
        default=None,
        description="what every impedance and force controller must achieve; the gate enforces it",
    )
    design: DesignSpec = Field(default_factory=DesignSpec, description="how gains are written down")
    sampling: SamplingSpec | None = Field(
        default=None,
        description="the processor that runs the law; without it the proof is for continuous time",
    )
    disturbances: DisturbancesSpec | None = Field(
        default=None,
        description="what acts on the loop from outside; its effect on force and velocity is "
        "bounded",
    )
    coupling: CouplingSpec | None = Field(
        default=None,
        description="what the axes do to each other through their links, for a proof about all "
        "axes at once; without it they are taken not to act on each other",
    )
    sensor: SensorSpec | None = Field(
        default=None,
        description="the force signal: its filter is a part of the loop, its errors bound the "
        "creep; without it the force is taken for exact",
    )
    contact: Literal["losable", "kept"] | None = Field(
        default=None,
        description="whether a proof must hold while contact is lost and made again (losable), or "
        "takes for granted that it is kept; default: losable where that can be proved",
    )
    coordinates: Literal["deflection", "force"] = Field(
        default="deflection",
        description="state of the contact: deflection stays continuous when the stiffness "
        "switches; force is what the thesis uses",
    )
    mode_logic: ModeLogicSpec | None = Field(
        default=None,
        description="what decides which controller is active; `switching: mode-logic` lets the "
        "proof be about the switching signals that it can give",
    )
    switching: LogicalRule = Field(
        description="when controllers change: arbitrary, mode-logic (as mode_logic says), or rules "
        "with dwell_time and transitions between controllers, or between controllers in one "
        "contact each, such as tissue/soft"
    )
    scenarios: Annotated[dict[Label, ScenarioSpec], Field(max_length=MAX_ENTRIES)] = Field(
        default_factory=dict,
        description="runs for `nrs-design simulate`: name -> scenario; no proof depends on them",
    )
    # The default is made without validation, for which a validator of its own would be built.
    certification: CertificationSpec = Field(
        default_factory=CertificationSpec.model_construct,
        description="how far the search for a proof goes",
    )

    @field_validator("switching", mode="before")
    @classmethod
    def _follow_logic(cls, value: object, info: ValidationInfo) -> object:
        """Put the rules of the mode logic in the place of its name."""
        if value != MODE_LOGIC or not {"controllers", "environments", "mode_logic"} <= set(
            info.data
        ):
            # Where one of them is faulty, that is reported instead.
            return "arbitrary" if value == MODE_LOGIC else value
        if info.data["mode_logic"] is None:
            raise fault(
                "there is no mode_logic to take the rules of switching from",
                "add mode_logic, or write `switching: arbitrary`",
            )
        given = (info.data[name] for name in ("mode_logic", "controllers", "environments"))
        try:
            return rules_of(*given)
        except PydanticCustomError:
            # It does not fit: `check_kept` says so at its place.
            return "arbitrary"

    def across(self) -> tuple[Callable[[], object], ...]:
        """Return the checks between parts: contacts, goals, disturbances, the motor, switching."""
        return (
            lambda: check_mixture(
                self.controllers, self.environments, self.idle_states, self.coordinates
            ),
            partial(self._check_each, check_references),
            lambda: check_free(self.environments),
            lambda: check_controller_names(self.controllers),
            lambda: all_of(
                *(
                    partial(check_applicable, c.goals, {c.type}, "controllers", name, "goals")
                    for name, c in self.controllers.items()
                )
            ),
            partial(self._check_each, check_springs),
            lambda: check_disturbances(self.disturbances, self.sampling),
            partial(_check_sensor, self),
            lambda: check_peak(self.goals, self.disturbances),
            partial(_check_commands, self),
            lambda: check_delay(self.goals, self.sampling),
            lambda: check_motor(
                self.actuator,
                self.sampling,
                self.controllers,
                given_loop=self.motion_loop.transfer_function is not None,
                among_axes=self.coupling is not None,
                preloaded=[
                    name
                    for name, environment in self.environments.items()
                    if environment.preloaded and name in self.touched
                ],
            ),
            partial(check_sampled, self),
            partial(check_constant_force, self),
            partial(check_initial_force, self),
            lambda: check_coupling(
                self.coupling,
                loaded=self.actuator.load_inertia is not None,
                disturbed=self.disturbances is not None,
                deflection=self.coordinates == "deflection",
            ),
            lambda: check_memories(self.controllers, self.environments, self.coordinates),
            partial(check_hands, self),
            lambda: check_offsets(self.controllers, self.idle_states),
            lambda: all_of(
                *(
                    partial(self._check_preload, name)
                    for name, environment in self.environments.items()
                    if environment.preloaded and name in self.touched
                )
            ),
            lambda: all_of(
                *(
                    partial(check_at_once, *item, self.environments, self.contact)
                    for item in self.controllers.items()
                )
            ),
            lambda: check_applicable(
                self.goals,
                {c.type for c in self.controllers.values() if "goals" in type(c).model_fields},
                "goals",
            ),
            lambda: check_names(
                self.switching,
                self.contact_names if self.switching.names_contacts else self.controllers,
                "controller",
            ),
            partial(_check_contact_names, self),
            lambda: check_kept(
                self.mode_logic, self.switching, self.controllers, self.environments
            ),
            partial(_check_scenarios, self),
            lambda: all_of(
                *(
                    partial(_check_dwell_time, dwell, self.find_dwell_obstacle, ("switching", *at))
                    for at, dwell in self.switching.dwell_times()
                )
            ),
        )

    def _check_each(
        self, check: Callable[[str, ControllerSpec, dict[str, EnvironmentSpec]], None]
    ) -> None:
        """Check every controller against the environments."""
        environments = self.environments
        all_of(*(partial(check, *item, environments) for item in self.controllers.items()))

    @model_validator(mode="after")
    def _check_across(self) -> InteractionDesignSpec:
        all_of(*self.across())
        return self

    @property
    def identified(self) -> dict[tuple[str, ...], IdentifiedSpec]:
        """What may have been identified from records, by the keys that lead to it."""
        parts: dict[tuple[str, ...], IdentifiedSpec] = {("actuator",): self.actuator}
        parts.update((("environments", name), item) for name, item in self.environments.items())
        if self.sampling is not None:
            parts["sampling",] = self.sampling
        if self.sensor is not None and self.sensor.tool is not None:
            parts["sensor", "tool"] = self.sensor.tool
        return parts

    @property
    def contact_names(self) -> tuple[str, ...]:
        """Every controller in every contact, such as ``tissue/soft``; without one, the former."""
        return tuple(
            name if contact is None else f"{name}/{contact_name(contact)}"
            for name, controller in self.controllers.items()
            for contact in controller.contacts or (None,)
        )

    @property
    def touched(self) -> frozenset[str]:
        """Names of the environments that some controller touches."""
        return frozenset(name for c in self.controllers.values() for name in touched_in(c.contacts))

    @property
    def offset(self) -> Offset:
        """Where the offset of the force controllers is taken from; they have one in common."""
        offsets = (c.offset for c in self.controllers.values() if c.type == "force")
        return next(offsets, "none")

    @property
    def takes_motor_ranges(self) -> bool:
        """Whether a proof can be about ranges of the actuator."""
        given = self.motion_loop.transfer_function is not None
        dwells = any(True for _ in self.switching.dwell_times())
        return not dwells and takes_motor_ranges(self.sampling, self.controllers, given_loop=given)

    @property
    def has_ranges(self) -> bool:
        """Whether the actuator, a touched environment, a gain or the links have a range."""
        if self.coupling is not None:
            return True
        if not (self.actuator.gain.fixed and self.actuator.time_constant.fixed):
            return True
        return any(not self.environments[name].fixed for name in self.touched) or any(
            gain.ranged for c in self.controllers.values() for gain in c.gains().values()
        )

    def _check_preload(self, name: str) -> None:
        """Refuse what is not modelled about an environment that is known within a preload."""
        known = f"{name!r} is known within its preload only"
        if self.contact == "losable":
            raise fault(
                f"loss of contact is not modelled: {known}", "use `contact: kept`", "contact"
            )
        if self.disturbances is not None:
            raise fault(
                f"bounds from rest are not modelled: {known}", "remove disturbances", "disturbances"
            )
        if self.coordinates == "force":
            raise fault(
                f"force coordinates do not apply to {name!r}: its deflection does not jump",
                "use `coordinates: deflection`",
                "coordinates",
            )

    @property
    def flies_like_a_mode(self) -> bool:
        """Whether free motion is a mode like others, which no rule of switching is about."""
        return self.contact == "losable" and any(
            "Kt" in c.gains() for c in self.controllers.values()
        )

    def find_dwell_obstacle(self) -> DwellObstacle | None:
        """Say why no dwell time can be claimed for this spec, or None."""
        if self.flies_like_a_mode:
            return DwellObstacle(
                "a dwell time and loss of contact exclude each other where an admittance has a "
                "spring Kt: contact is lost and made again during the dwell time",
                "use `contact: kept`",
            )
        return find_changing_contact(
            self.actuator,
            self.controllers,
            self.environments,
            by_contact=self.switching.names_contacts,
        )


def _check_scenarios(spec: InteractionDesignSpec) -> None:
    """Refuse scenarios that do not fit the rest of the spec."""
    logic = spec.mode_logic is not None and spec.mode_logic.type == "thresholds"
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


def _check_commands(spec: InteractionDesignSpec) -> None:
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


def _check_contact_names(spec: InteractionDesignSpec) -> None:
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


def _check_sensor(spec: InteractionDesignSpec) -> None:
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
