"""Sentences about proofs: meaning of a bound, assumptions and decision."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.proof.bounds import rounded_up
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.formatting import list_first

# Modes that a sentence names.
MAX_NAMES = 8

_DECIDED = (
    "The decision is exact: the modes are rational matrices, the numbers of the certificate are "
    "integers over a power of two, and exact arithmetic decides that every form is positive "
    "definite and every inequality of the claim holds. The solver only proposed the numbers"
)
_ROUNDS = (
    "A round is what both loops take to meet again, and each step of it has a function of its own, "
    "which decreases to that of the next step. The claim is about every sample of the faster loop."
)
_MISSES = (
    "Each state of the rule for missed deadlines has a function of its own, which decreases to "
    "that of the state to which a period in time, or a missed one, leads. The claim is about every "
    "sample."
)
_DWELL_TEXT = (
    "While a controller is in force, its function decreases faster than the claim. So the "
    "functions of a stay grow from sample to sample, up to its dwell time, and leave room for the "
    "rise at a switch. The claim is about every sample."
)
_FREE_MOTION = (
    "In free motion the deflection is left out of the function. So it measures motion, force and "
    "penetration, and not how far the axis has moved away from the surface: once it has come to "
    "rest in the air, it stays there."
)
_MOVED_REST = (
    "A force reference or a velocity command that pushes into the environment: they move the point "
    "of rest, and the bound is about the point of rest without them."
)


def decay_factor(system: SwitchedSystem) -> str:
    """Say by which factor the proved rate shrinks the distance from rest."""
    continuous = system.time is Time.CONTINUOUS
    return "exp(-alpha T) in every time T" if continuous else "rho in every step"


def free_bound(system: SwitchedSystem) -> str:
    """Say what a bound means that holds whatever switches happen."""
    return (
        "The bound means: measured by |x|, the distance from rest shrinks at least by the factor "
        f"{decay_factor(system)}, from the first moment on and whatever switches happen"
        f"{rules_clause(system)}. In "
        "another norm the same rate holds with a constant factor in front."
    )


def rules_clause(system: SwitchedSystem) -> str:
    """Say that switches keep the rules that a clock holds, if it holds any."""
    ruled = system.clock is not None and not system.clock.is_round
    return ", as the rules allow" if ruled else ""


def ruled_bound(system: SwitchedSystem) -> str:
    """State the meaning of a bound under the declared rules of switching."""
    return (
        "The bound means: for every signal that keeps the rules, the distance from rest "
        f"shrinks by the factor {decay_factor(system)}, up to one constant c in front. So it may "
        "grow for a while, at first or after a switch, but never above c times the bound."
    )


def needed_rules(system: SwitchedSystem, leaving: tuple[str, ...]) -> Iterator[str]:
    """State the rules of switching and longest stays that the claim assumes."""
    switching = system.switching
    if switching.dwell_time > 0:
        yield (
            f"The dwell time of {_dwell(system)} is part of the claim: the machine itself must "
            "refuse to switch earlier."
        )
    if any(stay.shortest > 0 for _, stay in switching.stays):
        yield (
            "The dwell times of single modes are part of the claim: the machine must refuse to "
            "leave them earlier."
        )
    if leaving:
        yield (
            f"The longest dwell time of {list_first(leaving, MAX_NAMES)} is part of the "
            "claim: the machine itself must leave in time. The function may grow there meanwhile."
        )
    if switching.transitions is not None:
        yield "The list of allowed switches is part of the claim as well."
    if switching.resets:
        yield "The resets are part of the claim: they must act at every switch."


def unneeded_constant(system: SwitchedSystem) -> Iterator[str]:
    """Say that a proof does not need constant parameters to be constant."""
    if system.switching.fixed_ends:
        is_single = len(system.switching.fixed_parameters) < 2
        subject, pronoun = ("the parameter", "it") if is_single else ("the parameters", "they")
        yield f"The proof does not need {subject} to be constant: {pronoun} may change freely."


def unneeded_rules(system: SwitchedSystem) -> Iterator[str]:
    """Say that a proof holds without the rules that are declared, if any are."""
    switching = system.switching
    # With a constant parameter, the list of transitions only keeps its two ends apart.
    has_transitions = switching.transitions is not None and not switching.fixed_ends
    if switching.dwell_time > 0 or switching.stays or has_transitions:
        yield (
            "The proof does not need the declared rules of switching: it holds for arbitrary "
            "switching."
        )


def outside_the_rules(system: SwitchedSystem, leaving: tuple[str, ...]) -> Iterator[str]:
    """Name the signals that a proof under rules does not cover."""
    switching = system.switching
    if switching.dwell_time > 0:
        yield f"Switching earlier than {_dwell(system)} after the last switch."
    if any(stay.shortest > 0 for _, stay in switching.stays):
        yield "Leaving a mode before its own dwell time is over."
    if leaving:
        yield f"Staying longer than declared in {list_first(leaving, MAX_NAMES)}."
    if switching.transitions is not None:
        yield "Switches that the spec does not list."


def decision(system: SwitchedSystem, *, ruled: bool = False) -> str:
    """Say how a proof was decided, and on what.

    `ruled`: it rests on the rules of switching; exponentials over dwell times may be part of it.
    """
    switching, text = system.switching, _DECIDED
    if ruled and system.time is Time.CONTINUOUS and (switching.dwell_time > 0 or switching.stays):
        text += "; exponentials over the dwell time are enclosed rigorously, in balls"
    return f"{text}; a second library agreed."


def all_corners(system: SwitchedSystem, evidence: AbstractEvidence, method: str) -> str:
    """Say that values between the corners of declared ranges are covered."""
    text = (
        "Every corner of the declared parameter ranges is a mode. The matrices are affine in each "
        "parameter alone, or in its inverse, so all values between the corners are covered as "
        f"well, {method}."
    )
    if system.roundings:
        # A sampled loop has matrix exponentials of the motor constants.
        text = (
            "The modes are the corners of what encloses the declared parameter ranges. The "
            "matrices are affine in each parameter, in exponentials of the motor's together, so "
            f"all values in between are covered as well, {method}."
        )
    if system.time is Time.DISCRETE and not evidence.keeps_bound_in_mixtures:
        text += " Between the corners, the bound holds up to a constant factor."
    return text


def function(
    system: SwitchedSystem, *, covers_contact_loss: bool, has_several: bool
) -> Iterator[str]:
    """Explain the functions, unless each of them is a norm of all states.

    `covers_contact_loss`: the functions cover the loss of contact. `has_several`: every mode, or
    every step of a hyperperiod, has its own function.
    """
    if system.clock is not None:
        clock_text = _DWELL_TEXT if system.clock.counts_stays else _MISSES
        yield _ROUNDS if system.clock.is_round else clock_text
    elif covers_contact_loss and has_several:
        yield "Each mode has a function; the largest of them decreases in every step."
    if covers_contact_loss:
        yield _FREE_MOTION


def function_limits(system: SwitchedSystem, *, covers_contact_loss: bool) -> Iterator[str]:
    """State limits of a proof with functions; `lost`: they cover the loss of contact."""
    if covers_contact_loss or system.clock is not None:
        yield _MOVED_REST
    if system.clock is not None and system.clock.counts_stays:
        yield "Switches that come before a dwell time has passed."
    elif system.clock is not None and not system.clock.is_round:
        yield "More missed deadlines than the rule allows, or others than it says."
    elif system.clock is not None:
        yield "Two loops whose periods drift against each other: they meet at every round."


NO_FORECAST = (
    "It is not said that the robot will do this: that depends on whether such a signal ever "
    "occurs. It is said that no guarantee is possible for all the signals that the spec "
    "allows."
)


def _dwell(system: SwitchedSystem) -> str:
    unit = "s" if system.time is Time.CONTINUOUS else "steps"
    return rounded_up(system.switching.dwell_time, unit)
