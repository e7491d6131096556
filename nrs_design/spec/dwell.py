"""What no dwell time can hold still: whoever claims a dwell time must ask here first.

A proof with a dwell time rests on one constant matrix from each switch to the next.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nrs_design.spec.controllers import ControllerSpec
    from nrs_design.spec.environment import EnvironmentSpec
    from nrs_design.spec.motion import ActuatorSpec
    from nrs_design.spec.parameters import ParameterSpec


@dataclass(frozen=True, slots=True)
class DwellObstacle:
    """Why a spec and a dwell time exclude each other, and what to change in the spec."""

    message: str
    remedy: str


def find_changing_parameter(parameters: Mapping[str, ParameterSpec]) -> DwellObstacle | None:
    """Find a parameter of given matrices that is not known."""
    for name, parameter in parameters.items():
        if not parameter.fixed:
            return DwellObstacle(
                f"a dwell time and the range of parameter {name!r} exclude each other: the proof "
                "with a dwell time holds for constant matrices only",
                "give the parameter its nominal value only",
            )
    return None


def find_changing_contact(
    actuator: ActuatorSpec,
    controllers: Mapping[str, ControllerSpec],
    environments: Mapping[str, EnvironmentSpec],
    *,
    by_contact: bool = False,
) -> DwellObstacle | None:
    """Find what changes while one controller is active: the environment obeys no rule of ours.

    Parameters
    ----------
    actuator : ActuatorSpec
        The motor.
    controllers, environments : mapping
        By name.
    by_contact : bool
        The rules of switching are about the environment that is touched, too.
    """
    # A spec of given matrices has no controllers, and does not pay for their models.
    from nrs_design.spec.controllers import touched_in

    if not (actuator.gain.fixed and actuator.time_constant.fixed):
        return DwellObstacle(
            "a dwell time and a range of the actuator exclude each other: the motor may change "
            "during the dwell time, and the proof would not hold",
            "give the actuator its nominal values only",
        )
    for name, controller in controllers.items():
        if len(controller.contacts) > 1 and not by_contact:
            return DwellObstacle(
                f"a dwell time and several contacts of {name!r} exclude each other: the contact "
                "may change at any time, whatever the controller",
                "write a spec for each environment",
            )
        for contact in controller.contacts:
            if not isinstance(contact, str):
                return DwellObstacle(
                    f"a dwell time and several things that {name!r} touches at once exclude each "
                    "other: one of them may be lost at any time",
                    "write a spec for each environment",
                )
        for gain, declared in controller.gains().items():
            if declared.ranged:
                return DwellObstacle(
                    f"a dwell time and the range of {gain} of {name!r} exclude each other: "
                    "the gain may move during the dwell time, and the proof would not hold",
                    "give the gain one value only",
                )
        for touched in touched_in(controller.contacts):
            if not environments[touched].fixed:
                return DwellObstacle(
                    f"a dwell time and the range of environment {touched!r} exclude each other: "
                    "its parameters may move during the dwell time, and the proof would not hold",
                    "give the environment its nominal values only",
                )
    return None
