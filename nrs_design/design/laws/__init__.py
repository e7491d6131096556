"""How the gains of each law are chosen, and what they achieve: a file for each that has more to it.

The gains of a law without a file here are those that its spec fixes.
"""

from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec
from types import MappingProxyType

from nrs_design.controllers.laws import LAWS
from nrs_design.design.laws.law import GIVEN, LawDesign


def _design_of(controller: str) -> LawDesign:
    module = f"{__name__}.{controller.replace('-', '_')}"
    if find_spec(module) is None:
        return GIVEN
    design: LawDesign = import_module(module).DESIGN
    return design


# By the type of a controller in a spec; analyses are shown in this order.
LAW_DESIGNS: Mapping[str, LawDesign] = MappingProxyType(
    {controller: _design_of(controller) for controller in LAWS}
)

__all__ = ["LAW_DESIGNS", "LawDesign"]
