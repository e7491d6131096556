"""What the axes of a robot do to each other, as declared."""

from __future__ import annotations

from pydantic import Field, model_validator

from nrs_design.spec.faults import fault
from nrs_design.spec.model import SpecModel
from nrs_design.spec.quantity import is_less
from nrs_design.spec.quantity_fields import (
    AngularVelocity,
    Impedance,
    MomentOfInertia,
    RotationalStiffness,
)


class CouplingSpec(SpecModel):
    """Bounds on what the links of the robot do to each axis; declared, so they are assumptions."""

    inertia: tuple[MomentOfInertia, MomentOfInertia] = Field(
        description="[lowest, highest] eigenvalue of the matrix of inertia of the links at the "
        "joints in kg*m^2, over all poses that are used"
    )
    coriolis: Impedance | None = Field(
        default=None,
        description="largest ratio of Coriolis and centrifugal torques to the joint speeds (both "
        "over all axes) in N*m*s/rad, up to `speed`; default: they are left out",
    )
    speed: AngularVelocity | None = Field(
        default=None, description="speed over all axes in rad/s up to which coriolis holds"
    )
    gravity_gradient: RotationalStiffness | None = Field(
        default=None,
        description="largest norm of the gradient of the torques of gravity in N*m/rad, for kept "
        "contact; default: gravity is compensated, or the same, in all poses",
    )

    @model_validator(mode="after")
    def _check(self) -> CouplingSpec:
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


def check_coupling(
    coupling: CouplingSpec | None, *, loaded: bool, others: tuple[str, ...], deflection: bool
) -> None:
    """Refuse a coupling of axes beside what it is not modelled with.

    Parameters
    ----------
    coupling : CouplingSpec or None
        Where the spec has one.
    loaded : bool
        Whether the actuator has a load_inertia.
    others : tuple of str
        Sections of the spec that exclude it.
    deflection : bool
        Whether the coordinates are those of the deflection.
    """
    if coupling is None:
        return
    if others:
        raise fault(
            f"axes that act on each other are not modelled with {others[0]}",
            f"remove coupling or {others[0]}",
            "coupling",
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
