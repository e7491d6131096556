"""What the verdict says, what it does not say, and how to check it again."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design import __version__
from nrs_design.certificates.certificate import CommonQuadratic, claim, rate_text
from nrs_design.reporting.document import Block, Bullets, Paragraph, Section
from nrs_design.reporting.formatting import plural
from nrs_design.spec import InteractionDesignSpec, RobotSpec
from nrs_design.switched.system import SwitchedSystem, Time

if TYPE_CHECKING:
    from nrs_design.certificates.certify import Certification
    from nrs_design.pipeline import Result

NO_CLAIM = (
    "Neither a proof nor a refutation was found. This is no statement about stability: the modes "
    "may be stable or unstable under switching."
)
_NOT_COVERED_BY_A_DESIGN: tuple[str, ...] = (
    "Sampling, delay and quantization of the controller: the proof is in continuous time.",
    "Friction, backlash, and saturation of motor or driver.",
    "Loss of contact: no mode describes a compliant controller in free motion.",
    "Tissue that does not follow the linear model of the spec, such as viscous creep or a "
    "stiffness that depends on depth.",
    "Parameter values outside the declared ranges, and motor constants other than those given.",
    "Coupling between the axes of the robot.",
    "The size of velocities and torques: the states decay, but no limit on them is proved.",
    "Cost, margins, pole positions and tracking quality: design values in floating point.",
)
_NOT_COVERED_BY_MATRICES: tuple[str, ...] = (
    "Whether the matrices describe the real system: they are taken from the spec as they are.",
    "Inputs, disturbances, and jumps of the state at a switch.",
    "Dynamics outside the modes (and outside their convex combinations).",
    "Sampling, delay, quantization, friction and saturation, unless the matrices contain them.",
    "The size of the states in physical units.",
)


def claim_of(certification: Certification) -> str:
    """Return what the certificate claims, or that there is nothing to claim."""
    if certification.evidence is None:
        return NO_CLAIM
    return claim(certification.system, certification.evidence)


def facts(result: Result) -> tuple[tuple[str, str], ...]:
    """Return hashes, versions and rates for the head of the report."""
    certification = result.certification
    system = certification.system
    spec = result.loaded.spec
    assert not isinstance(spec, RobotSpec)
    count = f"{plural(len(system.modes), 'mode')} of {plural(system.order, 'state')}"
    rows = [
        ("Spec", result.loaded.spec.name),
        ("Switching", f"{spec.switching}, among {count}, {system.time} time"),
        ("Common quadratic function", str(certification.common_quadratic)),
        ("Settled by", certification.method if certification.evidence else "nothing"),
        *_rate(certification),
    ]
    if result.coordinates is not None:
        rows.append(("Coordinates", result.coordinates))
    rows += [
        ("Package", f"nrs-design {__version__}"),
        ("SHA-256 of the spec", result.loaded.sha256),
        ("Certificate id", result.certificate.id if result.certificate else "none"),
    ]
    return tuple(rows)


def proof_section(result: Result) -> Section:
    """Explain in plain words what the verdict means and what it leaves open."""
    certification = result.certification
    if certification.verdict == "proved":
        blocks = _proved(result)
    elif certification.verdict == "refuted":
        blocks = _refuted(certification)
    else:
        blocks = _inconclusive(certification)
    return Section("What is and is not proved", blocks, boxed=True)


def recheck_section(result: Result) -> Section:
    """Tell how to check the certificate again without trusting this report."""
    name = result.loaded.spec.name
    if result.certificate is None:
        text = (
            "There is no certificate to check. After a change of the spec, run nrs-design "
            f"certify-switching {result.loaded.path.name} again."
        )
        return Section("How to check again", (Paragraph(text),))
    spec = result.loaded.path.name
    return Section(
        "How to check again",
        (
            Paragraph("This page is no proof; the certificate is. To check it again, run:"),
            Bullets("", (f"nrs-design verify {name}.cert.json {spec}",)),
            Paragraph(
                "This assembles the modes anew from the spec and decides everything in integer "
                "arithmetic; it runs no solver and uses no number of this page. The id of the "
                "certificate and the hash of the spec must be those at the head of this report. "
                f"The certificate is the file that nrs-design certify-switching {spec} writes."
            ),
        ),
    )


def _rate(certification: Certification) -> list[tuple[str, str]]:
    evidence, time = certification.evidence, certification.system.time
    if not isinstance(evidence, CommonQuadratic):
        return []
    text = rate_text(evidence.rate, time)
    if time is Time.CONTINUOUS:
        return [("Proved decay rate alpha", f"{text} 1/s")]
    return [("Proved contraction rho", f"{text} per step")]


def _proved(result: Result) -> tuple[Block, ...]:
    certification = result.certification
    design = isinstance(result.loaded.spec, InteractionDesignSpec)
    not_covered = _NOT_COVERED_BY_A_DESIGN if design else _NOT_COVERED_BY_MATRICES
    return (
        Bullets("Proved", (claim_of(certification), *_meaning(certification.system, design))),
        Bullets("Not proved", not_covered),
        Paragraph(
            "The figures and the numbers in the tables are floating-point illustrations and no "
            "part of the proof."
        ),
    )


def _meaning(system: SwitchedSystem, design: bool) -> tuple[str, ...]:
    if system.time is Time.CONTINUOUS:
        bound = (
            "The bound means: measured by |x|, the distance from rest shrinks at least by the "
            "factor exp(-alpha T) in every time T, from the first moment on and whatever switches "
            "happen. In another norm the same rate holds with a constant factor in front."
        )
    else:
        bound = (
            "The bound means: measured by |x|, the distance from rest shrinks at least by the "
            "factor rho in every step, whatever switches happen. In another norm the same factor "
            "per step holds with a constant in front."
        )
    exact = (
        "The decision is exact: the modes are rational matrices, Q holds integers over a power of "
        "two, and integer arithmetic decides that Q is positive definite and decreases in every "
        "mode. The solver only proposed Q; a second library agreed."
    )
    corners = (
        "Every corner of the declared parameter ranges is a mode. The matrices depend on the "
        "parameters affinely, so all values between the corners are covered as well, however fast "
        "they change.",
        "The gains in the proof are the single-precision numbers listed below, not their rounded "
        "display.",
    )
    return (bound, exact, *(corners if design else ()))


def _refuted(certification: Certification) -> tuple[Block, ...]:
    region = "left half plane" if certification.system.time is Time.CONTINUOUS else "unit disk"
    return (
        Bullets(
            "Refuted",
            (
                claim_of(certification),
                f"The mode has an eigenvalue outside the open {region}. Staying in this mode "
                "forever is one of the switching signals that the spec allows, so exponential "
                "stability under arbitrary switching is impossible. The decision is exact; the "
                "eigenvalue is printed for the reader.",
            ),
        ),
        Bullets(
            "Not said",
            (
                "Nothing is said about the other modes, nor about switching that avoids this mode "
                "or leaves it soon enough.",
                "An eigenvalue exactly on the border means that states need not decay; they need "
                "not grow either.",
                "The figures are floating-point illustrations and no part of the decision.",
            ),
        ),
    )


def _inconclusive(certification: Certification) -> tuple[Block, ...]:
    return (
        Bullets(
            "Neither proved nor refuted",
            (
                NO_CLAIM,
                "Every search that was asked for has ended without evidence that passes the exact "
                "check; the attempts are listed below. Every mode by itself is stable, or the "
                "mode that is not would have refuted the claim.",
                "A common quadratic function may exist and have been missed, or the system may be "
                "stable without one, or some switching signal may make it unstable.",
            ),
        ),
        Bullets(
            "What may help",
            (
                "Narrower parameter ranges or fewer contacts per controller, where the robot "
                "allows it; more damping; modes that are more alike.",
                "Do not ship the design on this report: a gate must treat it as a failure.",
            ),
        ),
    )
