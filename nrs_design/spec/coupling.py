"""What the axes of a robot do to each other: as declared, or as computed from a robot."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, PrivateAttr, model_validator

from nrs_design.spec.faults import fault
from nrs_design.spec.fields import AxisCount, Title
from nrs_design.spec.model import SpecModel
from nrs_design.spec.quantity import is_less
from nrs_design.spec.quantity_fields import (
    AngularVelocity,
    Impedance,
    MomentOfInertia,
    RotationalStiffness,
)
from nrs_design.spec.robot_bounds import RobotBounds


class CouplingSpec(SpecModel):
    """Bounds on what the links of the robot do to each axis: declared, or those of a robot spec."""

    robot: Title | None = Field(
        default=None,
        description="spec of the robot, relative to this file; `nrs-design robot bounds` has "
        "computed the bounds, and they are read instead of inertia, coriolis and gravity_gradient",
    )
    gravity_compensated: Literal["everywhere", "at-rest"] | None = Field(
        default=None,
        description="with robot: gravity is compensated in every pose (default), or in the pose of "
        "rest only, for kept contact",
    )
    inertia: tuple[MomentOfInertia, MomentOfInertia] | None = Field(
        default=None,
        description="[lowest, highest] eigenvalue of the matrix of inertia of the links at the "
        "joints in kg*m^2, over all poses that are used; required without robot",
    )
    coriolis: Impedance | None = Field(
        default=None,
        description="largest ratio of Coriolis and centrifugal torques to the joint speeds (both "
        "over all axes) in N*m*s/rad, up to `speed`; default: they are left out",
    )
    speed: AngularVelocity | None = Field(
        default=None,
        description="speed over all axes in rad/s up to which coriolis holds; with robot: up to "
        "which Coriolis torques are counted in, else they are left out",
    )
    gravity_gradient: RotationalStiffness | None = Field(
        default=None,
        description="largest norm of the gradient of the torques of gravity in N*m/rad, for kept "
        "contact; default: gravity is compensated, or the same, in all poses",
    )

    axes: AxisCount | None = Field(
        default=None,
        description="how many axes there are, for bounds under disturbances; a robot has three",
    )

    _bounds: RobotBounds | None = PrivateAttr(default=None)

    @property
    def bounds(self) -> RobotBounds | None:
        """Those of the robot, as far as the spec has been read from its file."""
        return self._bounds

    def bounded(self, bounds: RobotBounds) -> CouplingSpec:
        """Return the same with the bounds of its robot."""
        copy = self.model_copy()
        copy._bounds = bounds
        return copy

    @model_validator(mode="after")
    def _check(self) -> CouplingSpec:
        if self.robot is not None:
            self._check_computed()
            return self
        if self.gravity_compensated is not None:
            raise fault(
                "gravity_compensated is for the bounds of a robot",
                "add robot, or remove gravity_compensated",
                "gravity_compensated",
            )
        if self.inertia is None:
            raise fault(
                "neither robot nor inertia is given",
                "write `robot: arm.nrs.yaml`, or `inertia: [0.003 kg*m^2, 0.3 kg*m^2]`",
            )
        low, high = self.inertia
        if is_less(high, low):
            raise fault(
                f"the range of inertia ends at {high.text!r}, below its start {low.text!r}",
                "write [lowest, highest]",
                "inertia",
            )
        if (self.coriolis is None) != (self.speed is None):
            missing = "speed" if self.speed is None else "coriolis"
            raise fault(
                "coriolis and speed belong together: Coriolis torques grow with the speed",
                f"add {missing}, or remove the other",
                missing,
            )
        return self

    def _check_computed(self) -> None:
        """Refuse to declare what is computed."""
        for key in ("inertia", "coriolis", "gravity_gradient", "axes"):
            if getattr(self, key) is not None:
                raise fault(
                    f"{key} is that of the robot, and declared as well",
                    f"remove {key} or robot",
                    key,
                )


def check_coupling(
    coupling: CouplingSpec | None, *, loaded: bool, disturbed: bool, deflection: bool
) -> None:
    """Refuse a coupling of axes beside what it is not modelled with.

    Parameters
    ----------
    coupling : CouplingSpec or None
        Where the spec has one.
    loaded : bool
        Whether the actuator has a load_inertia.
    disturbed : bool
        Whether the spec has disturbances.
    deflection : bool
        Whether the coordinates are those of the deflection.
    """
    if coupling is None:
        return
    if disturbed and coupling.robot is None and coupling.axes is None:
        raise fault(
            "a bound under disturbances depends on the number of axes, which is not given",
            "add `axes: 3`, or remove disturbances",
            "coupling",
            "axes",
        )
    if not loaded:
        raise fault(
            "axes act on each other against the inertia of the drives, which is not given",
            "add `load_inertia: 1.213 kg*m^2` to actuator, or remove coupling",
            "coupling",
        )
    if not deflection:
        raise fault(
            "axes that act on each other are not modelled in force coordinates",
            "use `coordinates: deflection`, or remove coupling",
            "coupling",
        )
