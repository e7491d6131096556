"""The top of the report: two plain sentences, and lights for what a reader looks for first.

The sentences say less than the claim where that is needed to be plain, and never more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.certificates.catalogue import KEPT, catalogue_kind
from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.bounds import lower, upper
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import constants_words
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted, exact_text
from nrs_design.reporting.document import Derived, Light, Sentence, State
from nrs_design.reporting.evidence import page_of
from nrs_design.reporting.register import register_of
from nrs_design.reporting.sections.goals import judged_goals
from nrs_design.reporting.sections.head import proved_rate, saturated
from nrs_design.reporting.sections.titles import (
    ASSUMPTIONS,
    EVIDENCE,
    GOALS,
    MEANT,
    MODES,
    SATURATION,
)
from nrs_design.spec import InteractionDesignSpec

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.pipeline.certification import Result

_PROOF = {
    Verdict.PROVED: (State.GOOD, "proved; exact arithmetic decided, and a second library agreed"),
    Verdict.REFUTED: (State.BAD, "refuted, with a witness"),
    Verdict.INCONCLUSIVE: (State.DOUBTFUL, "inconclusive: a gate must treat it as a failure"),
}


def summary_of(result: Result) -> tuple[str, str]:
    """Return what was shown, and under which assumptions, in a sentence each."""
    system, evidence = result.certification.system, result.certification.evidence
    register = register_of(result.certification.granted, result.loaded.spec)
    names = "; ".join(dict.fromkeys(item.kind.name for item in register))
    granted = f"This takes for granted, each as {ASSUMPTIONS} below says it: {names}."
    if evidence is None:
        said = "Neither proved nor refuted: this report makes no statement about stability."
        if (where := result.certification.refuted_in) is not None:
            said = (
                f"Refuted {where}, where the environment would have to pull; with contact that may "
                "be lost, neither proved nor refuted."
            )
        return said, f"What was searched for would have taken for granted: {names}."
    if evidence.shows is Shows.STABILITY:
        return _proved(result, evidence), granted
    kept = _grown(system, evidence)
    if system.roundings:
        kept += ", for exact arithmetic"
    name = page_of(system, evidence).name
    return (
        f"Refuted: no guarantee of stability is possible under {_signals(system)}{kept}; the "
        f"witness: {name}.",
        granted,
    )


def _grown(system: SwitchedSystem, evidence: AbstractEvidence) -> str:
    """State whether the growth needs kept contact."""
    if system.contact is None and system.flights is None:
        return ""
    if evidence.covers_loss(system):
        return ", with contact that is lost and made as a motion itself says"
    return ", in kept contact"


def _proved(result: Result, evidence: AbstractEvidence) -> str:
    system = result.certification.system
    ranged = result.loaded.spec.has_ranges
    among = counted(len(system.modes), "mode")
    if system.contact is not None and evidence.covers_lost_contact:
        among += f" in contact and {len(system.contact.free)} of free motion"
    unsaturated = "while no signal saturates, " if system.saturation is not None else ""
    parts = [
        Sentence(f"Proved: {unsaturated}under {_signals(system)}, among ", Derived(among, MODES)),
        *_contact(system, evidence),
        "every motion dies out" + (", for all values in the declared ranges" if ranged else ""),
        _rate(system, evidence),
    ]
    if system.roundings:
        parts.append(
            "with what the processor rounds"
            if evidence.covers_rounding
            else "for a law computed without rounding"
        )
    bounds = (item.bound(system) for item in result.certification.statements)
    unbounded = system.channels and not any(bound is not None for bound in bounds)
    more = ("; no bound under the disturbances of the spec is proved",) if unbounded else ()
    joined = (piece for part in parts[1:] for piece in (", ", part))
    return Sentence(parts[0], *joined, *_saturated(result), *more, ".")


def _saturated(result: Result) -> tuple[str, ...]:
    """State the proved decay under saturation; the rate above excludes saturation."""
    saturation = result.certification.system.saturation
    if saturation is None:
        return ()
    found = saturated(result.certification)
    if found is None:
        return ("; where signals saturate, nothing is proved",)
    rate, start = found
    names = " and ".join(s.name for s in saturation.signals)
    return (
        f"; where {names} saturate, motions that begin {start} die out at a rate of at least ",
        Derived(f"{lower(rate)} 1/s", SATURATION),
        ", and of others nothing is said",
    )


def _signals(system: SwitchedSystem) -> str:
    if system.has_constants:
        return f"the declared switching, with {constants_words(system.switching)} constant"
    if system.switching.is_arbitrary and not system.switching.resets:
        return "arbitrary switching"
    return "every switching that the spec declares, and no other"


def _contact(system: SwitchedSystem, evidence: AbstractEvidence) -> tuple[str, ...]:
    kept = any(catalogue_kind(item).id == KEPT for item in system.assumptions)
    if system.contact is None and system.flights is None and not kept:
        return ()
    if not kept and (evidence.covers_lost_contact or system.flights is not None):
        return (
            "with contact lost and made again at any time (where free motion ends is not claimed)",
        )
    return ("as long as contact is kept",)


def _rate(system: SwitchedSystem, evidence: AbstractEvidence) -> str:
    rate = proved_rate(system, evidence)
    if rate is None:
        return "at some rate"
    if system.time is Time.CONTINUOUS:
        begin, text = "at a rate of at least ", f"{lower(rate)} 1/s"
    else:
        begin, text = "by a factor of at most ", f"{upper(rate)} per step"
        if system.sample_time is not None:
            text += f" of {exact_text(system.sample_time)} s"
    attained = "" if evidence.attains_rate else " (not attained)"
    once = "" if evidence.bounds_at_once else ", up to one constant factor"
    return Sentence(begin, Derived(text, EVIDENCE), attained, once)


def lights_of(result: Result, analysis: DesignAnalysis | None) -> tuple[Light, ...]:
    """Return the lights for proof, goals, design, doubts of the data and open assumptions."""
    state, text = _PROOF[Verdict(result.certification.verdict)]
    if (where := result.certification.refuted_in) is not None:
        text = f"{text}; refuted {where}"
    proof = Light("Proof", state, text, MEANT)
    spec = result.loaded.spec
    if not isinstance(spec, InteractionDesignSpec):
        return (proof, _open(result))
    goals = Light("Goals", *judged_goals(result, analysis), GOALS)
    return (proof, goals, _warnings(spec, analysis), _data(spec), _open(result))


def _warnings(spec: InteractionDesignSpec, analysis: DesignAnalysis | None) -> Light:
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
