"""The box of the report: meaning and limits of the verdict."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.certificates.bounds import keeps_command
from nrs_design.certificates.certificate import CommonQuadraticStatus
from nrs_design.pipeline.certification import Result
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Bullets, Paragraph, Section
from nrs_design.reporting.evidence import page_of
from nrs_design.reporting.evidence.words import all_corners
from nrs_design.reporting.sections.head import NO_CLAIM
from nrs_design.reporting.sections.titles import MEANT
from nrs_design.search.certification import Certification
from nrs_design.spec import InteractionDesignSpec

_CONTINUOUS = "Sampling, delay and quantization of the controller: the proof is in continuous time."
_TIMING = "Periods, and times of commands, other than those that the spec says."
_ROUNDING = "What the processor rounds."
_CONTACT_LOSS = "Loss of contact: no mode describes a compliant controller in free motion."
_COUPLING = "Coupling between the axes of the robot."
_UNBOUNDED = "The size of velocities and torques: the states decay, but no limit on them is proved."
_BOUNDED = "Sizes of velocities and torques other than those bounded above."
_SATURATED = "Friction, backlash, and saturation of motor or driver."
_REGIONAL_SATURATION = (
    "Friction, backlash, and saturation but for that of the commands in motions that begin within "
    "what is stated above."
)
_UNSATURATED = (
    "Friction, backlash, and saturation of motor or driver in motions that begin away from rest; "
    "from rest under the disturbances at which the motor command keeps its limit, as bounded "
    "above, the driver does not saturate."
)
_NOT_COVERED_BY_A_DESIGN: tuple[str, ...] = (
    "Tissue that does not follow the linear law of the spec, such as a creep of another kind or a "
    "stiffness that depends on depth.",
    "Parameter values outside the declared ranges, and motor constants other than those given.",
    "Cost, pole positions and tracking, and margins that no goal calls proved: floating point.",
)
_UNDECIDING = "The figures are floating-point illustrations and no part of the decision."
_GAINS = "The gains in the proof are the single-precision numbers below, not their rounded display."
_NO_QUADRATIC = "No common quadratic function exists for these modes; the proof does not need one."
_ILLUSTRATIONS = (
    "The figures and the numbers in the tables are floating-point illustrations and no part of "
    "the proof."
)


def proof_section(result: Result) -> Section:
    """Return the section on meaning and limits of the verdict."""
    certification = result.certification
    evidence = certification.evidence
    if evidence is None:
        blocks = _inconclusive(certification)
    elif evidence.shows is Shows.STABILITY:
        blocks = _proved(result, evidence)
    else:
        blocks = _refuted(certification, evidence)
    return Section(MEANT, blocks, boxed=True)


def _proved(result: Result, evidence: AbstractEvidence) -> tuple[Block, ...]:
    system = result.certification.system
    page, design = page_of(system, evidence), isinstance(result.loaded.spec, InteractionDesignSpec)
    proved = [evidence.claim(system), *page.meaning]
    if result.loaded.spec.has_ranges:
        proved.append(all_corners(system, evidence, page.changing))
    if design:
        proved.append(_GAINS)
    proved += _bounds(result.certification)
    proved += _saturation_claims(result)
    common = _not_covered_by_design(result) if design else _not_covered(system, evidence)
    blocks: list[Block] = [
        Bullets("Proved", tuple(dict.fromkeys(proved))),
        Bullets("Not proved", (*page.limits, *common)),
    ]
    if result.certification.common_quadratic is CommonQuadraticStatus.IMPOSSIBLE:
        blocks.append(Paragraph(_NO_QUADRATIC))
    return (*blocks, Paragraph(_ILLUSTRATIONS))


def _bounds(certification: Certification) -> list[str]:
    """State the bounds on outputs."""
    return [
        item.claim(certification.system)
        for item in certification.statements
        if item.shows is Shows.BOUND
    ]


def _saturation_claims(result: Result) -> Iterator[str]:
    """Yield the claims about saturation."""
    system, has_ranges = result.certification.system, result.loaded.spec.has_ranges
    for item in result.certification.statements:
        if item.shows is Shows.REGION:
            yield item.claim(system)
            if has_ranges:
                yield all_corners(system, item, page_of(system, item).changing)


def _not_covered_by_design(result: Result) -> tuple[str, ...]:
    """Say what a proof about an interaction design leaves open."""
    certification = result.certification
    system, evidence = certification.system, certification.evidence
    covers_contact_loss = evidence is not None and evidence.covers_lost_contact
    exact = evidence is None or not evidence.covers_rounding
    driven = keeps_command(system, certification.statements)
    regional = any(item.shows is Shows.REGION for item in certification.statements)
    return (
        *((_CONTINUOUS,) if system.time is Time.CONTINUOUS else (_TIMING, *(_ROUNDING,) * exact)),
        *(() if covers_contact_loss else (_CONTACT_LOSS,)),
        _COUPLING,
        _REGIONAL_SATURATION if regional else _UNSATURATED if driven else _SATURATED,
        *_NOT_COVERED_BY_A_DESIGN,
        _BOUNDED if _bounds(certification) else _UNBOUNDED,
    )


def _not_covered(system: SwitchedSystem, evidence: AbstractEvidence) -> tuple[str, ...]:
    jumps = "jumps of the state at a switch"
    if system.switching.resets:
        jumps = "jumps of the state other than the declared resets"
    mixture_note = " (and outside their convex combinations)"
    return (
        "Whether the matrices describe the real system: they are taken from the spec as they are.",
        f"Inputs, disturbances, and {jumps}.",
        f"Dynamics outside the modes{mixture_note if evidence.covers_mixtures else ''}.",
        "Sampling, delay, quantization, friction and saturation, unless the matrices contain them.",
        "The size of the states in physical units.",
    )


def _refuted(certification: Certification, evidence: AbstractEvidence) -> tuple[Block, ...]:
    page = page_of(certification.system, evidence)
    claimed = (evidence.claim(certification.system), *page.meaning)
    return Bullets("Refuted", claimed), Bullets("Not said", (*page.limits, _UNDECIDING))


def _inconclusive(certification: Certification) -> tuple[Block, ...]:
    system, statements = certification.system, certification.statements
    texts = [
        NO_CLAIM,
        "Every search that was asked for has ended without evidence that decides; the rungs that "
        "were tried are listed below.",
        *(statement.claim(system) for statement in statements),
        *dict.fromkeys(text for item in statements for text in page_of(system, item).meaning),
    ]
    if certification.common_quadratic is CommonQuadraticStatus.IMPOSSIBLE:
        may = "The system may be stable with a function of another kind"
    else:
        may = (
            "A common quadratic function may exist and have been missed, or the system may be "
            "stable without one"
        )
    texts.append(f"{may}, or some switching signal may make it unstable.")
    contact = certification.refuted_in
    title = "Neither proved nor refuted" if contact is None else f"Open; refuted {contact}"
    return (Bullets(title, tuple(texts)),)
