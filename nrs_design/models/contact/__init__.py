"""Laws of contact with tissue, tool or hand (thesis 2.5 and fig. 2.18), one file for each."""

from collections.abc import Mapping

from nrs_design.models.contact.elastic import Elastic
from nrs_design.models.contact.hand import Hand
from nrs_design.models.contact.hunt_crossley import HuntCrossley
from nrs_design.models.contact.kelvin_boltzmann import KelvinBoltzmann
from nrs_design.models.contact.kelvin_voigt import KelvinVoigt
from nrs_design.models.contact.law import (
    AbstractContactLaw,
    AbstractLinearLaw,
    AbstractNonlinearLaw,
)
from nrs_design.models.contact.maxwell import Maxwell

# Laws of tissue by name, the simplest first.
LAWS: Mapping[str, type[AbstractContactLaw]] = {
    law.name: law for law in (Elastic, KelvinVoigt, Maxwell, KelvinBoltzmann, HuntCrossley)
}

# Tissue laws for a design and a proof.
TISSUE_LAWS: Mapping[str, type[AbstractLinearLaw]] = {
    law.name: law for law in LAWS.values() if issubclass(law, AbstractLinearLaw)
}

# All that can, a hand too, which no record of a press is about.
LINEAR_LAWS: Mapping[str, type[AbstractLinearLaw]] = {**TISSUE_LAWS, Hand.name: Hand}


__all__ = [
    "LAWS",
    "LINEAR_LAWS",
    "TISSUE_LAWS",
    "AbstractContactLaw",
    "AbstractLinearLaw",
    "AbstractNonlinearLaw",
    "Elastic",
    "Hand",
    "HuntCrossley",
    "KelvinBoltzmann",
    "KelvinVoigt",
    "Maxwell",
]
