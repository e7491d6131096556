"""Design goals: what a design must achieve beside being stable.

Goals for a frequency response over a band: what is felt, and how well the tool follows.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Annotated, ClassVar

from pydantic import AfterValidator

from nrs_design.proof.text import exact_text
from nrs_design.spec import kinds
from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import AboveOne, BelowTwo, Label, UnitFraction
from nrs_design.spec.model import ParsedBy, SpecModel, at_most, optional, pair_schema, required
from nrs_design.spec.quantity import Quantity, is_less
from nrs_design.spec.quantity_fields import quantity_schema, read_quantity

_BAND_FORM = "write [lowest, highest], such as `[0 Hz, 2 Hz]`"


def _read_band(value: object) -> tuple[Quantity, Quantity]:
    """Read the lowest and the highest frequency."""
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise fault("expected two frequencies", _BAND_FORM)
    low, high = (
        read_quantity(end, kinds.BANDWIDTH, i, positive=bool(i)) for i, end in enumerate(value)
    )
    return low, high


Band = Annotated[
    tuple[Quantity, Quantity], ParsedBy(_read_band, pair_schema(quantity_schema(kinds.BANDWIDTH)))
]
_BAND = "[lowest, highest] frequency, such as [0 Hz, 2 Hz]; sampled, below half the sampling rate"
_ORDERED = Row[SpecModel](
    "band",
    lambda s: not is_less(*s.band) and tuple(end.text for end in s.band[::-1]),  # type: ignore[attr-defined]
    "the band ends at {0!r}, not above its start {1!r}",
    _BAND_FORM,
)


class TransparencySpec(SpecModel, stronger="smaller"):
    """How little the surgeon shall feel of the robot, in free motion."""

    max_impedance: field.Impedance = required("largest force over velocity of the tool, N*m*s/rad")
    band: Band = required(_BAND, "wider")
    environment: ClassVar[str | None] = None  # Nothing is touched

    checks = (_ORDERED,)

    @property
    def limit(self) -> Fraction:
        """The largest impedance in N m s/rad."""
        return self.max_impedance.exact

    @property
    def limit_text(self) -> str:
        """The largest impedance as it is written."""
        return self.max_impedance.text


class AccuracySpec(SpecModel, stronger="smaller"):
    """How well the tool shall follow the commanded velocity."""

    max_error: UnitFraction = required("largest |1 - V/Vcmd|, between 0 and 1, no unit")
    band: Band = required(_BAND, "wider")
    environment: Label | None = optional(
        "touched elastic or Kelvin-Voigt environment; default: nothing",
        stronger="unknown",
        unsaid="other",
    )

    checks = (_ORDERED,)

    @property
    def limit(self) -> Fraction:
        """The largest share."""
        return self.max_error

    @property
    def limit_text(self) -> str:
        """The largest share as a number."""
        return exact_text(self.max_error)


# What only one type of controller has.
ONLY_FOR = {
    "max_impedance_error": "impedance",
    "min_transparency": "impedance",
    "max_hand_effort": "impedance",
    "max_creep": "impedance",
    "max_creep_angle": "impedance",
    "transparency": "impedance",
    "accuracy": "impedance",
    "max_force_error": "force",
}
# What a certificate must show, for all controllers together.
OF_THE_CERTIFICATE = frozenset({"peak_torque", "decay_rate", "delay", "initial_force"})
# A goal for a frequency response, decided by an enclosure of it over all ranges.
ResponseGoal = TransparencySpec | AccuracySpec


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
        "smallest |L/(1 + L)| up to the bandwidth, in (0, 1): robot over hand motion"
    )
    max_hand_effort: field.Impedance | None = at_most(
        "largest |Ze/(1 + L)| up to the bandwidth in N*m*s/rad: hand torque over velocity"
    )
    max_creep: field.AngularVelocity | None = at_most(
        "largest velocity in free motion by errors of the sensor, such as 0.5 deg/s; impedance only"
    )
    max_creep_angle: field.Angle | None = at_most(
        "largest angle in free motion by errors of the sensor, such as 2 deg; with a spring Kt"
    )
    transparency: TransparencySpec | None = optional(
        "proved: impedance of the robot in free motion over a band; impedance controllers only"
    )
    accuracy: AccuracySpec | None = optional(
        "proved: error of the tool velocity over a band; impedance controllers only"
    )
    max_force_error: UnitFraction | None = at_most("largest steady force error, a share in (0, 1)")
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

    def given(self) -> Iterator[tuple[str, Quantity | Fraction | str | ResponseGoal]]:
        """Yield the goals that are set, by key."""
        return ((key, value) for key, value in self if value is not None)
