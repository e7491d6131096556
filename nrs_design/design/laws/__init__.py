"""How the gains of each law are chosen, and what they achieve: one file for each law."""

from collections.abc import Mapping
from types import MappingProxyType

from nrs_design.design.laws import force, impedance, integral, parallel, position
from nrs_design.design.laws.law import LawDesign

# By the type of a controller in a spec; analyses are shown in this order.
LAW_DESIGNS: Mapping[str, LawDesign] = MappingProxyType(
    {
        "impedance": impedance.DESIGN,
        "force": force.DESIGN,
        "pi-force": integral.DESIGN,
        "parallel": parallel.DESIGN,
        "position": position.DESIGN,
    }
)

__all__ = ["LAW_DESIGNS", "LawDesign"]
