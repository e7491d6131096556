"""The motion loop of a motor that is known to within ranges, or that the environment slows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.loop.parameter_box import Box
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.motion_loop import JointMotionLoop
from nrs_design.models.plant import Plant


@dataclass(frozen=True, slots=True)
class Joint:
    """The motion loop in its physical state, wherever gain and time constant of the motor are."""

    motion: ProportionalDerivative  # The PD gains that ship
    ranges: ActuatorRanges  # Where the motor may be
    load_inertia: Fraction | None  # The J of `nrs_design.models.motion_loop.JointMotionLoop`

    @classmethod
    def of(cls, plant: Plant, motion: ProportionalDerivative) -> Joint | None:
        """Return the joint of a plant, or None where its motor is a point and carries no load."""
        ranges = plant.actuator_ranges
        if ranges.fixed and plant.load_inertia is None:
            return None
        return cls(motion, ranges, plant.load_inertia)

    @property
    def box(self) -> Box:
        """The box in which the loop is affine in the gain, and in one over the time constant."""
        return Box({"Km": self.ranges.gain, "tau": self.ranges.time_constant}, frozenset({"tau"}))

    @property
    def nominal(self) -> JointMotionLoop:
        """The loop that the design uses."""
        motor = self.ranges.nominal
        return self.at({"Km": motor.gain, "tau": motor.time_constant})

    def at(self, values: Mapping[str, Fraction]) -> JointMotionLoop:
        """Return the loop at the values of ``Km`` and ``tau``."""
        gains = self.motion.Kp, self.motion.Kd
        return JointMotionLoop(*gains, values["Km"], values["tau"], self.load_inertia)
