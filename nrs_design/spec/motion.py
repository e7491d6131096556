"""Actuator, motion loop and limits of an interaction design."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Annotated, Literal

from pydantic import Field, model_validator

from nrs_design.proof.text import quoted
from nrs_design.spec.faults import all_of, fault
from nrs_design.spec.fields import Exact, UnitFraction
from nrs_design.spec.model import SpecModel
from nrs_design.spec.provenance import Coverage, IdentifiedRangesSpec
from nrs_design.spec.quantity import Quantity, is_less
from nrs_design.spec.quantity_fields import (
    ActuatorGain,
    AngularVelocity,
    Bandwidth,
    DerivativeGain,
    Duration,
    LargestCommand,
    RangedActuatorGain,
    RangedDuration,
    RotorInertia,
    Torque,
    Zero,
)
from nrs_design.spec.units import command_unit

MAX_COEFFICIENTS = 10
# As in `nrs_design.spec.units.COMMAND_UNITS`.
CommandUnit = Literal["rpm", "V", "A", "counts"]
Coefficients = Annotated[tuple[Exact, ...], Field(min_length=1, max_length=MAX_COEFFICIENTS)]


class ActuatorIntervals(SpecModel):
    """Confidence intervals of an identified actuator, for the record.

    The design and the proof take the nominal values.
    """

    gain: tuple[ActuatorGain, ActuatorGain] = Field(
        description="[lowest, highest] gain in rad/s per command unit, 95 % interval"
    )
    time_constant: tuple[Duration, Duration] = Field(
        description="[lowest, highest] time constant in s, 95 % interval"
    )


class ActuatorSpec(IdentifiedRangesSpec):
    """Velocity actuator ``theta_m/delta = Km/(s (tau s + 1))`` (thesis 4.1)."""

    command: CommandUnit = Field(
        default="rpm",
        description="unit of the commands delta that the motor takes: rpm, V, A or counts; gain, "
        "derivative_gain and friction are written in it",
    )
    gain: RangedActuatorGain = Field(
        description="Km, motor speed per command unit, such as rad/s/rpm or rad/s/V, as in "
        "theta_m/delta = Km/(s (tau s + 1))"
    )
    time_constant: RangedDuration = Field(description="tau, mechanical time constant in s")
    load_inertia: RotorInertia | None = Field(
        default=None,
        description="inertia at the joint in kg*m^2 against which the torque of an environment "
        "works; without it that torque does not slow the motor",
    )
    range_covers: Coverage | None = Field(
        default=None,
        description="what the identified ranges hold: confidence (the recorded motor), tolerance "
        "(95 % of all records of such motors) or prediction (the next record), each with 95 %",
    )
    intervals: ActuatorIntervals | None = Field(
        default=None,
        description="95 % intervals of gain and time constant, for the record: the proof is for "
        "the nominal values",
    )

    @model_validator(mode="after")
    def _check_commands(self) -> ActuatorSpec:
        written: dict[tuple[int | str, ...], Quantity] = {("gain",): self.gain.nominal}
        if self.intervals is not None:
            written |= {("intervals", "gain", i): end for i, end in enumerate(self.intervals.gain)}
        check_commands(self.command, written)
        return self

    @model_validator(mode="after")
    def _check_intervals(self) -> ActuatorSpec:
        if self.intervals is None:
            return self
        for name in ("gain", "time_constant"):
            value = getattr(self, name).nominal
            low, high = getattr(self.intervals, name)
            if is_less(value, low) or is_less(high, value):
                raise fault(
                    f"the interval [{low.text}, {high.text}] does not hold {value.text!r}",
                    "correct one of them",
                    "intervals",
                    name,
                )
        return self


def check_commands(command: CommandUnit, written: Mapping[tuple[int | str, ...], Quantity]) -> None:
    """Refuse quantities about commands in another unit than that of the motor.

    Parameters
    ----------
    command : {"rpm", "V", "A", "counts"}
        The unit of the motor.
    written : mapping
        Quantities that hold a unit of commands once, by their places.
    """
    all_of(*(partial(_check_command, command, quantity, at) for at, quantity in written.items()))


def _check_command(command: CommandUnit, quantity: Quantity, at: tuple[int | str, ...]) -> None:
    held = command_unit(quantity.dimension)
    if held != command:
        raise fault(
            f"{quoted(quantity.text)} is about commands in {held}, and the motor takes {command}",
            f"write it in {command}; a spec of kind interaction-design may say `command: {held}` "
            f"in its actuator, and then writes all that is about commands in {held}",
            *at,
        )


class TransferFunctionSpec(SpecModel):
    """Strictly proper transfer function, coefficients with the highest power first."""

    numerator: Coefficients = Field(
        description="numerator coefficients, exact numbers, highest power of s first"
    )
    denominator: Coefficients = Field(
        description="denominator coefficients, exact numbers, highest power of s first"
    )

    @model_validator(mode="after")
    def _check_proper(self) -> TransferFunctionSpec:
        for name, coefficients in (
            ("numerator", self.numerator),
            ("denominator", self.denominator),
        ):
            if coefficients[0] == 0:
                raise fault("the highest coefficient is zero", "leave it out", name, 0)
        if len(self.numerator) >= len(self.denominator):
            raise fault(
                "the transfer function is not strictly proper",
                "give the denominator a higher degree than the numerator",
                "numerator",
            )
        return self


class MotionLoopSpec(SpecModel):
    """Motion loop around the actuator, closed by a PD controller (thesis 4.3)."""

    damping_ratio: UnitFraction = Field(
        description="wanted damping ratio of the closed loop, between 0 and 1, no unit"
    )
    settling_time: Duration = Field(description="wanted settling time 4/(zeta wn) in s")
    derivative_gain: DerivativeGain | None = Field(
        default=None,
        description="derivative gain really used, such as rpm*s/rad, in the unit of the commands; "
        "default: from the root locus",
    )
    zero: Zero | None = Field(
        default=None,
        description="zero Kp/Kd of the PD controller really used, in 1/s; default: from the root "
        "locus",
    )
    transfer_function: TransferFunctionSpec | None = Field(
        default=None,
        description="closed motion loop G to be used instead of the one that the PD gives, no unit",
    )


# How the name of an output begins that is held against `limits: {command: ...}`.
MOTOR_COMMAND = "motor command"


class LimitsSpec(SpecModel):
    """What the interaction must respect (thesis 6.3.1)."""

    velocity: AngularVelocity = Field(description="largest commanded angular velocity in rad/s")
    torque: Torque = Field(description="largest interaction torque in N*m")
    bandwidth: Bandwidth = Field(description="highest frequency of the operator's motion, Hz")
    command: LargestCommand | None = Field(
        default=None,
        description="largest command that the motor's driver takes, such as rpm, for the error "
        "that derivative_gain is for: where the driver closes its loop on an encoder that turns "
        "five times as far as the joint, and the gains are for the joint, a fifth of the "
        "driver's own; exported code saturates there, and bounds on the command are held to it",
    )
