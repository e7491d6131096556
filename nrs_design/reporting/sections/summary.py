"""The top of the report: what the terminal says, and lights for what a reader looks for first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.certificates.catalogue import CONTACT_KEPT, catalogue_kind
from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.evidence import Shows
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Light, State
from nrs_design.reporting.register import register_of
from nrs_design.reporting.sections.goals import judged_goals
from nrs_design.reporting.sections.titles import ASSUMPTIONS, GOALS, MEANT
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
        return _proved(result), granted
    (witness,) = (b for s, b in result.briefs if s is evidence)
    exact = ", for exact arithmetic" if system.roundings else ""
    return f"Refuted: {witness}{exact}: no guarantee of stability is possible.", granted


def _proved(result: Result) -> str:
    """Say what the terminal says of what is proved, and beside it what is not."""
    certification, ranged = result.certification, result.loaded.spec.has_ranges
    system, evidence = certification.system, certification.evidence
    said = {s.shows: brief for s, brief in reversed(result.briefs)}
    kept = any(catalogue_kind(item).id == CONTACT_KEPT for item in system.assumptions)
    once = evidence is None or evidence.bounds_at_once
    exact = evidence is None or not evidence.covers_rounding
    notes = (
        (", as long as contact is kept", kept and system.contact is None),
        (", up to one constant factor", not once),
        (", for a law computed without rounding", bool(system.roundings) and exact),
        (", for all values in the declared ranges", ranged),
    )
    saturated, bounded = system.saturation is not None, Shows.BOUND in said
    begin = "while no signal saturates, " if saturated else ""
    first = said[Shows.STABILITY] + "".join(text for text, applies in notes if applies)
    others = [brief for s, brief in result.briefs if s.shows in (Shows.BOUND, Shows.REGION)]
    if saturated and Shows.REGION not in said:
        others.append("where signals saturate, nothing is proved")
    if system.channels and not bounded:
        others.append("no bound under the disturbances of the spec is proved")
    return f"Proved: {begin}{'; '.join((first, *others))}."


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
