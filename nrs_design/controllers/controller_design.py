"""The result of design: every gain of one robot axis, and where each controller acts."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction

from nrs_design.controllers.laws import LAWS, AbstractLaw, CompliantLaw, ProportionalDerivative
from nrs_design.controllers.sensor import Sensor
from nrs_design.models.axis import AxisType
from nrs_design.models.drive import CommandInterface, find_interface

# Remedy for modes that share no state.
SHARED_STATES = "give all impedance controllers a virtual inertia Mt > 0, or none of them"


@dataclass(frozen=True, slots=True)
class ImpedanceOptimum:
    """The best admittance within the bounds, before any rounding."""

    Mt: float  # Virtual mass, kg m^2
    Bt: float  # Virtual damping, N m s/rad
    cost: float  # Value of `nrs_design.design.impedance_optimum.impedance_cost` there


@dataclass(frozen=True, slots=True)
class Controller:
    """One compliant controller."""

    name: str  # As in the spec
    law: CompliantLaw  # Its law with the gains that ship
    environment: str | None  # The environment that it was designed for
    # Environments in contact with the active controller; empty for position control.
    contacts: tuple[str, ...]
    # Gains of the search before rounding. Equality of controllers ignores them.
    optimum: ImpedanceOptimum | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class ControllerDesign:
    """All gains of one axis."""

    motion: ProportionalDerivative  # The motion controller below the compliant ones
    controllers: tuple[Controller, ...]  # In the order of the spec
    sensor: Sensor = field(default_factory=Sensor)  # Force sensor of all controllers
    command: str = "rpm"  # Unit of the commands that the motor takes
    axis: AxisType = AxisType.ROTARY  # Whose units the gains have

    @property
    def takes(self) -> CommandInterface | None:
        """What the robot takes; None for the commands of a motor."""
        return find_interface(self.command)

    @property
    def contacts(self) -> frozenset[str]:
        """Names of the environments that some controller may touch."""
        return frozenset(name for c in self.controllers for name in c.contacts)

    @property
    def laws(self) -> dict[str, AbstractLaw]:
        """Every law by the name of its controller, the motion controller first."""
        return {self.motion.name: self.motion} | {c.name: c.law for c in self.controllers}

    def replace_gains(self, gains: Mapping[str, Mapping[str, Fraction]]) -> ControllerDesign:
        """Return the design with some other gains, by the names of `laws`."""
        motion = self.motion
        if not motion.absent:
            motion = motion.create({**motion.gains, **gains.get(motion.name, {})})
        controllers = (
            replace(one, law=one.law.create({**one.law.gains, **gains.get(one.name, {})}))
            for one in self.controllers
        )
        return replace(self, motion=motion, controllers=tuple(controllers))

    def leading_laws(self, *, is_mixture: bool) -> list[CompliantLaw]:
        """Return the laws whose states the modes share.

        In a mixture these are the laws that command a velocity, or else those whose integral
        bleeds; the others have no states of their own.
        """
        laws = [controller.law for controller in self.controllers]
        if not is_mixture:
            return laws
        moving = [law for law in laws if law.commands == "velocity"]
        return moving or [law for law in laws if law.is_leaky]

    def find_odd_states(self, *, is_mixture: bool) -> str | None:
        """Return the states that laws do not share, as a text, or None.

        `mixed`: the states of some controllers are idle while others are active.
        """
        laws = [controller.law for controller in self.controllers]
        kinds = {(law.commands, law.states) for law in self.leading_laws(is_mixture=is_mixture)}
        if is_mixture:
            kinds |= {(law.commands, law.states) for law in laws if law.states and not law.is_leaky}
        if len(kinds) <= 1:
            return None
        descriptions = [f"{law.name} with {', '.join(law.states) or 'no state'}" for law in laws]
        found = "; ".join(dict.fromkeys(descriptions))
        return f"the controllers keep different states of their own ({found})"

    @property
    def units(self) -> dict[str, dict[str, str]]:
        """The units of all gains, by the names of `laws`."""
        gains = {name: law.gains for name, law in self.laws.items()}
        return units_of(gains, self.command, self.axis)


def units_of(
    gains: Mapping[str, Collection[str]], command: str, axis: AxisType
) -> dict[str, dict[str, str]]:
    """Return the units of gains by the names of `ControllerDesign.laws`.

    `command` is the unit of the commands that the motor takes, which the motion gains make.
    """
    pd, units = (
        ProportionalDerivative,
        {g: u for law in LAWS.values() for g, u in law.units.items()},
    )
    motion = {gain: unit.replace("rpm", command) for gain, unit in pd.units.items()}
    tables = {name: motion if name == pd.name else units for name in gains}
    return {
        name: {gain: axis.unit(table.get(gain, "")) for gain in gains[name]}
        for name, table in tables.items()
    }
