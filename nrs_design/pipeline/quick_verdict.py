"""A verdict on one spec of many: by the cheapest proof that there may be, or a witness."""

from __future__ import annotations

from dataclasses import dataclass, replace

from nrs_design.certificates.certificate import Certificate, Verdict
from nrs_design.pipeline.certification import assemble_spec, certificate_of, search_limits
from nrs_design.pipeline.design import Designed, run_design, run_with_gains
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certification import Certification, Limits
from nrs_design.search.method import Method
from nrs_design.spec import LoadedSpec
from nrs_design.work import Allowance, Fuse, NotAffordableError

# Cheapest first; the first that applies is tried, and no other.
PROOFS = (
    Method.PERIODIC_QUADRATIC,
    Method.COUPLED_AXES,
    Method.CONEWISE_QUADRATIC,
    Method.LMI,
    Method.MODE_QUADRATIC,
)
# Work for a proof, and for a witness, in units of about a second.
WORK_OF_PROOF, WORK_OF_WITNESS = 10.0, 1.0


@dataclass(frozen=True, slots=True)
class Posed:
    """A spec with its gains and modes, which is to be decided."""

    loaded: LoadedSpec
    designed: Designed | None  # None for given matrices
    system: SwitchedSystem

    @classmethod
    def of(cls, loaded: LoadedSpec, kept: Designed | None) -> Posed:
        """Assemble the modes of a spec.

        Parameters
        ----------
        loaded : LoadedSpec
            The spec.
        kept : Designed or None
            With the gains that it is decided for; None designs them anew, or is for given matrices.

        Raises
        ------
        NrsDesignError
            If the spec makes no switched system.
        """
        designed = run_design(loaded) if kept is None else run_with_gains(loaded, kept.design)
        return cls(loaded, designed, assemble_spec(loaded, designed))

    def limits(self, work: float) -> Limits:
        """Return how far a search goes."""
        limits = search_limits(self.loaded.spec, optimize_rate=False)
        return replace(limits, more=False, budget=min(limits.budget, work))


@dataclass(frozen=True, slots=True)
class QuickVerdict:
    """What is known of a spec; inconclusive says little, as little was tried."""

    verdict: Verdict
    certificate: Certificate | None = None  # Of a proof or a refutation, checked exactly
    # Of what it is refuted, if that leaves the loss of contact open.
    refuted_in: str | None = None

    @property
    def grows(self) -> bool:
        """Whether there is a witness of growth, if only in kept contact."""
        return self.verdict is Verdict.REFUTED or self.refuted_in is not None


OPEN = QuickVerdict(Verdict.INCONCLUSIVE)


def run_quick_proof(posed: Posed) -> QuickVerdict:
    """Try to prove a spec by one form for all modes, or one for each: with one program, mostly.

    Parameters
    ----------
    posed : Posed
        The spec.
    """
    from nrs_design.search.certify import certify
    from nrs_design.search.ladder import applicable_methods

    applicable, limits = applicable_methods(posed.system), posed.limits(WORK_OF_PROOF)
    method = next((one for one in PROOFS if one in applicable), None)
    if method is None or (method is Method.LMI and not _may_have_form(posed.system, limits)):
        return OPEN
    return _decided(posed, certify(posed.system, method, limits))


def run_known_proof(posed: Posed, certificate: Certificate) -> QuickVerdict:
    """Try to prove a spec by what proves another one, which takes the exact check alone.

    Parameters
    ----------
    posed : Posed
        The spec.
    certificate : Certificate
        Of the other one, with the same states.
    """
    from nrs_design.search.certify import certify_with

    if certificate.system.order != posed.system.order:
        return OPEN
    return _decided(posed, certify_with(posed.system, certificate.statements[0]))


def run_quick_growth(posed: Posed) -> QuickVerdict:
    """Try to refute a spec by a mode that grows.

    Parameters
    ----------
    posed : Posed
        The spec.
    """
    from nrs_design.search.certify import certify_growth

    if not posed.system.is_uniform:
        return OPEN
    return _decided(posed, certify_growth(posed.system, posed.limits(WORK_OF_WITNESS)))


def run_quick_witness(posed: Posed) -> QuickVerdict:
    """Try to refute a spec by modes that grow, or a short word of them.

    Parameters
    ----------
    posed : Posed
        The spec.
    """
    from nrs_design.search.certify import certify
    from nrs_design.search.ladder import applicable_methods

    if Method.PERIOD not in applicable_methods(posed.system):
        return OPEN
    return _decided(posed, certify(posed.system, Method.PERIOD, posed.limits(WORK_OF_WITNESS)))


def _decided(posed: Posed, found: Certification) -> QuickVerdict:
    if found.verdict is Verdict.INCONCLUSIVE and found.refuted_in is None:
        return OPEN
    certificate = certificate_of(posed.loaded, posed.designed, found)
    return QuickVerdict(found.verdict, certificate, found.refuted_in)


def _may_have_form(system: SwitchedSystem, limits: Limits) -> bool:
    """Tell whether one program finds a form: where it does not, other coordinates would be tried.

    Where it may not be asked, the search is.
    """
    from nrs_design.search.rate_slope import has_margin, may_have_slope

    if not may_have_slope(system):
        return True
    try:
        return has_margin(system, Allowance(limits.budget, limits.memory, Fuse.of(limits.budget)))
    except NotAffordableError:
        return True
