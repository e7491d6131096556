"""Laws of soft tissue (thesis 2.5 and fig. 2.18), one file for each."""

from collections.abc import Mapping
from types import MappingProxyType

from nrs_design.models.tissue.elastic import Elastic
from nrs_design.models.tissue.hunt_crossley import HuntCrossley
from nrs_design.models.tissue.kelvin_boltzmann import KelvinBoltzmann
from nrs_design.models.tissue.kelvin_voigt import KelvinVoigt
from nrs_design.models.tissue.law import AbstractTissueLaw
from nrs_design.models.tissue.maxwell import Maxwell
from nrs_design.models.tissue.motion import Motion

# By name, the simplest first.
LAWS: Mapping[str, type[AbstractTissueLaw]] = MappingProxyType(
    {law.name: law for law in (Elastic, KelvinVoigt, Maxwell, KelvinBoltzmann, HuntCrossley)}
)

__all__ = [
    "LAWS",
    "AbstractTissueLaw",
    "Elastic",
    "HuntCrossley",
    "KelvinBoltzmann",
    "KelvinVoigt",
    "Maxwell",
    "Motion",
]
