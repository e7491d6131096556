"""The control laws that run on the robot, one axis each, with the gains that ship: a file each."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from nrs_design.controllers.laws.force import ProportionalForce
from nrs_design.controllers.laws.impedance import Admittance
from nrs_design.controllers.laws.integral import IntegralForce
from nrs_design.controllers.laws.law import AbstractCompliantLaw, AbstractLaw, DiscreteLaw
from nrs_design.controllers.laws.motion import ProportionalDerivative
from nrs_design.controllers.laws.parallel import ParallelForce
from nrs_design.controllers.laws.position import PositionControl

# A law that fits its spec: who takes both from one controller need not ask which.
CompliantLaw = AbstractCompliantLaw[Any]

# Laws that the robot switches between, by the type of a controller in a spec.
LAWS: Mapping[str, type[CompliantLaw]] = MappingProxyType(
    {
        law.name: law
        for law in (Admittance, ProportionalForce, IntegralForce, ParallelForce, PositionControl)
    }
)

__all__ = [
    "LAWS",
    "AbstractCompliantLaw",
    "AbstractLaw",
    "Admittance",
    "CompliantLaw",
    "DiscreteLaw",
    "IntegralForce",
    "ParallelForce",
    "PositionControl",
    "ProportionalDerivative",
    "ProportionalForce",
]
