"""Parts of the spec of an interaction design, without the checks between them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from fractions import Fraction
from types import MappingProxyType
from typing import Annotated, Literal, Self

from pydantic import Field, ValidationInfo, field_validator

from nrs_design.models.axis import AxisType
from nrs_design.models.drive import COMMANDS, CommandInterface
from nrs_design.spec import motion
from nrs_design.spec.certification import SearchExtent
from nrs_design.spec.check import Row
from nrs_design.spec.controllers import (
    AntiWindupSpec,
    ControllerSpec,
    IdleStatesSpec,
    Offset,
    contact_name,
    touched_in,
)
from nrs_design.spec.environment import EnvironmentSpec
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import Digits, Label, Name, Positive, Title
from nrs_design.spec.goals import GoalsSpec
from nrs_design.spec.misses import MISS
from nrs_design.spec.model import SpecModel, optional, required
from nrs_design.spec.provenance import IdentifiedSpec
from nrs_design.spec.quantity import is_less
from nrs_design.spec.quantity_fields import RangedQuantity, Times, ends_of
from nrs_design.spec.sampling import DisturbancesSpec, SamplingSpec
from nrs_design.spec.scenarios import ScenarioSpec
from nrs_design.spec.sensor import MonitoringSpec, SensorSpec
from nrs_design.spec.switching import MODE_LOGIC, LogicalRule
from nrs_design.spec.threshold_logic import ThresholdLogicSpec
from nrs_design.spec.units import THESIS_COMMAND

MAX_ENTRIES = 64
# The contact in the names of the modes of free motion.
FREE = "free"
# Robots without a motor of the user's, by what they take.
INTERFACES: Mapping[str, CommandInterface] = MappingProxyType(
    {f"{takes}_interface": takes for takes in CommandInterface}
)
DriveSpec = motion.ActuatorSpec | motion.FollowingSpec | motion.TorqueInterfaceSpec
# Name of the motion controller in lists of gains.
MOTION = "motion"
# Words in the place of a controller in names of modes, with their meaning.
NOT_CONTROLLERS = {
    MOTION: "the motion loop among the gains and the modes",
    MISS: "the modes of a missed deadline",
}
# Words after the contact in names of modes: ends of ranges, ages, and points.
OF_CORNERS = re.compile(r"([A-Za-z]|tau|Km|(h|in)\d+)-(min|max)|(delay|flow|case)-\d+")


class FactorBounds(SpecModel, stronger="beside"):
    """Bounds of a gain, as factors on the one that the spec gives."""

    min: Positive = required("smallest factor on the given gain, no unit")
    max: Positive = required("largest factor on the given gain, no unit")

    checks = (
        Row(
            "",
            lambda s: not s.min <= 1 <= s.max,
            "the given gain itself is not within these factors",
            "let min be at most 1, and max at least 1",
        ),
    )


class FreeGainsSpec(SpecModel, stronger="beside"):
    """The free gains of one controller with their bounds."""

    Kp: FactorBounds | None = optional("of the motion loop, or of the force")
    Kd: FactorBounds | None = optional("of the motion loop")
    Ki: FactorBounds | None = optional("of the force")
    Kt: FactorBounds | None = optional("spring of an impedance controller")

    checks = (
        Row(
            "",
            lambda s: not dict(s.given()),
            "no gain is named",
            "name one, such as `Kp: {{min: 0.6, max: 1.6}}`",
        ),
    )

    def given(self) -> Iterator[tuple[str, FactorBounds]]:
        """Yield the gains that are free, with their bounds."""
        return ((gain, bounds) for gain, bounds in self if bounds is not None)


class DesignSpec(SpecModel, stronger="beside"):
    """How gains are written down."""

    significant_digits: Digits = optional("digits of designed gains, 1 to 7, before float32", 4)
    free: Annotated[dict[Label, FreeGainsSpec], Field(max_length=MAX_ENTRIES)] = optional(
        "gains beside Mt and Bt that `optimize` may change: motion or the name of a controller -> "
        "gain -> {min: ..., max: ...}, as factors on the given gain",
        {},
    )


class AbstractInteractionSpec(SpecModel, stronger="unknown"):
    """The keys of the spec of an interaction design, and values that follow from them."""

    kind: Literal["interaction-design"] = required("what this file describes")
    name: Name = required("short name: lower-case letters, digits, '.', '_', '-'", "neither")
    title: Title = optional("one line for people, at most 200 characters", "", stronger="beside")
    axis: AxisType = optional(
        "rotary: in rad, N*m and kg*m^2; prismatic: m, N and kg stand for those", AxisType.ROTARY
    )
    actuator: motion.ActuatorSpec | None = optional("velocity-controlled motor; with motion_loop")
    motion_loop: motion.MotionLoopSpec | None = optional("the position loop around the motor")
    velocity_interface: motion.VelocityInterfaceSpec | None = optional(
        "a robot with a motion loop of its own that takes velocities; without actuator"
    )
    position_interface: motion.PositionInterfaceSpec | None = optional("the same for positions")
    torque_interface: motion.TorqueInterfaceSpec | None = optional(
        "a robot that takes torques, without actuator; for controllers of type torque-impedance"
    )
    limits: motion.LimitsSpec = required("what the interaction must respect")
    environments: Annotated[dict[Label, EnvironmentSpec], Field(max_length=MAX_ENTRIES)] = optional(
        "what the robot touches: name -> environment", {}
    )
    controllers: Annotated[
        dict[Label, ControllerSpec], Field(min_length=1, max_length=MAX_ENTRIES)
    ] = required("what the robot switches between: name -> controller")
    idle_states: IdleStatesSpec | None = optional(
        "states of impedance controllers under position or force controllers, and integrals of "
        "pi-force controllers under others; required where both exist"
    )
    anti_windup: AntiWindupSpec | None = optional("clamp of the integral of pi-force controllers")
    goals: GoalsSpec | None = optional("goals of each impedance and force controller, and the gate")
    design: DesignSpec = Field(default_factory=DesignSpec, description="how gains are written down")
    sampling: SamplingSpec | None = optional("the processor of the law; default: continuous time")
    disturbances: DisturbancesSpec | None = optional("what acts on the loop from outside")
    sensor: SensorSpec | None = optional("the force signal, its filter and errors; default: exact")
    monitoring: MonitoringSpec | None = optional(
        "errors of readings, for `export --format monitor` and `audit`; no proof depends on it"
    )
    contact: Literal["losable", "kept"] | None = optional(
        "losable: proved for contact that is lost and made again; kept: taken for granted; "
        "default: losable where that can be proved",
        stronger=("kept", None, "losable"),
    )
    coordinates: Literal["deflection"] = optional(
        "state of the contact: the deflection", "deflection"
    )
    mode_logic: ThresholdLogicSpec | None = optional(
        "what decides which controller is active, for `switching: mode-logic`", unsaid="most"
    )
    switching: LogicalRule = required(
        "arbitrary, mode-logic, or rules with dwell_time and transitions between controllers, or "
        "between controllers in one contact each, such as tissue/soft"
    )
    scenarios: Annotated[dict[Label, ScenarioSpec], Field(max_length=MAX_ENTRIES)] = optional(
        "runs for `nrs-design simulate`: name -> scenario; no proof depends on them", {}
    )
    certification: SearchExtent

    @field_validator("switching", mode="before")
    @classmethod
    def _follow_logic(cls, value: object, info: ValidationInfo) -> object:
        """Put the rules of the mode logic in the place of its name."""
        if value != MODE_LOGIC or not {"controllers", "environments", "mode_logic"} <= set(
            info.data
        ):
            # A faulty one is reported instead.
            return "arbitrary" if value == MODE_LOGIC else value
        if info.data["mode_logic"] is None:
            raise fault(
                "there is no mode_logic to take the rules of switching from",
                "add mode_logic, or write `switching: arbitrary`",
            )
        return info.data["mode_logic"].rules()

    @property
    def identified(self) -> dict[tuple[str, ...], IdentifiedSpec]:
        """Parts that may be identified from records, by their keys."""
        parts: dict[tuple[str, ...], IdentifiedSpec] = {
            (key,): drive for key, drive in self.drives.items()
        }
        parts |= {("environments", name): item for name, item in self.environments.items()}
        return parts if self.sampling is None else parts | {("sampling",): self.sampling}

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
        """The common source of the offset of all force controllers."""
        offsets = (controller.own_offset for controller in self.controllers.values())
        return next((offset for offset in offsets if offset is not None), "none")

    @property
    def drives(self) -> dict[str, DriveSpec]:
        """The drive, by its key: exactly one in a spec without faults."""
        found = {key: getattr(self, key) for key in ("actuator", *INTERFACES)}
        return {key: drive for key, drive in found.items() if drive is not None}

    @property
    def followed(self) -> motion.FollowingSpec | None:
        """The robot that closes its own motion loop, if it does."""
        return self.velocity_interface or self.position_interface

    @property
    def takes(self) -> CommandInterface | None:
        """What the robot takes; None for the commands of a motor."""
        return next((INTERFACES[key] for key in self.drives if key in INTERFACES), None)

    @property
    def command(self) -> str:
        """Unit of what the drive takes."""
        if self.actuator is not None or self.takes is None:
            return THESIS_COMMAND if self.actuator is None else self.actuator.command
        return self.axis.unit(COMMANDS[self.takes])

    @property
    def motor_ranges(self) -> dict[tuple[str, str], RangedQuantity]:
        """The numbers of the drive, by the keys that lead to them."""
        return {
            (name, key): item
            for name, drive in self.drives.items()
            for key, item in drive.ranges.items()
        }

    @property
    def ranges(self) -> dict[tuple[str, ...], RangedQuantity]:
        """Ranged numbers of environments and drive, by their keys."""
        found: dict[tuple[str, ...], RangedQuantity] = {
            ("environments", name, key): quantity
            for name in sorted(self.touched & self.environments.keys())
            for key, quantity in self.environments[name].ranges.items()
        }
        found.update(self.motor_ranges.items())
        return found

    @property
    def late_at(self) -> tuple[str, str] | None:
        """The key that says that commands take effect later than at their sample, or None."""
        jitter = ("sampling", "jitter") if self.sampling and self.sampling.jitter else None
        return next(iter(self.late_times), jitter)

    @property
    def takes_dead_time(self) -> bool:
        """Whether a proof can be about commands that take effect later than at once."""
        return self.sampling is not None and self.sampling.round == 1

    @property
    def late_times(self) -> dict[tuple[str, str], Times]:
        """Latencies of commands, by their keys."""
        found = {(name, "dead_time"): drive.dead_time for name, drive in self.drives.items()}
        found |= {("sampling", "latency"): None if self.sampling is None else self.sampling.latency}
        return {at: times for at, times in found.items() if times is not None}

    def declaring_ages(self, ages: tuple[int, int]) -> Self:
        """Return the spec as if it declared other ages of the force, in samples."""
        assert self.sampling is not None, "a delay is of samples"
        sampling = self.sampling.model_copy(update={"delay": ages})
        return self.model_copy(update={"sampling": sampling})

    @property
    def constant_late(self) -> tuple[str, str] | None:
        """The key of a lateness that is unknown but constant, if all are known or constant."""
        ranged = {at: t for at, t in self.late_times.items() if is_less(t.shortest, t.longest)}
        constant = all(times.is_constant for times in ranged.values())
        return next(iter(ranged), None) if constant else None

    @property
    def late(self) -> tuple[Fraction, Fraction]:
        """Shortest and longest time from a sample to where its command takes effect, in s."""
        each = [ends_of(times) for times in self.late_times.values()]
        return sum((t[0] for t in each), Fraction(0)), sum((t[1] for t in each), Fraction(0))

    @property
    def has_ranges(self) -> bool:
        """Whether the actuator or a touched environment has a range."""
        parts = (*self.motor_ranges.values(), *(self.environments[name] for name in self.touched))
        return not all(part.fixed for part in parts)
