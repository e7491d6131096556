"""The spec of an interaction design: one robot, its environments and its controllers."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from nrs_design.spec.certification import CertificationSpec
from nrs_design.spec.controllers import (
    ControllerSpec,
    ForceControllerSpec,
    ImpedanceControllerSpec,
    PositionControllerSpec,
)
from nrs_design.spec.environment import EnvironmentSpec
from nrs_design.spec.faults import did_you_mean, fault
from nrs_design.spec.fields import Digits, Label, Name, Title
from nrs_design.spec.model import SpecModel
from nrs_design.spec.motion import ActuatorSpec, LimitsSpec, MotionLoopSpec
from nrs_design.spec.switching import DwellTime, Switching, check_names

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
    design: DesignSpec = Field(default_factory=DesignSpec, description="how gains are written down")
    coordinates: Literal["deflection", "force"] = Field(
        default="deflection",
        description="state of the contact: deflection stays continuous when the stiffness "
        "switches; force is what the thesis uses",
    )
    switching: Switching = Field(
        description="when controllers change: arbitrary, or rules with dwell_time and transitions "
        "between controllers"
    )
    certification: CertificationSpec = Field(
        default_factory=CertificationSpec, description="how far the search for a proof goes"
    )

    @model_validator(mode="after")
    def _check_controllers(self) -> InteractionDesignSpec:
        _check_mixture(self.controllers)
        for name, controller in self.controllers.items():
            if not isinstance(controller, PositionControllerSpec):
                _check_references(name, controller, self.environments)
        check_names(self.switching, self.controllers, "controller")
        for at, dwell in self.switching.dwell_times():
            _check_dwell_time(dwell, self, ("switching", *at))
        return self


def _check_mixture(controllers: dict[str, ControllerSpec]) -> None:
    """Impedance loops and position/force loops have different states."""
    first_name, first = next(iter(controllers.items()))
    for name, controller in controllers.items():
        if (controller.type == "impedance") != (first.type == "impedance"):
            raise fault(
                f"{controller.type} is mixed with {first.type} ({first_name!r}): their loops have "
                "different states",
                "use impedance controllers only, or position and force controllers only",
                "controllers",
                name,
                "type",
            )


def _check_references(
    name: str,
    controller: ImpedanceControllerSpec | ForceControllerSpec,
    environments: dict[str, EnvironmentSpec],
) -> None:
    places: list[tuple[str, tuple[str | int, ...]]] = [(controller.environment, ("environment",))]
    places += [(contact, ("contacts", i)) for i, contact in enumerate(controller.contacts)]
    for environment, at in places:
        if environment not in environments:
            raise fault(
                f"there is no environment {environment!r}",
                did_you_mean(environment, environments),
                "controllers",
                name,
                *at,
            )


def _check_dwell_time(dwell: DwellTime, spec: InteractionDesignSpec, at: tuple[str, ...]) -> None:
    """Check that nothing changes during a dwell time: the environment obeys no rule of ours."""
    if dwell.unit != "s":
        raise fault(f"{dwell.text!r} is not a time", "write seconds, such as '2.76 s'", *at)
    for name, controller in spec.controllers.items():
        contacts = () if isinstance(controller, PositionControllerSpec) else controller.contacts
        if len(contacts) > 1:
            raise fault(
                f"a dwell time and several contacts of {name!r} exclude each other: the contact "
                "may change at any time, whatever the controller",
                f"leave {at[1]} out, or write a spec for each environment",
                *at,
            )
        if isinstance(controller, ImpedanceControllerSpec):
            _check_constant_gains(name, controller, at)
        for contact in contacts:
            if not spec.environments[contact].fixed:
                raise fault(
                    f"a dwell time and the range of environment {contact!r} exclude each other: "
                    "its parameters may move during the dwell time, and the proof would not hold",
                    f"leave {at[1]} out, or give the environment its nominal values only",
                    *at,
                )


def _check_constant_gains(
    name: str, controller: ImpedanceControllerSpec, at: tuple[str, ...]
) -> None:
    for gain in ("Mt", "Bt"):
        if getattr(controller, gain).ranged:
            raise fault(
                f"a dwell time and the range of {gain} of {name!r} exclude each other: the gain "
                "may move during the dwell time, and the proof would not hold",
                f"leave {at[1]} out, or give the gain one value only",
                *at,
            )
