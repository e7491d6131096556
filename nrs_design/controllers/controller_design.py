"""The result of design: every gain of one robot axis, and where each controller acts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from nrs_design.controllers.laws import AbstractLaw, CompliantLaw, ProportionalDerivative
from nrs_design.controllers.sensor import Sensor


@dataclass(frozen=True, slots=True)
class ImpedanceOptimum:
    """The best admittance within the bounds, before any rounding."""

    Mt: float  # Virtual mass, kg m^2
    Bt: float  # Virtual damping, N m s/rad
    cost: float  # Value of `nrs_design.design.impedance_optimum.impedance_cost` there
    evaluations: int  # Number of admittances that the search tried


@dataclass(frozen=True, slots=True)
class Controller:
    """One compliant controller."""

    name: str  # As in the spec
    law: CompliantLaw  # Its law with the gains that ship
    environment: str | None  # The environment that it was designed for
    # The environments that it may touch while it is active; empty for position control.
    contacts: tuple[str, ...]
    # What the gains were rounded from, if a search found them. It does not run on the robot, so
    # controllers that differ in it alone are equal.
    optimum: ImpedanceOptimum | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class ControllerDesign:
    """All gains of one axis."""

    motion: ProportionalDerivative  # The motion controller below the compliant ones
    controllers: tuple[Controller, ...]  # In the order of the spec
    sensor: Sensor = field(default_factory=Sensor)  # Of the force that they act on
    command: str = "rpm"  # Unit of the commands that the motor takes

    @property
    def contacts(self) -> frozenset[str]:
        """Names of the environments that some controller may touch."""
        return frozenset(name for c in self.controllers for name in c.contacts)

    @property
    def laws(self) -> dict[str, AbstractLaw]:
        """Every law by the name of its controller, the motion controller first."""
        return {self.motion.name: self.motion} | {c.name: c.law for c in self.controllers}

    @property
    def units(self) -> dict[str, Mapping[str, str]]:
        """The units of all gains, by the names of `laws`; the motion gains make commands."""
        motion = self.motion.units_in(self.command)
        return {name: law.units for name, law in self.laws.items()} | {self.motion.name: motion}
