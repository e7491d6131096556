"""What the axes of a robot do to each other: as declared, or as computed from a robot."""

from __future__ import annotations

from typing import Literal

from pydantic import PrivateAttr

from nrs_design.proof.text import exact_text
from nrs_design.spec.arm import ArmSpec
from nrs_design.spec.check import Row
from nrs_design.spec.fields import AxisCount, Positive, Title
from nrs_design.spec.model import SpecModel, optional
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

    robot: Title | None = optional(
        "spec of the robot, relative to this file; `nrs-design robot bounds` has "
        "computed the bounds, and they are read instead of inertia, coriolis and gravity_gradient"
    )
    gravity_compensated: Literal["everywhere", "at-rest"] | None = optional(
        "with robot: gravity is compensated in every pose (default), or in the pose of "
        "rest only, for kept contact"
    )
    inertia: tuple[MomentOfInertia, MomentOfInertia] | None = optional(
        "[lowest, highest] eigenvalue of the matrix of inertia of the links at the "
        "joints in kg*m^2, over all poses that are used; required without robot"
    )
    coriolis: Impedance | None = optional(
        "largest ratio of Coriolis and centrifugal torques to the joint speeds (both "
        "over all axes) in N*m*s/rad, up to `speed`; default: they are left out"
    )
    speed: AngularVelocity | None = optional(
        "speed over all axes in rad/s up to which coriolis holds; with robot: up to "
        "which Coriolis torques are counted in, else they are left out"
    )
    gravity_gradient: RotationalStiffness | None = optional(
        "largest norm of the gradient of the torques of gravity in N*m/rad, for kept "
        "contact; default: gravity is compensated, or the same, in all poses"
    )

    mobility: tuple[Positive, Positive] | None = optional(
        "[lowest, highest] eigenvalue of J^(1/2) Lambda^-1 J^(1/2), no unit: J the inertias that "
        "the axes are given, Lambda the inertia of the arm in the task space, over all poses that "
        "are used; for a torque_interface, in the place of everything else here"
    )
    arm: ArmSpec | None = optional(
        "the arm that the mobility is of: `nrs-design robot mobility` and the gate compute it"
    )
    axes: AxisCount | None = optional(
        "how many axes there are, for bounds under disturbances; a robot has three"
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

    @property
    def source(self) -> str:
        """Where the mobility comes from."""
        if self.arm is None:
            return "declared, not computed from a robot"
        poses = ", ".join(
            f"{name} {low.text}" + ("" if high == low else f" .. {high.text}")
            for name, (low, high) in self.arm.joints.items()
        )
        return (
            f"on trust as that of the link {self.arm.tip} of {self.arm.model}, its inertias those "
            f"of the file, with the joints at {poses}; `nrs-design robot mobility` and "
            "`nrs-design gate` compute it"
        )

    def _beside_mobility(self) -> str | None:
        """Return what is said besides the mobility."""
        said = self.model_fields_set - {"mobility", "arm"}
        return next(iter(sorted(said)), None) if self.mobility is not None else None

    def _turned(self) -> tuple[str, str] | None:
        """Return the ends of the mobility, if the highest is below the lowest."""
        if self.mobility is None or self.mobility[0] <= self.mobility[1]:
            return None
        low, high = map(exact_text, self.mobility)
        return high, low

    def _doubly(self) -> str | None:
        """Return what is declared although it is computed from the robot."""
        keys = ("inertia", "coriolis", "gravity_gradient", "axes") if self.robot is not None else ()
        return next((key for key in keys if getattr(self, key) is not None), None)

    def _reversed(self) -> tuple[str, str] | None:
        """Return the ends of the range of inertia, if the highest is below the lowest."""
        if self.inertia is None or not is_less(self.inertia[1], self.inertia[0]):
            return None
        return self.inertia[1].text, self.inertia[0].text

    def _half(self) -> str | None:
        """Which of two that belong together is missing."""
        if self.inertia is None or (self.coriolis is None) == (self.speed is None):
            return None
        return "speed" if self.speed is None else "coriolis"

    checks = (
        Row(
            "{0}",
            _doubly,
            "{0} is that of the robot, and declared as well",
            "remove {0} or robot",
        ),
        Row(
            "gravity_compensated",
            lambda s: s.robot is None and s.gravity_compensated,
            "gravity_compensated is for the bounds of a robot",
            "add robot, or remove gravity_compensated",
        ),
        Row(
            "",
            lambda s: (
                s.robot is None
                and s.inertia is None
                and s.gravity_compensated is None
                and s.mobility is None
            ),
            "neither robot nor inertia is given",
            "write `robot: arm.nrs.yaml`, or `inertia: [0.003 kg*m^2, 0.3 kg*m^2]`; of an arm that "
            "takes torques, `mobility: [0.8, 1.2]`",
        ),
        Row(
            "{0}",
            _beside_mobility,
            "{0} is for axes with a motor, and mobility for an arm that takes torques",
            "remove {0} or mobility",
        ),
        Row(
            "arm",
            lambda s: s.arm is not None and s.mobility is None,
            "an arm is given, and no mobility",
            "run `nrs-design robot mobility` for it, and write `mobility: [lowest, highest]`",
        ),
        Row(
            "mobility",
            _turned,
            "the range of mobility ends at {0!r}, below its start {1!r}",
            "write [lowest, highest]",
        ),
        Row(
            "inertia",
            _reversed,
            "the range of inertia ends at {0!r}, below its start {1!r}",
            "write [lowest, highest]",
        ),
        Row(
            "{0}",
            _half,
            "coriolis and speed belong together: Coriolis torques grow with the speed",
            "add {0}, or remove the other",
        ),
    )
