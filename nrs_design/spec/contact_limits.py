"""What contact with a person may do to a region of the body."""

from __future__ import annotations

from pydantic import Field

from nrs_design.spec.check import Row
from nrs_design.spec.fields import Label, Positive, Title
from nrs_design.spec.model import SpecModel, optional
from nrs_design.spec.quantity_fields import (
    Area,
    EffectiveMass,
    Energy,
    Force,
    LengthBounds,
    LinearStiffness,
    LinearVelocity,
    Pressure,
)

# What contact that lasts is judged by, and an impact.
LASTING = ("quasi_static_force", "quasi_static_pressure")
PRESSURES = ("quasi_static_pressure", "transient_pressure")
IMPACT = ("transient_force", "transient_pressure", "energy", "hic")
CONTACT_LIMITS = ("quasi_static_force", "quasi_static_pressure", *IMPACT, "speed")
_MASSES = ("robot_mass", "body_mass")


class ContactLimitSpec(SpecModel):
    """Limits of one region of the body; numbers are the user's, with the table they are from.

    The quantities are those of ISO/TS 15066:2016 and ISO 10218-2:2025, Annex A.
    """

    name: Label = Field(description="the region of the body, such as back-of-hand")
    source: Title = Field(
        description="where the numbers are from, such as ISO/TS 15066:2016, tables A.2 and A.3"
    )
    lever_arm: LengthBounds = Field(
        description="distance in m from the pivot to where the region is touched: one, or "
        "{min: ..., max: ...}; forces are taken at the smallest, speeds at the largest"
    )
    environment: Label | None = optional(
        "the environment that holds how the region yields in contact that lasts; its force is "
        "what is bounded"
    )
    quasi_static_force: Force | None = optional("largest force of lasting contact in N")
    quasi_static_pressure: Pressure | None = optional(
        "largest pressure of lasting contact, such as 190 N/cm^2; with contact_area"
    )
    transient_force: Force | None = optional("largest force of an impact in N")
    transient_pressure: Pressure | None = optional(
        "largest pressure of an impact, such as 380 N/cm^2; with contact_area"
    )
    contact_area: Area | None = optional("smallest area of contact, such as 1 cm^2")
    energy: Energy | None = optional("largest energy that an impact transfers in J")
    hic: Positive | None = optional(
        "largest head injury criterion of an impact, accelerations in units of gravity, no unit"
    )
    speed: LinearVelocity | None = optional(
        "largest speed between robot and region in m/s, where it is limited by itself"
    )
    robot_mass: EffectiveMass | None = optional(
        "effective mass of the robot where it is touched in kg, payload included"
    )
    body_mass: EffectiveMass | None = optional("effective mass of the region in kg")
    stiffness: LinearStiffness | None = optional(
        "effective stiffness of the region, or of what covers the robot there, such as 75 N/mm"
    )
    body_speed: LinearVelocity | None = optional(
        "largest speed at which the region itself moves towards the robot in m/s; default: it rests"
    )

    def _given(self, keys: tuple[str, ...]) -> str | None:
        return next((key for key in keys if getattr(self, key) is not None), None)

    def _lacks(self, keys: tuple[str, ...], needed: tuple[str, ...]) -> tuple[str, str] | None:
        """Return a limit that is given, and what it needs and lacks."""
        limit = self._given(keys)
        lacking = next((key for key in needed if getattr(self, key) is None), None)
        return None if limit is None or lacking is None else (limit, lacking)

    checks = (
        Row(
            "source",
            lambda s: not s.source.strip(),
            "nothing says where the limits are from",
            "name the standard and its table, or who has decided",
        ),
        Row(
            "",
            lambda s: s._given(CONTACT_LIMITS) is None,
            "no limit of the region {s.name!r} is given",
            "add one, with its source, such as `transient_force: 280 N`",
        ),
        Row(
            "{0}",
            lambda s: s._lacks(PRESSURES, ("contact_area",)),
            "{0} is given without an area",
            "add `contact_area: 1 cm^2`, the smallest that the robot touches with",
        ),
        Row(
            "contact_area",
            lambda s: s.contact_area is not None and s._given(PRESSURES) is None,
            "there is no pressure that the area is for",
            "add transient_pressure or quasi_static_pressure, or remove contact_area",
        ),
        Row(
            "{0}",
            lambda s: s._lacks(LASTING, ("environment",)),
            "{0} is given, and no {1} says how the region yields",
            "add `environment: NAME` with one of the environments that are proved, whose ranges "
            "hold the stiffness of the region",
        ),
        Row(
            "{0}",
            lambda s: s._lacks(IMPACT, _MASSES),
            "{0} is given without {1}",
            "add `{1}: 0.6 kg`: an impact is that of two masses",
        ),
        Row(
            "{0}",
            lambda s: s._lacks(("transient_force", "transient_pressure", "hic"), ("stiffness",)),
            "{0} is given without {1}",
            "add `stiffness: 75 N/mm`: an impact is that of two masses and a spring",
        ),
    )
