"""A verdict on one spec of many: by the cheapest proof that there may be, or a witness."""

from __future__ import annotations

from dataclasses import dataclass, replace

from nrs_design.certificates.certificate import Certificate, Verdict
from nrs_design.errors import NrsDesignError
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
class QuickVerdict:
    """What is known of a spec; inconclusive says little, as little was tried."""

    verdict: Verdict
    certificate: Certificate | None = None  # Of a proof or a refutation, checked exactly
    # Of what it is refuted, if that leaves the loss of contact open.
    refuted_in: str | None = None
    wrong: str = ""  # Why there is no switched system to decide

    @property
    def grows(self) -> bool:
        """Whether there is a witness of growth, if only in kept contact."""
        return self.verdict is Verdict.REFUTED or self.refuted_in is not None


def run_quick_proof(loaded: LoadedSpec, kept: Designed | None) -> QuickVerdict:
    """Try to prove a spec by one form for all modes, or one for each.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec.
    kept : Designed or None
        With the gains that it is decided for; None designs them anew, or is for given matrices.
    """
    return _decided(loaded, kept, None)


def run_quick_witness(loaded: LoadedSpec, kept: Designed | None) -> QuickVerdict:
    """Try to refute a spec by modes that grow, or a short word of them.

    Parameters
    ----------
    loaded, kept
        As for `run_quick_proof`.
    """
    return _decided(loaded, kept, Method.PERIOD)


def _decided(loaded: LoadedSpec, kept: Designed | None, method: Method | None) -> QuickVerdict:
    from nrs_design.search.certify import certify
    from nrs_design.search.ladder import applicable_methods
    from nrs_design.search.rate_slope import may_have_slope

    try:
        designed = run_design(loaded) if kept is None else run_with_gains(loaded, kept.design)
        coordinates = None if designed is None else designed.spec.coordinates
        system = assemble_spec(loaded, designed, coordinates)
    except NrsDesignError as error:
        return QuickVerdict(Verdict.INCONCLUSIVE, wrong=error.message)
    applicable = applicable_methods(system)
    chosen = method or next((one for one in PROOFS if one in applicable), None)
    if chosen not in applicable or chosen is None:
        return QuickVerdict(Verdict.INCONCLUSIVE)
    limits = search_limits(loaded.spec, optimize_rate=False)
    work = WORK_OF_PROOF if method is None else WORK_OF_WITNESS
    limits = replace(limits, more=False, budget=min(limits.budget, work))
    if method is None and may_have_slope(system) and not _has_margin(system, limits):
        return QuickVerdict(Verdict.INCONCLUSIVE)
    found = certify(system, chosen, limits)
    if not _decides(found):
        return QuickVerdict(Verdict.INCONCLUSIVE)
    certificate = certificate_of(loaded, designed, coordinates, found)
    return QuickVerdict(found.verdict, certificate, found.refuted_in)


def _has_margin(system: SwitchedSystem, limits: Limits) -> bool:
    """Tell whether one program finds a form; where it may not be asked, the search is."""
    from nrs_design.search.rate_slope import has_margin

    try:
        return has_margin(system, Allowance(limits.budget, limits.memory, Fuse.of(limits.budget)))
    except NotAffordableError:
        return True


def _decides(found: Certification) -> bool:
    return found.verdict is not Verdict.INCONCLUSIVE or found.refuted_in is not None
