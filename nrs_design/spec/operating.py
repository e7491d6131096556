"""Under which conditions a loop runs: what closing it needs of a spec beside plant and gains."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from nrs_design.axis import AxisType
    from nrs_design.models.contact.law import AbstractNonlinearLaw
    from nrs_design.spec.controllers import IdleStatesSpec, Offset
    from nrs_design.spec.sampling import SamplingSpec
    from nrs_design.spec.switching import SwitchingSpec

# Inputs by name: how large each gets, and its unit.
Bounds = Mapping[str, tuple[Fraction, str]]
# A law that is known within a range of deflections, and the ends of that as they are written.
Preload = tuple["type[AbstractNonlinearLaw]", str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingConditions:
    """Processor, switching, contact and bounds of a loop; numbers are exact and in SI units."""

    name: str  # Of the spec
    axis: AxisType  # Whose units its numbers have
    switching: SwitchingSpec
    contact: Literal["losable", "kept"] | None  # None: losable where that can be proved
    idle: IdleStatesSpec | None  # What idle states do
    offset: Offset  # Where the offset of the force controllers is taken from
    sampling: SamplingSpec | None  # The processor; None in continuous time
    command_delay: tuple[
        Fraction, Fraction
    ]  # Shortest and longest time from a sample to its command, in s
    constant_delay_key: str | None  # The key that says it, where it is unknown but constant
    disturbances: Bounds | None  # None where nothing is said to disturb
    largest_angle: Fraction | None  # Of the joint in rad, rounded up
    torque: Fraction  # Limit about the pivot in N m
    velocity: Fraction  # Limit of the velocity command in rad/s, rounded down
    largest_command: Fraction | None  # Limit of the motor command in its unit, rounded down
    command: str  # Unit of the motor command
    largest_integral: Fraction | None  # Where the integral of the force error is cut off, in rad
    contacted: frozenset[str]  # The environments that some controller touches
    initial_force: Fraction | Literal["largest"] | None  # Goal about saturation, in N m
    preloads: Mapping[str, Preload]  # Of the environments that are touched
    sensed: bool  # The spec describes a sensor
