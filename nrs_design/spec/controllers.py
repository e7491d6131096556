"""Controllers that the robot switches between."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import product
from types import MappingProxyType
from typing import Annotated, ClassVar, Literal, get_args

from pydantic import AfterValidator, ConfigDict, Discriminator, Field

from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row, exactly_one, exclusive
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import Contact, Label, Positive, TouchedAtOnce, UnitFraction, Weight
from nrs_design.spec.goals import GoalsSpec
from nrs_design.spec.model import Declared, SpecModel, optional, required
from nrs_design.spec.parameters import Switch
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.quantity_fields import GainSpec

_ENVIRONMENT = "name of the environment that the gains are designed for"
_CONTACTS = (
    "names of all environments touched while this controller is active; default: its own. A list "
    "within it, such as [[soft, stiff]], is touched at once: forces add up"
)

_GOALS = "goals of this controller; they replace the spec's own, key by key"


# The command that a controller gives to the motion loop.
Command = Literal["velocity", "position"]
# Source of the offset X_i of thesis 6.41 at every switch.
Offset = Literal["none", "reference", "measured"]


def _distinct(contacts: tuple[Contact, ...]) -> tuple[Contact, ...]:
    known: list[frozenset[str]] = []
    for index, contact in enumerate(contacts):
        names = frozenset(names_in(contact))
        if names in known:
            raise fault(f"{contact_name(contact)!r} is listed twice", "list it once", index)
        known.append(names)
    return contacts


def names_in(contact: Contact) -> tuple[str, ...]:
    """Return the environments that are touched in a contact: one, or several at once."""
    return (contact,) if isinstance(contact, str) else contact


def contact_name(contact: Contact) -> str:
    """Return the name of a contact, such as ``soft`` or ``soft+stiff``; no label has a plus."""
    return "+".join(names_in(contact))


def contact_names(contacts: Sequence[Contact]) -> tuple[str, ...]:
    """Return the names of contacts."""
    return tuple(map(contact_name, contacts))


def touched_in(contacts: Sequence[Contact]) -> tuple[str, ...]:
    """Return every environment of some contacts, alone or with others, once."""
    return tuple(dict.fromkeys(name for contact in contacts for name in names_in(contact)))


_TOUCHED = (
    Field(
        default_factory=lambda data: (data.get("environment", ""),),
        min_length=1,
        description=_CONTACTS,
    ),
    AfterValidator(_distinct),
    Declared("whole"),
)


class CostWeights(SpecModel, stronger="neither"):
    """Weights of the two parts of the impedance cost (thesis 6.7)."""

    displayed: Weight = optional("weight of the impedance error, >= 0, no unit", Fraction(1, 2))
    sensitivity: Weight = optional("weight of the mean sensitivity, >= 0, no unit", Fraction(1, 2))

    checks = (
        Row(
            "",
            lambda s: not any((s.displayed, s.sensitivity)),
            "all weights are zero",
            "give at least one a positive weight",
        ),
    )


class AbstractControllerSpec(SpecModel, stronger="neither"):
    """Fields that all controllers share."""

    # The motion loop integrates a velocity, and follows a position.
    commands: ClassVar[Command]
    # The controller holds a contact force, or it holds a position whatever the contact is.
    holds_force: ClassVar[bool] = False
    holds_position: ClassVar[bool] = False
    # True: the controller commands torques to a robot with a torque interface.
    makes_torques: ClassVar[bool] = False
    # True: the state stays in the command of other controllers and decays there.
    is_leaky: ClassVar[bool] = False
    # True: the design limits the stiffness of contacts.
    limits_stiffness: ClassVar[bool] = False
    # Gains that `design.free` may name, each with the key that it replaces.
    freeable: ClassVar[Mapping[str, str | None]] = MappingProxyType({})

    @property
    def own_offset(self) -> Offset | None:
        """The source of the offset of its command; None without an offset."""
        return None

    @property
    def sprung(self) -> bool:
        """Tell whether a spring draws it back to its position reference."""
        return "Kt" in self.gains()

    @property
    def displayed(self) -> Quantity | Fraction | None:
        """The desired impedance, or its ratio of torque to velocity; None without one."""
        return None

    def gains(self) -> dict[str, GainSpec]:
        """Return the gains that the design may choose, by name."""
        return {name: value for name, value in self if isinstance(value, GainSpec)}


class AbstractContactControllerSpec(AbstractControllerSpec):
    """Fields that all controllers in contact share."""

    type: str
    environment: Label = required(_ENVIRONMENT, "unknown")
    contacts: Annotated[tuple[TouchedAtOnce, ...], *_TOUCHED]


class ImpedanceControllerSpec(AbstractContactControllerSpec):
    """Admittance ``1/(Mt s + Bt)`` that makes the robot display an impedance (thesis 6.3.1).

    With a spring it is ``1/(Mt s + Bt + Kt/s)`` (thesis 2.2.6.2).
    """

    model_config = ConfigDict(
        json_schema_extra={"not": {"required": ["desired_impedance", "desired_impedance_ratio"]}}
    )
    commands: ClassVar[Command] = "velocity"
    limits_stiffness: ClassVar[bool] = True
    freeable: ClassVar[Mapping[str, str | None]] = MappingProxyType({"Kt": None})

    type: Literal["impedance"] = required("impedance: admittance Y = 1/(Mt s + Bt + Kt/s)")
    desired_impedance: field.Impedance | None = optional(
        "impedance to display in N*m*s/rad; default: torque/velocity of limits",
        stronger="unknown",
        unsaid="other",
    )
    desired_impedance_ratio: Positive | None = optional(
        "desired impedance over torque/velocity of limits, no unit",
        stronger="unknown",
        unsaid="other",
    )
    Mt: field.InertiaGain = required("admittance inertia in kg*m^2, >= 0; or {min: ..., max: ...}")
    Bt: field.DampingGain = required("damping in N*m*s/rad, > 0; or {min: ..., max: ...}")
    Kt: field.SpringGain | None = optional(
        "admittance spring in N*m/rad, > 0, which draws the robot back to its position reference; "
        "default: no spring; with one, contact is kept unless the spec says `contact: losable`"
    )
    weights: CostWeights = Field(
        default_factory=CostWeights, description="weights of the design cost, no unit"
    )
    goals: GoalsSpec | None = optional(_GOALS)

    @property
    def displayed(self) -> Quantity | Fraction:
        """As its spec says; torque over velocity itself by default."""
        ratio = self.desired_impedance_ratio
        return self.desired_impedance or (Fraction(1) if ratio is None else ratio)

    checks = (
        Row(
            "Kt.min",
            lambda s: s.Kt is not None and not s.Kt.fixed,
            "the design chooses Mt and Bt only",
            "give one quantity for both; `design: {{free: ...}}` frees it under proof",
        ),
        exclusive("desired_impedance", "desired_impedance_ratio"),
    )


# The ways to give a gain, each with an example.
_PROPORTIONAL = {
    "proportional_gain": "proportional_gain: 0.02 rad/(N*m)",
    "damping_ratio": "damping_ratio: 0.741",
}
_INTEGRAL = {
    "integral_gain": "integral_gain: 0.5 rad/(N*m*s)",
    "settling_time": "settling_time: 0.3 s",
}


def _just_one_of(*ways: dict[str, str]) -> ConfigDict:
    """Return the JSON Schema of keys of which exactly one of each group is given."""
    return ConfigDict(json_schema_extra={"oneOf": [{"required": [*k]} for k in product(*ways)]})


class AbstractForceSpec(AbstractContactControllerSpec):
    """A controller that holds a force, with a proportional gain."""

    commands: ClassVar[Command] = "position"
    holds_force: ClassVar[bool] = True

    proportional_gain: field.ForceGain | None = optional("Kp in rad/(N*m), or damping_ratio")
    damping_ratio: UnitFraction | None = optional("wanted for the dominant poles, in (0, 1)")


class ForceControllerSpec(AbstractForceSpec):
    """Proportional force controller of the hybrid scheme (thesis 6.3.3)."""

    model_config = _just_one_of(_PROPORTIONAL)
    freeable: ClassVar[Mapping[str, str | None]] = MappingProxyType({"Kp": "damping_ratio"})

    type: Literal["force"] = required("force: u = X_i + Kp (Fd - F), see offset")
    offset: Offset = optional(
        "offset X_i of the command (thesis 6.41), held from one switch of controllers to the "
        "next: the reference of the motion loop at the switch, or the measured position; none: u "
        "= X + Kp (Fd - F) with a constant commanded position X",
        "none",
    )
    goals: GoalsSpec | None = optional(_GOALS)

    @property
    def own_offset(self) -> Offset:
        """As `offset` says."""
        return self.offset

    checks = exactly_one(_PROPORTIONAL)


class IntegralControllerSpec(AbstractForceSpec):
    """Proportional and integral force controller whose integral bleeds in other modes."""

    model_config = _just_one_of(_PROPORTIONAL, _INTEGRAL)
    is_leaky: ClassVar[bool] = True
    freeable: ClassVar[Mapping[str, str | None]] = MappingProxyType(
        {"Kp": "damping_ratio", "Ki": "settling_time"}
    )

    type: Literal["pi-force"] = required(
        "pi-force: u = X + Kp (Fd - F) + w with w' = Ki (Fd - F); w decays as idle_states says "
        "while another controller is active, and stays in the command"
    )
    integral_gain: field.IntegralForceGain | None = optional("Ki in rad/(N*m*s), or settling_time")
    settling_time: field.Duration | None = optional("time in s to a force error of 2 %, for Ki")
    goals: GoalsSpec | None = optional(_GOALS)

    checks = (*exactly_one(_PROPORTIONAL), *exactly_one(_INTEGRAL))


class TorqueImpedanceSpec(AbstractContactControllerSpec):
    """Impedance control of a robot that takes torques (thesis 2.2.6.1)."""

    commands: ClassVar[Command] = "position"
    makes_torques: ClassVar[bool] = True
    goals: ClassVar[GoalsSpec | None] = None

    type: Literal["torque-impedance"] = required(
        "torque-impedance: mass, spring and damper; for a torque_interface"
    )
    stiffness: field.RotationalStiffness = required("of the spring, in N*m/rad")
    damping: field.NonnegativeImpedance = required("of the damper, in N*m*s/rad; 0 allowed")
    inertia_ratio: Positive | None = optional(
        "wanted over actual inertia, no unit; other than 1 takes the force; default: 1"
    )


class PositionControllerSpec(AbstractControllerSpec):
    """Position mode of the hybrid scheme: the closed motion loop alone (thesis 6.3.3)."""

    commands: ClassVar[Command] = "position"
    holds_position: ClassVar[bool] = True
    environment: ClassVar[str | None] = None
    contacts: ClassVar[tuple[Contact, ...]] = ()
    goals: ClassVar[GoalsSpec | None] = None

    type: Literal["position"] = required("position: the motion loop alone, no contact")


class IdleStatesSpec(SpecModel, stronger="neither"):
    """Behaviour of idle states of impedance and pi-force controllers."""

    decay: field.Decay = required(
        "rate in 1/s of the admittance velocity, the position reference and the integral of "
        "pi-force controllers; 0 1/s holds them, which alone is not asymptotically stable"
    )
    reset: Switch = optional(
        "true: zero after an impedance controller; not with pi-force controllers", False
    )


class AntiWindupSpec(SpecModel, stronger="neither"):
    """What keeps the integral of pi-force controllers from winding up."""

    clamp: field.Angle = required(
        "largest integral w, both ways, at every sample, as an angle, such as 2 deg"
    )


ControllerSpec = Annotated[
    ImpedanceControllerSpec
    | ForceControllerSpec
    | IntegralControllerSpec
    | TorqueImpedanceSpec
    | PositionControllerSpec,
    Discriminator("type"),
]
# The `type` of every controller.
CONTROLLER_TYPES: tuple[str, ...] = tuple(
    get_args(model.model_fields["type"].annotation)[0]
    for model in get_args(get_args(ControllerSpec)[0])
)
