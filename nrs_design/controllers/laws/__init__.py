"""The control laws that run on the robot, one axis each, with the gains that ship: a file each.

The law of a controller of a spec is the `LAW` of the file that its type names.
"""

from collections.abc import Mapping
from importlib import import_module

from nrs_design.controllers.laws.force import ProportionalForce
from nrs_design.controllers.laws.impedance import Admittance
from nrs_design.controllers.laws.law import (
    AbstractCompliantLaw,
    AbstractLaw,
    CompliantLaw,
    DiscreteLaw,
)
from nrs_design.controllers.laws.motion import NO_MOTION, ProportionalDerivative
from nrs_design.controllers.laws.pi_force import IntegralForce
from nrs_design.controllers.laws.position import PositionControl
from nrs_design.spec.controllers import CONTROLLER_TYPES

# Laws that the robot switches between, by the type of a controller in a spec.
LAWS: Mapping[str, type[CompliantLaw]] = {
    name: import_module(f"{__name__}.{name.replace('-', '_')}").LAW for name in CONTROLLER_TYPES
}

__all__ = [
    "LAWS",
    "NO_MOTION",
    "AbstractCompliantLaw",
    "AbstractLaw",
    "Admittance",
    "CompliantLaw",
    "DiscreteLaw",
    "IntegralForce",
    "PositionControl",
    "ProportionalDerivative",
    "ProportionalForce",
]
