"""The world of one axis: the actuator and the environments, in exact SI numbers."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from nrs_design.models.actuator import Actuator, ActuatorRanges
from nrs_design.models.contact.environment import Environment
from nrs_design.models.drive import Drive, motor_drive
from nrs_design.models.motion_loop import MotionLoop, close_motion_loop


@dataclass(frozen=True, slots=True)
class Plant:
    """Actuator and environments of one axis."""

    # In the order of the spec; several that are touched at once come last.
    environments: tuple[Environment, ...]
    actuator_ranges: ActuatorRanges  # Where the actuator may be
    given_loop: MotionLoop | None = None  # The closed motion loop, if the spec states it
    # Inertia at the joint in kg m^2, which contact torques accelerate. None neglects these torques.
    load_inertia: Fraction | None = None
    # Drive of the joint, if not a first-order motor with velocity commands.
    drive: Drive | None = None

    @property
    def actuator(self) -> Actuator:
        """The nominal actuator, which the design uses."""
        return self.actuator_ranges.nominal

    @property
    def slowed(self) -> bool:
        """Whether what is touched slows a motor of the user's."""
        return self.drive is None and self.load_inertia is not None

    @property
    def zoh_drive(self) -> Drive:
        """What moves the joint between samples."""
        motor = self.actuator_ranges
        return self.drive or motor_drive(motor.gain, motor.time_constant, self.load_inertia)

    def contact_drive(self, environments: Sequence[Environment]) -> Drive:
        """Return the drive between samples, with the memory of an environment."""
        for environment in environments:
            if (rates := environment.memory_rates) is not None:
                memory = f"{environment.name}: {environment.law.states[-1]}"
                return self.zoh_drive.remembering(memory, rates)
        return self.zoh_drive

    def motion_loop(self, Kp: Fraction, Kd: Fraction) -> MotionLoop:
        """Return the closed motion loop G of the spec, else of the PD gains.

        The gains are in rpm/rad and rpm s/rad, or whatever the actuator takes instead of rpm.
        """
        return self.given_loop or close_motion_loop(self.actuator, Kp, Kd)

    def environment(self, name: str) -> Environment:
        """Return the environment of that name; the spec guarantees that it exists."""
        return next(environment for environment in self.environments if environment.name == name)

    def select_environments(self, names: Collection[str]) -> tuple[Environment, ...]:
        """Return the environments of these names, in the order of the spec."""
        return tuple(environment for environment in self.environments if environment.name in names)

    def scaled(self, scale: Fraction, names: Collection[str]) -> Plant:
        """Return the plant with the ranges of actuator and touched environments stretched.

        Every parameter is stretched about its nominal value; one that its law does not admit any
        more is an `AssemblyError`.
        """
        if scale == 1:
            return self
        environments = (
            e.scaled(scale) if e.parts or e.name in names else e for e in self.environments
        )
        ranges = self.actuator_ranges.scaled(scale)
        drive = None if self.drive is None else self.drive.scaled(scale)
        return replace(self, environments=tuple(environments), actuator_ranges=ranges, drive=drive)
