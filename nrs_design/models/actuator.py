"""Velocity-controlled DC motor with gearhead (thesis 4.1)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.errors import AssemblyError
from nrs_design.models.axis import AxisType
from nrs_design.models.interval import Interval, moving


@dataclass(frozen=True, slots=True)
class Actuator:
    """Identified actuator ``theta_m(s)/delta(s) = gain / (s (time_constant s + 1))``."""

    # In (rad/s)/rpm: gearhead speed over the speed command of the motor driver; or per whatever it
    # takes instead.
    gain: Fraction
    time_constant: Fraction  # In s
    command: str = "rpm"  # Unit of the commands that it takes


@dataclass(frozen=True, slots=True)
class ActuatorRanges:
    """Where the actuator may be."""

    gain: Interval  # In rad/s per unit of the command
    time_constant: Interval  # In s
    command: str  # That unit

    @property
    def nominal(self) -> Actuator:
        """The actuator that the design uses."""
        return Actuator(self.gain.nominal, self.time_constant.nominal, self.command)

    @property
    def fixed(self) -> bool:
        """Whether both are known."""
        return all(len(interval.ends) == 1 for interval in (self.gain, self.time_constant))

    def assumed(self, axis: AxisType) -> dict[str, str]:
        """Return the fields of an assumption about the ranges, with units."""
        return {
            "gain": f"{self.gain.text} {axis.unit('rad/s')}/{self.command}",
            "tau": f"{self.time_constant.text} s",
            "moving": moving((self.gain, self.time_constant)),
        }

    def scaled(self, scale: Fraction) -> ActuatorRanges:
        """Return the ranges stretched about the nominal values; all must stay positive."""
        gain, time_constant = self.gain.scaled(scale), self.time_constant.scaled(scale)
        ranges = ActuatorRanges(gain, time_constant, self.command)
        if min(ranges.gain.low, ranges.time_constant.low) <= 0:
            raise AssemblyError(
                f"with its ranges scaled by {float(scale):.6g}, the actuator does not stay "
                "physical",
                remedy="scale the ranges by less",
            )
        return ranges
