"""Design goals, which a design must achieve beside stability."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Annotated

from pydantic import AfterValidator

from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import AboveOne, BelowTwo, UnitFraction
from nrs_design.spec.model import SpecModel, at_most, optional
from nrs_design.spec.quantity import Quantity

# Goals of one type of controller alone.
ONLY_FOR = {
    "max_impedance_error": "impedance",
    "min_transparency": "impedance",
    "max_hand_effort": "impedance",
    "max_creep": "impedance",
    "max_creep_angle": "impedance",
    "max_force_error": "force",
}
# What a certificate must show, for all controllers together.
OF_THE_CERTIFICATE = frozenset({"peak_torque", "decay_rate", "delay", "initial_force"})


def _below_half_turn(angle: Quantity) -> Quantity:
    if angle.si >= math.pi:
        raise fault(f"{angle.text!r} is out of reach", "write a phase margin below 180 deg")
    return angle


class GoalsSpec(SpecModel, stronger="larger"):
    """Goals of the design; docs/design/goals.md defines each, and where it is evaluated."""

    max_sensitivity_peak: AboveOne | None = at_most("largest Ms = max |1/(1 + L)|, above 1")
    min_gain_margin: AboveOne | None = optional("smallest gain margin, a factor above 1")
    min_phase_margin: Annotated[field.Phase, AfterValidator(_below_half_turn)] | None = optional(
        "smallest phase margin, such as 30 deg"
    )
    min_delay_margin: field.Duration | None = optional("smallest delay margin, such as 5 ms")
    min_disk_margin: BelowTwo | None = optional("smallest balanced disk margin, between 0 and 2")
    max_impedance_error: AboveOne | None = at_most(
        "largest displayed over desired impedance, or reverse, up to the bandwidth, above 1"
    )
    min_transparency: UnitFraction | None = optional(
        "smallest |L/(1 + L)| up to the bandwidth, in (0, 1): robot over hand motion; at a hand"
    )
    max_hand_effort: field.Impedance | None = at_most(
        "largest |Ze/(1 + L)| up to the bandwidth, N*m*s/rad: hand torque over velocity; at a hand"
    )
    max_creep: field.AngularVelocity | None = at_most(
        "largest velocity in free motion by errors of the sensor, such as 0.5 deg/s; impedance only"
    )
    max_creep_angle: field.Angle | None = at_most(
        "largest angle in free motion by errors of the sensor, such as 2 deg; with a spring Kt"
    )
    max_force_error: UnitFraction | None = at_most(
        "largest steady force error over the commanded force, in (0, 1)"
    )
    peak_torque: field.Torque | None = at_most("largest proved torque in N*m; of the whole spec")
    decay_rate: field.DecayRate | None = optional("smallest proved decay rate in 1/s; of the spec")
    delay: field.Duration | None = optional(
        "age of force samples to be proved, such as 4 ms; of the spec, with sampling"
    )
    initial_force: field.TorqueOrLargest | None = optional(
        "contact force in N*m from which, at rest, every motion must be proved to decay while "
        "commands saturate at their limits; largest: as large as is found; of the spec, with "
        "`limits: command`"
    )

    checks = (
        Row(
            "",
            lambda s: not dict(s.given()),
            "no goal is given",
            "add one, such as `max_sensitivity_peak: 2`",
        ),
    )

    def given(self) -> Iterator[tuple[str, Quantity | Fraction | str]]:
        """Yield the goals that are set, by key."""
        return ((key, value) for key, value in self if value is not None)
