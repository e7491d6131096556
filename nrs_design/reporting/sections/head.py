"""The top of the report: claim, facts, lights, and what a reader wants to know first."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design import __version__
from nrs_design.certificates.bounds import bound_on
from nrs_design.certificates.catalogue import CONTACT_KEPT, catalogue_kind
from nrs_design.certificates.certificate import Verdict
from nrs_design.design.measures import SENSITIVITY_PEAK
from nrs_design.models.axis import unit
from nrs_design.pipeline.certification import Result
from nrs_design.proof.bounds import at_least, at_most, lower, upper
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import constants_words
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Light, Linked, State
from nrs_design.reporting.formatting import list_first
from nrs_design.reporting.sections.goals import judged_goals
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.sections.tail import register_of
from nrs_design.reporting.sections.titles import (
    ASSUMPTIONS,
    EVIDENCE,
    GOALS,
    MEANT,
    MODES,
    RECHECK,
    RUNGS,
    SPEC,
)
from nrs_design.search.certification import Certification
from nrs_design.spec import InteractionDesignSpec, RobotSpec
from nrs_design.spec.provenance import COVERS, MOTOR_COVERS

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis

NO_CLAIM = (
    "Neither a proof nor a refutation was found. This is no statement about stability: the modes "
    "may be stable or unstable under switching."
)
REFUTED_ASIDE = (
    "Refuted {}, for which the environment would have to pull. Where contact may be lost:"
)


def claim_of(certification: Certification) -> str:
    """Return the claim of the certificate about stability, or `NO_CLAIM`."""
    if certification.evidence is None:
        contact = certification.refuted_in
        return NO_CLAIM if contact is None else f"{REFUTED_ASIDE.format(contact)} {NO_CLAIM}"
    return certification.evidence.claim(certification.system)


def facts(result: Result) -> tuple[tuple[str, str], ...]:
    """Return switching, hashes, versions and rates for the head of the report."""
    certification = result.certification
    system = certification.system
    qualifier = "" if system.is_uniform else "at most "
    count = f"{counted(len(system.modes), 'mode')} of {qualifier}{counted(system.order, 'state')}"
    contact = certification.refuted_in
    return (
        ("Spec", linked(result.loaded, result.loaded.spec.name, "name")),
        ("Switching", linked(result.loaded, _switching(result), "switching")),
        ("Switches among", Linked(f"{count}, in {system.time} time", section=MODES)),
        ("Common quadratic function", str(certification.common_quadratic)),
        # Refuted in one kind of contact; the verdict on the whole loop is inconclusive.
        *(() if contact is None else (("Refuted", Linked(contact, section=MEANT)),)),
        (
            "Settled by",
            Linked(certification.method if certification.evidence else "nothing", section=RUNGS),
        ),
        *_rates(certification),
        *_provenance(result),
        ("Package", f"nrs-design {__version__}"),
        ("SHA-256 of the spec", Linked(result.loaded.sha256, section=SPEC)),
        (
            "Certificate id",
            Linked(
                result.certificate.id if result.certificate else "no certificate", section=RECHECK
            ),
        ),
    )


def _switching(result: Result) -> str:
    """Say which switching signals the spec declares, in a few words."""
    system, spec = result.certification.system, result.loaded.spec
    assert not isinstance(spec, RobotSpec), "a robot spec has no modes to certify"
    words = str(spec.switching)
    if system.switching.resets:
        words += "; the state is reset at some switches"
    if system.has_constants:
        words += f"; {constants_words(system.switching)}: unknown but constant"
    return words


def proved_rate(system: SwitchedSystem, evidence: AbstractEvidence | None) -> Fraction | None:
    """Return the proved rate, or None where no decay is proved."""
    if evidence is None or evidence.shows is not Shows.STABILITY:
        return None
    return evidence.proved_rate(system)


def _rates(certification: Certification) -> Iterator[tuple[str, str]]:
    """Yield the proved rate, and the bound on the rate that no proof can exceed."""
    system, evidence = certification.system, certification.evidence
    rate, limit = proved_rate(system, evidence), certification.rate_limit
    if evidence is None or rate is None:
        return
    constant = "" if evidence.attains_rate else ", not attained"
    constant += "" if evidence.bounds_at_once else ", up to a constant factor"
    label, text = "Proved contraction rho", at_most(rate, "per step")
    if system.time is Time.CONTINUOUS:
        label, text = "Proved decay rate alpha", at_least(rate, "1/s")
    yield label, Linked(f"{text.removeprefix('= ')}{constant}", section=EVIDENCE)
    if limit is None:
        return
    label, text = "No proof can go below", f"{lower(Fraction(limit))} per step"
    if system.time is Time.CONTINUOUS:
        label, text = "No proof can exceed", f"{upper(Fraction(limit))} 1/s"
    yield label, Linked(f"{text}, which one solution attains (floating point)", section=MODES)


def _provenance(result: Result) -> Iterator[tuple[str, str]]:
    """Say which data the values of the spec were identified from."""
    loaded = result.loaded
    spec = loaded.spec
    if not isinstance(spec, InteractionDesignSpec):
        return
    for key_path, item in spec.identified.items():
        name = key_path[-1]
        if item.provenance:
            kinds = " and ".join(sorted({source.data.upper() for source in item.provenance}))
            count = counted(len(item.provenance), "record")
            files = list_first([source.file for source in item.provenance], 3)
            text = f"{kinds} data, {count}: {files}"
            yield (f"Data for {name}", linked(loaded, text, *key_path, "provenance"))
        if item.doubts:
            accepted = f"accepted: {item.accept_doubt}" if item.accept_doubt else "NOT accepted"
            text = f"{list_first(list(item.doubts), 3)} ({accepted})"
            yield (f"Doubts about {name}", linked(loaded, text, *key_path, "doubts"))
    if spec.actuator is not None and spec.actuator.range_covers is not None:
        text = MOTOR_COVERS[spec.actuator.range_covers]
        yield ("Range of actuator holds", linked(loaded, text, "actuator", "range_covers"))
    for name, environment in spec.environments.items():
        if environment.range_covers is not None:
            key_path = ("environments", name, "range_covers")
            yield (
                f"Range of {name} holds",
                linked(loaded, COVERS[environment.range_covers], *key_path),
            )


_PROOF = {
    Verdict.PROVED: (State.GOOD, "proved; exact arithmetic decided, and a second library agreed"),
    Verdict.REFUTED: (State.BAD, "refuted, with a witness"),
    Verdict.INCONCLUSIVE: (State.DOUBTFUL, "inconclusive: a gate must treat it as a failure"),
}


def summary_of(result: Result) -> tuple[str, str]:
    """Return two sentences: the conclusion, and its assumptions."""
    system, evidence = result.certification.system, result.certification.evidence
    register = register_of(result.certification.granted, result.loaded.spec)
    names = "; ".join(dict.fromkeys(item.kind.name for item in register))
    assumption_note = f"This takes for granted, each as {ASSUMPTIONS} below says it: {names}."
    if evidence is None:
        statement = "Neither proved nor refuted: this report makes no statement about stability."
        if (contact := result.certification.refuted_in) is not None:
            statement = (
                f"Refuted {contact}, where the environment would have to pull; with contact "
                "that may be lost, neither proved nor refuted."
            )
        return statement, f"What was searched for would have taken for granted: {names}."
    if evidence.shows is Shows.STABILITY:
        return _proved(result), assumption_note
    (witness,) = (b for s, b in result.briefs if s is evidence)
    exact = ", for exact arithmetic" if system.roundings else ""
    return f"Refuted: {witness}{exact}: no guarantee of stability is possible.", assumption_note


def _proved(result: Result) -> str:
    """Return the sentence on the proved properties, with their limits."""
    certification, has_ranges = result.certification, result.loaded.spec.has_ranges
    system, evidence = certification.system, certification.evidence
    briefs = {s.shows: brief for s, brief in reversed(result.briefs)}
    assumes_contact = any(catalogue_kind(item).id == CONTACT_KEPT for item in system.assumptions)
    bounds_immediately = evidence is None or evidence.bounds_at_once
    notes = (
        (", as long as contact is kept", assumes_contact and system.contact is None),
        (", up to one constant factor", not bounds_immediately),
        (", for all values in the declared ranges", has_ranges),
    )
    saturated, bounded = system.saturation is not None, Shows.BOUND in briefs
    begin = "while no signal saturates, " if saturated else ""
    first = briefs[Shows.STABILITY] + "".join(text for text, applies in notes if applies)
    others = [brief for s, brief in result.briefs if s.shows in (Shows.BOUND, Shows.REGION)]
    if saturated and Shows.REGION not in briefs:
        others.append("where signals saturate, nothing is proved")
    if system.channels and not bounded:
        others.append("no bound under the disturbances of the spec is proved")
    return f"Proved: {begin}{'; '.join((first, *others))}."


def lights_of(result: Result, analysis: DesignAnalysis | None) -> tuple[Light, ...]:
    """Return the lights for proof, goals, design, doubts of the data and open assumptions."""
    state, text = _PROOF[Verdict(result.certification.verdict)]
    if (contact := result.certification.refuted_in) is not None:
        text = f"{text}; refuted {contact}"
    proof = Light("Proof", state, text, MEANT)
    spec = result.loaded.spec
    if not isinstance(spec, InteractionDesignSpec):
        return (proof, _open(result))
    goals = Light("Goals", *judged_goals(result, analysis), GOALS)
    return (proof, goals, _warnings(analysis), _data(spec), _open(result))


def _warnings(analysis: DesignAnalysis | None) -> Light:
    if analysis is None:
        return Light("Design", State.BAD, "a nominal loop is unstable")
    state, text = State.GOOD, "no warning (floating point, no part of the proof)"
    if count := len(analysis.warnings):
        state, text = State.DOUBTFUL, f"{counted(count, 'warning')} (no part of the proof)"
    return Light("Design", state, text, GOALS)


def _data(spec: InteractionDesignSpec) -> Light:
    items = [item for item in spec.identified.values() if item.provenance or item.doubts]
    doubted = [item for item in items if item.doubts]
    doubts = counted(sum(len(item.doubts) for item in doubted), "doubt")
    state, text = State.GOOD, "the spec names measured records, no doubts"
    if not items:
        state, text = State.UNKNOWN, "no value names the records that it was identified from"
    elif any(item.accept_doubt is None for item in doubted):
        state, text = State.BAD, f"{doubts}, not accepted"
    elif doubted:
        state, text = State.DOUBTFUL, f"{doubts}, accepted with a reason"
    elif any(source.data == "synthetic" for item in items for source in item.provenance):
        state, text = State.DOUBTFUL, "SYNTHETIC records, not measured"
    return Light("Data", state, text, ASSUMPTIONS)


def _open(result: Result) -> Light:
    found = register_of(result.certification.granted, result.loaded.spec)
    count = sum(item.standing == "open" for item in found)
    state = State.DOUBTFUL if count else State.GOOD
    text = f"{count} of {len(found)} open: to be tested on the robot"
    return Light(ASSUMPTIONS, state, text, ASSUMPTIONS)


# Digits that are read at a glance.
_DIGITS = 4


def key_facts(result: Result, analysis: DesignAnalysis | None) -> tuple[tuple[str, str], ...]:
    """Return labels and conservatively rounded values for the head of the page."""
    design = (*_gains(result), *_achieved(analysis))
    return (*_worst(analysis), *_modes(result), *_force(result), *design)


def _worst(analysis: DesignAnalysis | None) -> Iterator[tuple[str, str]]:
    """Yield the worst exceeded limit, with the number of other warnings."""
    doubts = () if analysis is None else analysis.warnings
    if doubts and doubts[0].beyond:
        count_note = f" ({counted(len(doubts) - 1, 'more warning')})" if doubts[1:] else ""
        yield "Worst of it", Linked(f"{doubts[0]}{count_note}", section=GOALS)


def _modes(result: Result) -> Iterator[tuple[str, str]]:
    system = result.certification.system
    if not isinstance(result.loaded.spec, InteractionDesignSpec):
        names = list_first([mode.name for mode in system.modes], 4)
        yield "Modes", Linked(f"{names}; {system.time} time", section=MODES)


def _force(result: Result) -> Iterator[tuple[str, str]]:
    system = result.certification.system
    spec = result.loaded.spec
    if not isinstance(spec, InteractionDesignSpec):
        return
    bound = bound_on(system, result.certification.statements, "force")
    text = "not bounded: no disturbance is declared" if not system.channels else "no bound proved"
    if bound is not None:
        size = f"{upper(bound.level, _DIGITS)} {bound.output.unit}"
        text = f"{size} at most, under the declared disturbances"
    yield "Largest force", Linked(text, section=EVIDENCE)


def _gains(result: Result) -> Iterator[tuple[str, str]]:
    design = result.design
    if design is None:
        return
    for controller in design.controllers:
        units = design.units.get(controller.name, {})
        said = ", ".join(
            f"{gain} {float(value):.6g} {units.get(gain, '')}".rstrip()
            for gain, value in controller.law.gains.items()
        )
        if said:
            yield f"Gains of {controller.name}", Linked(said, section="Designed gains")


def _achieved(analysis: DesignAnalysis | None) -> Iterator[tuple[str, str]]:
    if analysis is None or not analysis.impedance:
        return
    known = [item for item in analysis.impedance if not math.isnan(item.lowest_limit)]
    if known:
        weakest = min(known, key=lambda item: item.lowest_limit)
        arm = weakest.limit_at_arm
        limit, per = (weakest.lowest_limit, unit("N*m/rad")) if arm is None else (arm, "N/m")
        size = "any stiffness" if math.isinf(limit) else f"{lower(Fraction(limit), _DIGITS)} {per}"
        yield "Stands up to", Linked(f"{size} ({weakest.name}; floating point)", section=GOALS)
    if [*_worst(analysis)]:
        return
    worst = max(analysis.impedance, key=lambda item: item.worst(SENSITIVITY_PEAK).value)
    value = SENSITIVITY_PEAK.text(worst.worst(SENSITIVITY_PEAK).value)
    said = f"sensitivity peak {value} ({worst.name}; usual: {SENSITIVITY_PEAK.usual})"
    yield "Worst margin", Linked(said, section=GOALS)
