"""What a safety layer keeps: speed, torque, energy, whatever the controllers above it command."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import ClassVar

from nrs_design.proof.bounds import lower, rounded_down, rounded_up, upper
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.safety import (
    Reach,
    SafetyBounds,
    SampledMotor,
    limits_of,
    reach_of,
    respond,
)
from nrs_design.proof.saturation import OF_TERMS
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem

# Summing takes about the square of the horizon: some seconds at this.
LONGEST = 4000


@dataclass(frozen=True, slots=True)
class SafetyLayer(AbstractEvidence):
    """From rest the loop keeps its limits, whatever moves its reference within the layer.

    While the loop has kept its reach up to a sample, it keeps it at the next one: all numbers of
    `nrs_design.proof.safety.reach_of` are within those that are claimed. The limits follow. Nothing
    of the modes of the system takes part: neither controllers nor tissue.
    """

    kind: ClassVar[str] = "safety-layer"
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True
    covers_rounding: ClassVar[bool] = True

    horizon: int  # Samples of the responses that are summed one by one
    reach: Reach  # How far the loop goes at samples
    limits: SafetyBounds  # What is kept at all times

    @property
    def shows(self) -> Shows:
        """Limits under a safety layer."""
        return Shows.SAFETY

    @property
    def kept_speed(self) -> Fraction:
        """That of its limits."""
        return self.limits.velocity

    def fits(self, switching: Switching) -> bool:
        """Tell that every switching is covered: a reset moves no angle and no reference."""
        return True

    def find_unsayable(self, system: SwitchedSystem) -> str | None:
        """Say that the system has no safety layer, or None."""
        if system.safety is None or system.sample_time is None:
            return "the system has no safety layer"
        return None

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """TRUSTED: check the reach and the limits; there is nothing else to check."""
        loop, period = system.safety, system.sample_time
        if loop is None or period is None or period <= 0:
            return "the system has no safety layer"
        if (odd := loop.find_odd()) is not None:
            return odd
        if abs(loop.tick - period) > OF_TERMS * period:
            return "the period that its processor holds is another one"
        if not 1 <= self.horizon <= LONGEST:
            return f"its horizon is not from 1 to {LONGEST} samples"
        motor = SampledMotor.of(loop, period)
        found = respond(loop, motor, self.horizon, loop.oldest)
        if found is None:
            return "what moves the reference has not died down by the horizon"
        if not found.forward:
            return "the angle may go back while the reference goes on"
        if (name := _beyond(reach_of(loop, motor, found, self.reach), self.reach)) is not None:
            return f"a sample can take the {name} beyond what is claimed"
        if (
            name := _beyond(limits_of(loop, period, motor, found, self.reach), self.limits)
        ) is not None:
            return f"the limit of {name} is not kept"
        if loop.command is not None and self.limits.command > loop.command:
            return (
                f"the command of the motor may saturate: {upper(self.limits.command)} of "
                f"{lower(loop.command)} {loop.unit}"
            )
        return None

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield nothing: no form takes part."""
        return iter(())

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State what is kept, from where, and below what the layer is idle."""
        loop, most = system.safety, self.limits
        assert loop is not None, "said of a system with a safety layer"
        torque, energy = rounded_down(loop.torque, "N*m"), rounded_up(loop.energy, "J")
        low, high = loop.stiffness
        damped = ""
        if loop.damping:
            damped = f", and at most {rounded_down(loop.damping, 'N*m*s/rad')} times its rate"
        return (
            "Safety layer, whatever modes, gains and commands do: from rest in the air, or in "
            f"contact of at most {torque}, while angle and reference are within "
            f"{rounded_down(loop.angle, 'rad')} and one surface at rest presses with {upper(low)} "
            f"to {lower(high)} N*m/rad times its deflection{damped}, changing at will: the joint "
            f"turns by at most {rounded_up(most.velocity, 'rad/s')}; the torque of contact is at "
            f"most {rounded_up(most.torque, 'N*m')}, and for a constant stiffness "
            f"{rounded_up(most.steady, 'N*m')}, with {rounded_up(most.stored, 'J')} stored; the "
            f"command of the motor is at most {rounded_up(most.command, loop.unit)}; and over any "
            f"n samples the steps of the reference do at most {energy} + n "
            f"{rounded_up(loop.refill + most.lost, 'J')} of work against the measured torque. The "
            "layer is idle, and changes no bit, while the reference is to move by at most "
            f"{rounded_down(loop.speed, 'rad/s')}, the measured torque is at most {torque} and the "
            "energy that is booked stays within its limit."
        )


def _beyond(found: Reach | SafetyBounds, claimed: Reach | SafetyBounds) -> str | None:
    """Return the first number that is above the claimed one, or None."""
    for field in fields(claimed):
        least: Fraction = getattr(found, field.name)
        if least > getattr(claimed, field.name):
            return field.name
    return None
