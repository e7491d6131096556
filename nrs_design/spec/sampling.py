"""The processor of an interaction design: when the law runs, and how old its force sample is."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Annotated, Literal

from nrs_design.proof.text import exact_text
from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import read_exact
from nrs_design.spec.misses import DeadlinesSpec
from nrs_design.spec.model import ParsedBy, SpecModel, optional, pair_schema, required
from nrs_design.spec.provenance import IdentifiedSpec
from nrs_design.spec.quantity_fields import ends_of
from nrs_design.spec.units import command_unit

# Every sample of delay is a state more.
LONGEST_DELAY = 10
# There is a function for every sample of the faster loop in a period of the slower one.
LARGEST_RATIO = 50
_TIME = re.compile(r"\S+ *[mun]?s")
_FORM = f"write a number of samples from 0 to {LONGEST_DELAY}, or [smallest, largest]"


def _read_delay(value: object) -> tuple[int, int]:
    """Read one number of samples, or the smallest and the largest."""
    ends = tuple(value) if isinstance(value, tuple | list) else (value, value)
    if len(ends) != 2:
        raise fault("expected a number of samples, or two of them", _FORM)
    for end in ends:
        if isinstance(end, str) and _TIME.fullmatch(end):
            raise fault(
                f"{end!r} is a time, and a delay counts samples", f"{_FORM}: age over period"
            )
    numbers = [read_exact(end) for end in ends]
    for number in numbers:
        if number.denominator != 1:
            raise fault(f"a delay of {exact_text(number)} is no whole number of samples", _FORM)
        if not 0 <= number <= LONGEST_DELAY:
            raise fault(f"a delay of {number} samples is not modelled", _FORM)
    if numbers[1] < numbers[0]:
        raise fault("the range of the delay ends below its start", "write [smallest, largest]")
    return int(numbers[0]), int(numbers[1])


_SAMPLES = {"type": "integer", "minimum": 0, "maximum": LONGEST_DELAY}
Delay = Annotated[
    tuple[int, int], ParsedBy(_read_delay, {"anyOf": [_SAMPLES, pair_schema(_SAMPLES)]})
]


class SamplingSpec(IdentifiedSpec, stronger="farther"):
    """The law as a processor runs it: once a period, with float32 coefficients.

    The derivative of the motion controller is a backward difference, the command is held between
    samples, and motion and admittance run with one period, unless the admittance has its own.
    """

    period: field.Duration = required("time between two samples in s")
    delay: Delay = required("age of the force in samples: one number, or [smallest, largest]")
    latency: field.TimeRange | None = optional(
        "time in s from a sample to its command: one, or [shortest, longest]; default: at once"
    )
    jitter: field.Duration | None = optional("by how much, in s, a period may differ from `period`")
    outer_period: field.Duration | None = optional(
        "period of filter and admittance in s, where it is not that of the motion loop: a whole "
        "multiple or part of it; `delay` counts its samples",
        unsaid="other",
    )
    misses: DeadlinesSpec | None = optional("periods that may miss their deadline; default: none")
    admittance: Literal["exact", "euler"] = optional(
        "step of Mt vm' + Bt vm = F: exact for a held force, or by Euler's method",
        "exact",
        stronger="neither",
    )

    @property
    def outer(self) -> Fraction:
        """Time between two samples of the force and the admittance, in s."""
        return (self.outer_period or self.period).exact

    @property
    def step(self) -> Fraction:
        """Time from one sample of either loop to the next, in s."""
        return min(self.period.exact, self.outer)

    @property
    def round(self) -> int:
        """Samples of the faster loop in a period of the slower one; one for a common period."""
        return int(max(self.period.exact, self.outer) / self.step)

    @property
    def oldest(self) -> Fraction:
        """Age of the oldest force sample that the law uses, in s."""
        return self.delay[1] * self.outer

    @property
    def late(self) -> tuple[Fraction, Fraction]:
        """Shortest and longest time from a sample to its command, in s."""
        return ends_of(self.latency)

    @property
    def unsteady(self) -> Fraction:
        """Return the largest deviation of a period from the nominal one, in s."""
        return Fraction(0) if self.jitter is None else self.jitter.exact

    @property
    def longest_step(self) -> Fraction:
        """The longest time from one sample of either loop to the next, in s."""
        return self.step + self.unsteady

    def find_odd_periods(self) -> str | None:
        """Say why the loops do not meet at common samples, or None."""
        ratio = max(self.period.exact, self.outer) / self.step
        if ratio.denominator != 1:
            return "neither period is a whole number of the other"
        return f"one period is {ratio} of the other" if ratio > LARGEST_RATIO else None

    checks = (
        *IdentifiedSpec.checks,
        Row(
            "outer_period",
            find_odd_periods,
            "{0}",
            f"give 1 to {LARGEST_RATIO} periods of one loop to a period of the other",
        ),
        Row(
            "latency",
            lambda s: s.late[1] > LONGEST_DELAY * s.period.exact and s.latency[1].text,
            f"a latency of {{0}} is more than {LONGEST_DELAY} periods, and is not modelled",
            "shorten it, or run the law less often",
        ),
        Row(
            "jitter",
            lambda s: 2 * s.unsteady >= s.period.exact and s.jitter.text,
            "a jitter of {0} is half a period or more",
            "write by how much a period differs from `period` at most",
        ),
    )


class DisturbancesSpec(SpecModel, stronger="larger"):
    """Bounds on disturbances from outside; a missing key is zero."""

    command: field.AngularVelocity | None = optional("largest velocity command in rad/s")
    friction: field.DriveCommand | None = optional("Coulomb friction as a command, such as rpm")
    encoder_step: field.Angle | None = optional(
        "resolution of the joint angle in rad: an error of half a step"
    )
    force_step: field.Torque | None = optional(
        "resolution of the measured torque in N*m: an error of half a step"
    )

    largest_angle: field.Angle | None = optional(
        "largest joint angle and reference in rad, whose float32 rounding acts as a disturbance"
    )

    def bounds(self) -> dict[str, tuple[Fraction, str]]:
        """Return the bounds by the names of what disturbs, with their units; none too small."""
        command = "" if self.friction is None else command_unit(self.friction.dimension)
        written = (
            ("velocity command", self.command, 1, "rad/s"),
            ("friction", self.friction, 1, command),
            ("encoder error", self.encoder_step, 2, "rad"),
            ("force error", self.force_step, 2, "N*m"),
        )
        return {
            name: (quantity.not_below / parts, unit)
            for name, quantity, parts, unit in written
            if quantity is not None and quantity.value
        }

    checks = (
        Row(
            "",
            lambda s: not s.bounds() and s.largest_angle is None,
            "no disturbance is named",
            "name one, or remove disturbances",
        ),
    )
