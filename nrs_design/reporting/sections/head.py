"""The head of the report: claim, remarks and facts."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from nrs_design import __version__
from nrs_design.pipeline.certification import Result
from nrs_design.proof.bounds import at_least, at_most, lower, upper
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import constants_words
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Derived
from nrs_design.reporting.formatting import shortened
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.sections.titles import EVIDENCE, MEANT, MODES, RECHECK, RUNGS, SPEC
from nrs_design.search.certification import Certification
from nrs_design.spec import InteractionDesignSpec, RobotSpec
from nrs_design.spec.provenance import COVERS, MOTOR_COVERS

# Labels and values.
_Facts = list[tuple[str, str]]

NO_CLAIM = (
    "Neither a proof nor a refutation was found. This is no statement about stability: the modes "
    "may be stable or unstable under switching."
)


REFUTED_ASIDE = (
    "Refuted {}, for which the environment would have to pull. Where contact may be lost:"
)


def claim_of(certification: Certification) -> str:
    """Return what the certificate claims about stability, or that there is nothing to claim."""
    if certification.evidence is None:
        where = certification.refuted_in
        return NO_CLAIM if where is None else f"{REFUTED_ASIDE.format(where)} {NO_CLAIM}"
    return certification.evidence.claim(certification.system)


def remarks_of(certification: Certification) -> tuple[str, ...]:
    """Return the claims of the other statements."""
    return tuple(
        statement.claim(certification.system)
        for statement in certification.statements
        if statement is not certification.evidence
    )


def facts(result: Result) -> tuple[tuple[str, str], ...]:
    """Return switching, hashes, versions and rates for the head of the report."""
    certification = result.certification
    system = certification.system
    most = "" if system.is_uniform else "at most "
    count = f"{counted(len(system.modes), 'mode')} of {most}{counted(system.order, 'state')}"
    where = certification.refuted_in
    return (
        ("Spec", linked(result.loaded, result.loaded.spec.name, "name")),
        ("Switching", linked(result.loaded, switching_words(result), "switching")),
        ("Switches among", Derived(f"{count}, in {system.time} time", MODES)),
        ("Common quadratic function", str(certification.common_quadratic)),
        # What is refuted although the verdict is inconclusive.
        *(() if where is None else (("Refuted", Derived(where, MEANT)),)),
        (
            "Settled by",
            Derived(certification.method if certification.evidence else "nothing", RUNGS),
        ),
        *_rate(system, certification.evidence),
        *_limit(certification),
        *_provenance(result),
        ("Package", f"nrs-design {__version__}"),
        ("SHA-256 of the spec", Derived(result.loaded.sha256, SPEC)),
        (
            "Certificate id",
            Derived(result.certificate.id if result.certificate else "no certificate", RECHECK),
        ),
    )


def switching_words(result: Result) -> str:
    """Say which switching signals the spec declares, in a few words."""
    system = result.certification.system
    switching = system.switching
    spec = result.loaded.spec
    assert not isinstance(spec, RobotSpec)  # It has no modes, hence no certification.
    words = [str(spec.switching)]
    if switching.resets:
        words.append("the state is reset at some switches")
    if system.has_constants:
        words.append(f"{constants_words(switching)}: unknown but constant")
    return "; ".join(words)


def proved_rate(system: SwitchedSystem, evidence: AbstractEvidence | None) -> Fraction | None:
    """Return the proved rate, or None where no decay is proved."""
    if evidence is None or evidence.shows is not Shows.STABILITY:
        return None
    return evidence.proved_rate(system)


def _rate(system: SwitchedSystem, evidence: AbstractEvidence | None) -> _Facts:
    rate = proved_rate(system, evidence)
    if evidence is None or rate is None:
        return []
    constant = "" if evidence.attains_rate else ", not attained"
    if not evidence.bounds_at_once:
        constant += ", up to a constant factor"
    label, text = "Proved contraction rho", at_most(rate, "per step")
    if system.time is Time.CONTINUOUS:
        label, text = "Proved decay rate alpha", at_least(rate, "1/s")
    return [(label, Derived(f"{text.removeprefix('= ')}{constant}", EVIDENCE))]


def _limit(certification: Certification) -> _Facts:
    """Return the bound on the rate that no proof can exceed."""
    limit, evidence = certification.rate_limit, certification.evidence
    if limit is None or evidence is None or evidence.shows is not Shows.STABILITY:
        return []
    label, text = "No proof can go below", f"{lower(Fraction(limit))} per step"
    if certification.system.time is Time.CONTINUOUS:
        label, text = "No proof can exceed", f"{upper(Fraction(limit))} 1/s"
    attained = ", which one solution attains (floating point)"
    return [(label, Derived(f"{text}{attained}", MODES))]


def _provenance(result: Result) -> Iterator[tuple[str, str]]:
    """Say which data the values of the spec were identified from."""
    loaded = result.loaded
    spec = loaded.spec
    if not isinstance(spec, InteractionDesignSpec):
        return
    for at, item in spec.identified.items():
        name = at[-1]
        if item.provenance:
            kinds = " and ".join(sorted({source.data.upper() for source in item.provenance}))
            count = counted(len(item.provenance), "record")
            files = shortened([source.file for source in item.provenance], 3)
            text = f"{kinds} data, {count}: {files}"
            yield (f"Data for {name}", linked(loaded, text, *at, "provenance"))
        if item.doubts:
            accepted = f"accepted: {item.accept_doubt}" if item.accept_doubt else "NOT accepted"
            text = f"{shortened(list(item.doubts), 3)} ({accepted})"
            yield (f"Doubts about {name}", linked(loaded, text, *at, "doubts"))
    if spec.actuator is not None and spec.actuator.range_covers is not None:
        text = MOTOR_COVERS[spec.actuator.range_covers]
        yield ("Range of actuator holds", linked(loaded, text, "actuator", "range_covers"))
    for name, environment in spec.environments.items():
        if environment.range_covers is not None:
            at = ("environments", name, "range_covers")
            yield (f"Range of {name} holds", linked(loaded, COVERS[environment.range_covers], *at))
