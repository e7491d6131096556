"""Environments that the robot touches, and what their linear stiffness is at the pivot."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Literal

from pydantic import Discriminator, Field, model_validator

from nrs_design.spec import kinds
from nrs_design.spec.faults import fault
from nrs_design.spec.model import SpecModel
from nrs_design.spec.provenance import PROVENANCE, Provenance
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.quantity_fields import Damping, LeverArm, RangedQuantity, Stiffness

_LEVER_ARM = (
    "distance from the pivot to the contact point, a length in m; required if stiffness or damping "
    "are linear (N/m, N*s/m), forbidden otherwise"
)
_STIFFNESS = (
    "stiffness at the pivot in N*m/rad, or at the contact point in N/m with lever_arm; one "
    "quantity, or {nominal: ..., range: [lowest, highest]}"
)
_DAMPING = (
    "damping at the pivot in N*m*s/rad, or at the contact point in N*s/m with lever_arm; one "
    "quantity, or {nominal: ..., range: [lowest, highest]}"
)


class ElasticSpec(SpecModel):
    """Elastic environment, ``F = k delta`` (thesis 2.5)."""

    model: Literal["elastic"] = Field(description="law of the environment: elastic, F = k delta")
    stiffness: Stiffness = Field(description=_STIFFNESS)
    lever_arm: LeverArm | None = Field(default=None, description=_LEVER_ARM)
    provenance: Provenance = Field(default=(), description=PROVENANCE)

    @model_validator(mode="after")
    def _check_lever_arm(self) -> ElasticSpec:
        _check_arm(self.stiffness, "stiffness", self.lever_arm)
        return self

    @property
    def fixed(self) -> bool:
        """Whether every parameter has a single value."""
        return self.stiffness.fixed

    @property
    def rotational_stiffness(self) -> RangedQuantity:
        """Stiffness at the pivot, in N*m/rad: ``k r^2`` for a linear one."""
        return at_pivot(self.stiffness, self.lever_arm, "N*m/rad")


class KelvinVoigtSpec(SpecModel):
    """Kelvin-Voigt environment, ``F = k delta + b ddelta`` (thesis 2.5)."""

    model: Literal["kelvin-voigt"] = Field(
        description="law of the environment: kelvin-voigt, F = k delta + b ddelta/dt"
    )
    stiffness: Stiffness = Field(description=_STIFFNESS)
    damping: Damping = Field(description=_DAMPING)
    lever_arm: LeverArm | None = Field(default=None, description=_LEVER_ARM)
    provenance: Provenance = Field(default=(), description=PROVENANCE)

    @model_validator(mode="after")
    def _check_lever_arm(self) -> KelvinVoigtSpec:
        _check_arm(self.stiffness, "stiffness", self.lever_arm)
        _check_arm(self.damping, "damping", self.lever_arm)
        return self

    @property
    def fixed(self) -> bool:
        """Whether every parameter has a single value."""
        return self.stiffness.fixed and self.damping.fixed

    @property
    def rotational_stiffness(self) -> RangedQuantity:
        """Stiffness at the pivot, in N*m/rad: ``k r^2`` for a linear one."""
        return at_pivot(self.stiffness, self.lever_arm, "N*m/rad")

    @property
    def rotational_damping(self) -> RangedQuantity:
        """Damping at the pivot, in N*m*s/rad: ``b r^2`` for a linear one."""
        return at_pivot(self.damping, self.lever_arm, "N*m*s/rad")


EnvironmentSpec = Annotated[ElasticSpec | KelvinVoigtSpec, Discriminator("model")]


def is_linear(quantity: Quantity) -> bool:
    """Whether a stiffness or damping is one at the contact point (N/m, N*s/m)."""
    return any(
        kind.accepts(quantity.dimension) for kind in (kinds.LINEAR_STIFFNESS, kinds.LINEAR_DAMPING)
    )


def _check_arm(quantity: RangedQuantity, name: str, arm: Quantity | None) -> None:
    if is_linear(quantity.nominal) and arm is None:
        raise fault(
            f"{quantity.nominal.text!r} is linear, and there is no lever_arm",
            "add `lever_arm: 0.24 m` (the distance from the pivot to the contact point) or write "
            "the rotational value per rad",
            name,
        )
    if arm is not None and not is_linear(quantity.nominal):
        raise fault(
            f"{quantity.nominal.text!r} is rotational, and a lever_arm is given",
            "remove lever_arm, or write the linear value (N/m, N*s/m)",
            name,
        )


def at_pivot(quantity: RangedQuantity, arm: Quantity | None, unit: str) -> RangedQuantity:
    """Convert a linear stiffness or damping to the pivot, exactly.

    Parameters
    ----------
    quantity : RangedQuantity
        In N/m or N*s/m if there is a lever arm; returned unchanged otherwise.
    arm : Quantity or None
        Distance ``r`` from the pivot to the contact point.
    unit : str
        Unit of the result, N*m/rad or N*m*s/rad.

    Returns
    -------
    RangedQuantity
        Each value times ``r^2`` (thesis 6.3.1: 747.1461 N/m at 0.24 m is 43.0356 N*m/rad).
    """
    if arm is None:
        return quantity
    low, high = quantity.range
    return RangedQuantity(
        nominal=_turned(quantity.nominal, arm.exact, unit),
        range=(_turned(low, arm.exact, unit), _turned(high, arm.exact, unit)),
    )


def _turned(linear: Quantity, radius: Fraction, unit: str) -> Quantity:
    value = linear.exact * radius**2
    return Quantity(f"{float(value):.6g} {unit}", value, unit)
