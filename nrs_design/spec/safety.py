"""What a safety layer below the controllers keeps, whatever they command."""

from __future__ import annotations

from pydantic import Field

from nrs_design.spec.check import Row
from nrs_design.spec.model import SpecModel, optional
from nrs_design.spec.quantity import is_less
from nrs_design.spec.quantity_fields import (
    AngularVelocity,
    Energy,
    Impedance,
    Power,
    RotationalStiffness,
    Torque,
)


class SafetySpec(SpecModel):
    """Limits of the reference of the motion loop, and the tissue that they are proved for."""

    speed: AngularVelocity = Field(description="largest speed of the reference in rad/s")
    torque: Torque = Field(
        description="measured torque in N*m beyond which the reference moves no further into "
        "contact"
    )
    energy: Energy = Field(
        description="largest work of the reference against the measured torque in J; a step that "
        "would exceed it is not made"
    )
    power: Power | None = optional(
        "what is given back of the energy in W, as tissue that takes energy needs; default: only "
        "what the motion gives back"
    )
    stiffness: tuple[RotationalStiffness, RotationalStiffness] = Field(
        description="[lowest, highest] torque over deflection in N*m/rad, of whatever is touched: "
        "a wider range than that of the environments"
    )
    damping: Impedance | None = optional(
        "largest torque over rate of the deflection in N*m*s/rad, of whatever is touched; default: "
        "it does not damp"
    )

    checks = (
        Row(
            "stiffness",
            lambda s: is_less(s.stiffness[1], s.stiffness[0]) and s.stiffness[1].text,
            "the range of stiffness ends at {0!r}, below its start",
            "write [lowest, highest]",
        ),
    )
