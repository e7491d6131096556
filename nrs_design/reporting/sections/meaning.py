"""What a kind of evidence means for the reader, and what it leaves open."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.certificates.evidence import (
    AbstractEvidence,
    BlockTriangular,
    CommonPolynomial,
    CommonQuadratic,
    ModePolynomial,
    ModeQuadratic,
    ParameterQuadratic,
    UnstableMixture,
    UnstableMode,
    UnstablePeriod,
    UnstableValue,
)
from nrs_design.reporting.formatting import shortened
from nrs_design.spec.bounds import rounded_up
from nrs_design.switched.constant import system_at
from nrs_design.switched.system import SwitchedSystem, Time

# What rests on the declared rules of switching.
_RULED = (ModeQuadratic, ModePolynomial)
# Modes that a sentence names.
_NAMED = 8
# How a proof was decided, by the kind of evidence.
_DECIDED: dict[type[AbstractEvidence], str] = {
    CommonQuadratic: (
        "Q holds integers over a power of two, and integer arithmetic decides that Q is positive "
        "definite and decreases in every mode. The solver only proposed Q"
    ),
    CommonPolynomial: (
        "Q and the forms that vanish hold integers, and integer arithmetic decides that Q is "
        "positive definite in the monomials and that V decreases in every mode. The solver only "
        "proposed them"
    ),
    ModeQuadratic: (
        "every Q holds integers over a power of two, and integer arithmetic decides that each is "
        "positive definite, that it decreases in its mode if that may last, and that no admissible "
        "switch raises the function. The solver only proposed them"
    ),
    ModePolynomial: (
        "every Q and every form that vanishes hold integers, and integer arithmetic decides that "
        "each Q is positive definite in the monomials, that its polynomial decreases in its mode, "
        "and that no admissible switch raises the function. The solver only proposed them"
    ),
    ParameterQuadratic: (
        "the decrease is a polynomial of degree two in the parameter, and integer arithmetic "
        "decides that its three matrices are positive definite, so that all values between the "
        "ends are covered. The solver only proposed Q at both ends"
    ),
    BlockTriangular: (
        "the zeros between the blocks are found in the exact matrices, and each block's evidence "
        "is decided in integer arithmetic. Solvers only proposed it"
    ),
}


def bound_meaning(system: SwitchedSystem, evidence: AbstractEvidence) -> str:
    """Say what the proved bound means."""
    continuous = system.time is Time.CONTINUOUS
    factor = "exp(-alpha T) in every time T" if continuous else "rho in every step"
    if isinstance(evidence, _RULED):
        return (
            "The bound means: for every signal that keeps the rules, the distance from rest "
            f"shrinks by the factor {factor}, up to one constant c in front. So it may grow for a "
            "while, at first or after a switch, but never above c times the bound."
        )
    if isinstance(evidence, BlockTriangular):
        return (
            "The bound means: whatever switches happen, the distance from rest shrinks at any rate "
            "slower than that of the slowest block, up to a constant factor in front. Where blocks "
            "are coupled, it may grow for a while before it decays."
        )
    text = (
        "The bound means: measured by |x|, the distance from rest shrinks at least by the factor "
        f"{factor}, from the first moment on and whatever switches happen. In another norm the "
        "same rate holds with a constant factor in front."
    )
    if isinstance(evidence, ParameterQuadratic):
        text += " Which norm |x| is, depends on the value of the parameter."
    return text


def rules_meaning(system: SwitchedSystem, evidence: AbstractEvidence) -> tuple[str, ...]:
    """Say which part the declared rules of switching have in a proof."""
    switching = system.switching
    texts = []
    if isinstance(evidence, _RULED):
        if switching.dwell_time > 0:
            texts.append(
                f"The dwell time of {_dwell(system)} is part of the claim: the machine itself must "
                "refuse to switch earlier."
            )
        texts += _own_dwell_times(system, evidence)
        if switching.transitions is not None:
            texts.append("The list of allowed switches is part of the claim as well.")
        if switching.resets:
            texts.append("The resets are part of the claim: they must act at every switch.")
    elif isinstance(evidence, ParameterQuadratic):
        texts.append(
            "The parameter must be constant: one value in all modes and at all times. Which value "
            "it is, need not be known."
        )
    elif switching.fixed_ends:
        texts.append("The proof does not need the parameter to be constant: it may change freely.")
    # With a constant parameter, the list of transitions only keeps its two ends apart.
    listed = switching.transitions is not None and not switching.fixed_ends
    ruled = switching.dwell_time > 0 or bool(switching.stays) or listed
    if ruled and not isinstance(evidence, _RULED):
        texts.append(
            "The proof does not need the declared rules of switching: it holds for arbitrary "
            "switching."
        )
    return tuple(texts)


def _own_dwell_times(
    system: SwitchedSystem, evidence: ModeQuadratic | ModePolynomial
) -> Iterator[str]:
    if any(stay.shortest > 0 for _, stay in system.switching.stays):
        yield (
            "The dwell times of single modes are part of the claim: the machine must refuse to "
            "leave them earlier."
        )
    if leaving := _leaving(evidence):
        yield (
            f"The longest dwell time of {shortened(leaving, _NAMED)} is part of the "
            "claim: the machine itself must leave in time. The function may grow there meanwhile."
        )


def decision_meaning(system: SwitchedSystem, evidence: AbstractEvidence) -> str:
    """Say how the decision was made."""
    text = f"The decision is exact: the modes are rational matrices, {_DECIDED[type(evidence)]}"
    exponential = (
        isinstance(evidence, _RULED)
        and system.time is Time.CONTINUOUS
        and (system.switching.dwell_time > 0 or bool(system.switching.stays))
    )
    if exponential:
        text += "; exponentials over the dwell time are enclosed rigorously, in balls"
    return f"{text}; a second library agreed."


def corners_meaning(system: SwitchedSystem, evidence: AbstractEvidence) -> str:
    """Say whether values between the corners of declared ranges are covered."""
    how = "however fast they change"
    if isinstance(evidence, ParameterQuadratic):
        how = "however fast they change, the constant one excepted"
    text = (
        "Every corner of the declared parameter ranges is a mode. The matrices are affine in each "
        "parameter alone, or in its inverse, so all values between the corners are covered as "
        f"well, {how}."
    )
    if system.time is Time.DISCRETE and _is_polynomial(evidence):
        # The level sets of V need not be convex, but a joint spectral radius is that of the hull.
        text += " Between the corners, the bound holds up to a constant factor."
    return text


def _is_polynomial(evidence: AbstractEvidence) -> bool:
    if isinstance(evidence, BlockTriangular):
        return any(_is_polynomial(part) for _, part in evidence.parts)
    return isinstance(evidence, CommonPolynomial)


def covers_mixtures(evidence: AbstractEvidence) -> bool:
    """Tell whether a proof covers all convex combinations of the modes."""
    return isinstance(evidence, CommonQuadratic | CommonPolynomial | BlockTriangular)


def excluded_signals(system: SwitchedSystem, evidence: AbstractEvidence) -> tuple[str, ...]:
    """Say which switching signals and parameters a proof does not cover."""
    switching = system.switching
    texts = []
    if isinstance(evidence, _RULED) and switching.dwell_time > 0:
        texts.append(f"Switching earlier than {_dwell(system)} after the last switch.")
    if isinstance(evidence, _RULED) and any(s.shortest > 0 for _, s in switching.stays):
        texts.append("Leaving a mode before its own dwell time is over.")
    if isinstance(evidence, _RULED) and (leaving := _leaving(evidence)):
        texts.append(f"Staying longer than declared in {shortened(leaving, _NAMED)}.")
    if isinstance(evidence, _RULED) and switching.transitions is not None:
        texts.append("Switches that the spec does not list.")
    if isinstance(evidence, ParameterQuadratic):
        texts.append("A parameter that changes while the system moves, however slowly.")
    return tuple(texts)


def _leaving(evidence: ModeQuadratic | ModePolynomial) -> tuple[str, ...]:
    """Return the modes that must be left for the proof to hold."""
    own = evidence.quadratic if isinstance(evidence, ModePolynomial) else evidence
    return own.leaving


def refutation_meaning(system: SwitchedSystem, evidence: AbstractEvidence) -> tuple[str, ...]:
    """Say why the evidence refutes stability."""
    region = "left half plane" if system.time is Time.CONTINUOUS else "unit disk"
    rules = "arbitrary switching" if system.switching.is_arbitrary else "the declared switching"
    if isinstance(evidence, BlockTriangular):
        inner = refutation_meaning(system, evidence.parts[0][1])
        return (
            "The states of one block move by themselves once the later blocks are at rest, so a "
            "family with an unstable block is unstable.",
            *inner,
        )
    if isinstance(evidence, UnstableValue):
        inner = refutation_meaning(system_at(system, evidence.share), evidence.part)
        return (
            "The parameter is unknown and constant, so it may have this one value all the time. "
            "The matrices at this value are computed exactly.",
            *inner,
        )
    if isinstance(evidence, UnstableMode):
        return (
            f"The mode has an eigenvalue outside the open {region}. Staying in this mode forever "
            "is one of the switching signals that the spec allows, so exponential stability under "
            f"{rules} is impossible. The decision is exact; the eigenvalue is printed for the "
            "reader.",
        )
    if isinstance(evidence, UnstablePeriod):
        return (
            "The signal keeps every rule that the spec declares. Repeated forever, it multiplies "
            "some state by a factor above one in every period, so no stability of any kind can be "
            f"guaranteed under {rules}. The matrix of one period is enclosed rigorously; a power "
            "of it has a trace that only an eigenvalue outside the unit circle can explain.",
        )
    return (
        "If the modes were exponentially stable under arbitrary switching, uniformly over all "
        "signals, then so would be every average of them, which fast switching comes near to. "
        "This average is not stable, so no such guarantee is possible. The decision is exact; "
        "the eigenvalue is printed for the reader.",
    )


def refutation_limits(evidence: AbstractEvidence) -> tuple[str, ...]:
    """Say what a refutation does not say."""
    if isinstance(evidence, BlockTriangular):
        return refutation_limits(evidence.parts[0][1])
    if isinstance(evidence, UnstableValue):
        inner = refutation_limits(evidence.part)
        return (
            *inner,
            "Nothing is said about other values of the parameter: a narrower range may be stable.",
        )
    general = (
        "It is not said that the robot will do this: that depends on whether such a signal ever "
        "occurs. It is said that no guarantee is possible for all the signals that the spec "
        "allows."
    )
    border = (
        "An eigenvalue exactly on the border means that states need not decay; they need not grow "
        "either."
    )
    if isinstance(evidence, UnstableMode):
        return (
            general,
            "Nothing is said about the other modes, nor about switching that avoids this mode or "
            "leaves it soon enough.",
            border,
        )
    if isinstance(evidence, UnstableMixture):
        return (
            general,
            "Nothing is said about slower switching: every mode alone may be stable, and a dwell "
            "time may make the family stable.",
            border,
        )
    return (
        general,
        "Nothing is said about other signals: a longer dwell time, fewer transitions or narrower "
        "ranges may make the family stable.",
        "Nothing is said about what saturation or friction would make of the growth.",
    )


def _dwell(system: SwitchedSystem) -> str:
    unit = "s" if system.time is Time.CONTINUOUS else "steps"
    return rounded_up(system.switching.dwell_time, unit)
