"""Laws of contact with tissue, tool or hand (thesis 2.5 and fig. 2.18), one file for each."""

from collections.abc import Mapping
from types import MappingProxyType

from nrs_design.errors import InternalError
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
from nrs_design.models.contact.motion import Motion
from nrs_design.spec.environment import AbstractEnvironmentSpec

# What spec and law both say.
FACTS = ("remembers", "has_rest", "has_mass")

# Of tissue, which records tell apart, by name, the simplest first.
LAWS: Mapping[str, type[AbstractContactLaw]] = MappingProxyType(
    {law.name: law for law in (Elastic, KelvinVoigt, Maxwell, KelvinBoltzmann, HuntCrossley)}
)

# Those of them that can enter a design and a proof.
TISSUE_LAWS: Mapping[str, type[AbstractLinearLaw]] = MappingProxyType(
    {law.name: law for law in LAWS.values() if issubclass(law, AbstractLinearLaw)}
)

# All that can, a hand too, which no record of a press is about.
LINEAR_LAWS: Mapping[str, type[AbstractLinearLaw]] = MappingProxyType(
    {**TISSUE_LAWS, Hand.name: Hand}
)


def contact_law_of(spec: AbstractEnvironmentSpec) -> type[AbstractContactLaw]:
    """Return the law of an environment.

    Parameters
    ----------
    spec : AbstractEnvironmentSpec
        As written.

    Raises
    ------
    InternalError
        If the tables do not have it: another one must not be taken for it.
    """
    known = {**LAWS, **LINEAR_LAWS}
    if spec.model not in known:
        raise InternalError(f"no law of contact {spec.model!r} is in nrs_design.models.contact")
    return known[spec.model]


def nonlinear_law_of(spec: AbstractEnvironmentSpec) -> type[AbstractNonlinearLaw] | None:
    """Return the law of an environment if it is not linear.

    Parameters
    ----------
    spec : AbstractEnvironmentSpec
        As written.

    Raises
    ------
    InternalError
        If the tables do not have it.
    """
    law = contact_law_of(spec)
    return law if issubclass(law, AbstractNonlinearLaw) else None


def linear_law_of(spec: AbstractEnvironmentSpec) -> type[AbstractLinearLaw]:
    """Return the linear law that stands for an environment: its own, if that is linear.

    Parameters
    ----------
    spec : AbstractEnvironmentSpec
        As written.

    Raises
    ------
    InternalError
        If there is none, or the spec says other facts of it than the law does.
    """
    if spec.linear_model not in LINEAR_LAWS:
        text = f"no linear law {spec.linear_model!r} is in nrs_design.models.contact"
        raise InternalError(text)
    law = LINEAR_LAWS[spec.linear_model]
    nonlinear = nonlinear_law_of(spec) is not None
    facts = {name: (getattr(spec, name), getattr(law, name)) for name in FACTS}
    facts["preloaded"] = spec.preloaded, nonlinear
    facts["linear_model"] = spec.linear_model != spec.model, nonlinear
    if wrong := [name for name, (written, known) in facts.items() if written is not known]:
        raise InternalError(f"the spec and the law of {spec.model!r} differ in {wrong[0]}")
    return law


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
    "Motion",
    "contact_law_of",
    "linear_law_of",
    "nonlinear_law_of",
]
