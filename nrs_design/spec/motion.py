"""Actuator, motion loop and limits of an interaction design."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Annotated, Literal

from pydantic import Field

from nrs_design.models.axis import COMMAND_UNITS
from nrs_design.proof.text import quoted
from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row, S, exactly_one, refuse
from nrs_design.spec.faults import Location
from nrs_design.spec.fields import Exact, UnitFraction
from nrs_design.spec.model import SpecModel, at_most, optional, required
from nrs_design.spec.provenance import Coverage, IdentifiedRangesSpec
from nrs_design.spec.quantity import Quantity, is_less
from nrs_design.spec.units import command_unit

MAX_COEFFICIENTS = 10
# As in `nrs_design.spec.units.COMMAND_UNITS`.
CommandUnit = Literal["rpm", "V", "A", "counts"]
Coefficients = Annotated[tuple[Exact, ...], Field(min_length=1, max_length=MAX_COEFFICIENTS)]


_DEAD_TIME = (
    "time in s for which a command does nothing, one number or [shortest, longest]; the proof adds "
    "it to the latency of `sampling`"
)
_COVERS = "what the identified ranges hold: confidence, tolerance or prediction, each with 95 %"


class ActuatorIntervals(SpecModel, stronger="neither"):
    """Confidence intervals of an identified actuator, for the record.

    The design and the proof take the nominal values.
    """

    gain: tuple[field.ActuatorGain, field.ActuatorGain] = required(
        "[lowest, highest], as rad/s/rpm"
    )
    time_constant: tuple[field.Duration, field.Duration] = required("[lowest, highest] in s")


def commands_in(
    command: Callable[[S], str], written: Callable[[S], Iterable[tuple[Location, Quantity | None]]]
) -> Row[S]:
    """Return the check that quantities about commands are in the unit that the motor takes."""

    def others(said: S) -> Iterator[tuple[Location, tuple[str, ...]]]:
        taken = command(said)
        for at, quantity in written(said):
            if quantity is None or (held := command_unit(quantity.dimension)) == taken:
                continue
            advice = f"write it in {taken}"
            if {held, taken} <= set(COMMAND_UNITS):
                advice += (
                    f"; a spec of kind interaction-design may say `command: {held}` in its "
                    f"actuator, and then writes all that is about commands in {held}"
                )
            yield at, (quoted(quantity.text), held, taken, advice)

    return refuse(others, "{0} is about commands in {1}, and the motor takes {2}", "{3}")


class ActuatorSpec(IdentifiedRangesSpec, stronger="wider"):
    """Velocity actuator ``theta_m/delta = Km/(s (tau s + 1))`` (thesis 4.1)."""

    command: CommandUnit = optional(
        "unit of the commands delta, also of gain, derivative_gain and friction", "rpm"
    )
    gain: field.RangedActuatorGain = required(
        "Km in rad/s/rpm or rad/s/V: theta_m/delta = Km/(s (tau s + 1))"
    )
    time_constant: field.RangedDuration = required("tau, mechanical time constant in s")
    dead_time: field.TimeRange | None = optional(_DEAD_TIME)
    load_inertia: field.RotorInertia | None = optional(
        "inertia at the joint in kg*m^2 on which contact torque acts; default: it slows no motor"
    )
    range_covers: Coverage | None = optional(_COVERS)
    intervals: ActuatorIntervals | None = optional(
        "95 % intervals of gain and time constant, for the record; no proof depends on them"
    )

    def _about_commands(self) -> Iterator[tuple[Location, Quantity]]:
        yield ("gain",), self.gain.nominal
        for i, end in enumerate(self.intervals.gain if self.intervals else ()):
            yield ("intervals", "gain", i), end

    def _missed(self, name: str) -> tuple[str, ...]:
        """Return an interval and the value that it does not hold."""
        if self.intervals is None:
            return ()
        value, (low, high) = getattr(self, name).nominal, getattr(self.intervals, name)
        alike = value.dimension == low.dimension == high.dimension
        outside = alike and (is_less(value, low) or is_less(high, value))
        return (name, low.text, high.text, value.text) if outside else ()

    checks = (
        *IdentifiedRangesSpec.checks,
        commands_in(lambda s: s.command, _about_commands),
        Row(
            "intervals.{0}",
            lambda s: s._missed("gain") or s._missed("time_constant"),
            "the interval [{1}, {2}] does not hold {3!r}",
            "correct one of them",
        ),
    )


class TransferFunctionSpec(SpecModel, stronger="neither"):
    """Strictly proper transfer function, coefficients with the highest power first."""

    numerator: Coefficients = required("coefficients, exact numbers, highest power of s first")
    denominator: Coefficients = required("coefficients, exact numbers, highest power of s first")

    checks = (
        Row(
            "{0}.0",
            lambda s: (k for k in ("numerator", "denominator") if not getattr(s, k)[0]),
            "the highest coefficient is zero",
            "leave it out",
        ),
        Row(
            "numerator",
            lambda s: len(s.numerator) >= len(s.denominator),
            "the transfer function is not strictly proper",
            "give the denominator a higher degree than the numerator",
        ),
    )


class FollowingSpec(IdentifiedRangesSpec, stronger="wider"):
    """A robot that closes its own motion loop, and follows what is streamed."""

    time_constant: field.RangedDuration | None = optional("tau in s of the robot, 1/(tau s + 1)")
    transfer_function: TransferFunctionSpec | None = optional("instead of time_constant, no unit")
    dead_time: field.TimeRange | None = optional(_DEAD_TIME)
    range_covers: Coverage | None = optional(_COVERS)

    checks = (
        *IdentifiedRangesSpec.checks,
        *exactly_one(
            {
                "time_constant": "time_constant: 0.03 s",
                "transfer_function": "transfer_function: ...",
            }
        ),
    )


class VelocityInterfaceSpec(FollowingSpec):
    """A robot whose velocity follows a streamed velocity."""


class PositionInterfaceSpec(FollowingSpec):
    """A robot whose position follows a streamed position."""

    def _restless(self) -> bool:
        G = self.transfer_function
        return G is not None and (G.numerator[-1] != G.denominator[-1] or not G.denominator[-1])

    checks = (
        *FollowingSpec.checks,
        Row(
            "transfer_function",
            _restless,
            "the robot does not come to rest where it is commanded: its transfer function is not 1 "
            "at s = 0",
            "let the last coefficients of numerator and denominator be equal, and not zero",
        ),
    )


class TorqueInterfaceSpec(IdentifiedRangesSpec, stronger="wider"):
    """A robot that takes torques, its gravity compensated: ``J omega' = u - B omega - F``."""

    inertia: field.RangedInertia = required("J of the joint and all that it moves, in kg*m^2")
    friction: field.RangedImpedance = required("B, viscous friction of the joint, N*m*s/rad")
    dead_time: field.TimeRange | None = optional(_DEAD_TIME)
    range_covers: Coverage | None = optional(_COVERS)


class MotionLoopSpec(SpecModel, stronger="neither"):
    """Motion loop around the actuator, closed by a PD controller (thesis 4.3)."""

    damping_ratio: UnitFraction = required("wanted damping ratio, between 0 and 1, no unit")
    settling_time: field.Duration = required("wanted settling time 4/(zeta wn) in s")
    derivative_gain: field.DerivativeGain | None = optional(
        "derivative gain, such as rpm*s/rad, in the unit of commands; default: from the root locus"
    )
    zero: field.Zero | None = optional("zero Kp/Kd of the PD in 1/s; default: from the root locus")
    transfer_function: TransferFunctionSpec | None = optional("closed loop G instead, no unit")


# Prefix of the names of outputs that `limits: {command: ...}` bounds.
MOTOR_COMMAND = "motor command"


class LimitsSpec(SpecModel, stronger="unknown"):
    """What the interaction must respect (thesis 6.3.1)."""

    velocity: field.AngularVelocity = required("largest commanded angular velocity in rad/s")
    torque: field.Torque = required("largest interaction torque in N*m", "smaller")
    bandwidth: field.Bandwidth = required("highest frequency of the operator, Hz", "larger")
    command: field.LargestCommand | None = at_most(
        "largest command of the motor's driver, such as rpm, for the error that derivative_gain "
        "is for: a fifth of the driver's own where its encoder turns five times as far as the "
        "joint; exported code saturates there, and bounds are held to it"
    )
