"""What certificates of the axes of an arm, each with its own function, show of all at once."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from nrs_design.certificates.certificate import Certificate
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows

# As an assumption gives the bound.
SAID = "Every eigenvalue of S is in"


def rate_together(certificates: Sequence[Certificate]) -> Fraction | None:
    """Return the rate per step at which axes that are not alike decrease at once; None if unshown.

    What one axis does to the others is bounded by one sum over all, with one multiplier tau in each
    certificate. So with V the function of an axis and J its inertia, ``J V/tau`` summed over all
    axes falls at the worst of their rates (docs/certificates/coupled-axes.md).

    Parameters
    ----------
    certificates : sequence of Certificate
        That have passed the check.
    """
    rates, said = list[Fraction](), set()
    for certificate in certificates:
        system = certificate.system
        names = {item.name for item in system.couplings}
        shown = [s.proved_rate(system) for s in certificate.statements if _covers(s)]
        known = [rate for rate in shown if rate is not None]
        # The same period and bound; all else is of the axis alone.
        arm = tuple(text for text in system.assumptions if SAID in text)
        if len(names) != 1 or not known or system.sample_time is None or not arm:
            return None
        said.add((system.sample_time, *names, arm))
        rates.append(min(known))
    return max(rates) if len(said) == 1 else None


def _covers(evidence: AbstractEvidence) -> bool:
    return evidence.shows is Shows.STABILITY and evidence.covers_coupling
