"""Short claims of statements; the whole claim is in the certificate."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.proof.bounds import at_least, at_most, lower, upper
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.evidence.abstract import AT_ANY_DEFLECTION, IN_KEPT_CONTACT, Bound, Shows
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted

DIGITS = 4


def brief(evidence: AbstractEvidence, system: SwitchedSystem, arm: Fraction | None = None) -> str:
    """Say what a checked statement shows: its number first, and for which signals and contact.

    `arm` is the distance from the pivot in m at which a bound of a torque is said as a force, too.
    """
    match evidence.shows:
        case Shows.STABILITY:
            return _decay(evidence.proved_rate(system), system) + _scope(evidence, system)
        case Shows.BOUND:
            bound = evidence.bound(system)
            assert bound is not None
            return _bound(bound, arm) + _contact(evidence, system) + _unrounded(evidence, system)
        case Shows.NO_COMMON_QUADRATIC:
            return "no common quadratic function exists"
        case Shows.REGION:
            assert system.saturation is not None
            start, size, start_clause = system.saturation.start, evidence.start_size, ""
            if size is not None:
                largest_start = f"{lower(size, DIGITS)} {start.unit}".rstrip()
                start_clause = f" with a {start.name} up to {largest_start}{start.exception}"
            scope = _contact(evidence, system) + _unrounded(evidence, system)
            return f"although signals saturate, decays from rest{start_clause}{scope}"
        case _:
            # The growing signal stands before a colon, or before the second sentence.
            claim = evidence.claim_in_scope(system)
            signal = claim.rpartition(": ")[0] or claim.partition(". ")[0]
            return signal + _growing_contact(evidence, system)


def _decay(rate: Fraction | None, system: SwitchedSystem) -> str:
    """Say how fast, in seconds where a step has a length."""
    if rate is None:
        return "decays"
    if system.time is Time.DISCRETE and system.sample_time is None:
        return f"decays with rho {at_most(rate)} per step"
    # -log(rho) >= 1 - rho
    step = system.sample_time
    alpha = rate if step is None else (1 - rate) / step
    time_constant = f"time constant at most {_seconds(1 / alpha)}"
    rho = "" if step is None else f", rho {at_most(rate)} per step"
    return f"decays with alpha {at_least(alpha, '1/s')} ({time_constant}{rho})"


def _seconds(time: Fraction) -> str:
    """Write a time, rounded up, in a unit in which it is easily read."""
    return f"{upper(1000 * time, 3)} ms" if time < 1 else f"{upper(time, 3)} s"


def _scope(evidence: AbstractEvidence, system: SwitchedSystem) -> str:
    switching = system.switching
    signals = "the declared rules of switching"
    if system.has_constants:
        signals = "any switching, at constant parameters"
    elif switching.is_arbitrary:
        signals = f"any switching among {counted(len(system.modes), 'mode')}"
    if system.clock is not None:
        signals += _rule(system.clock)
    rounding_clause = ", rounding included" if system.roundings and evidence.covers_rounding else ""
    exclusion = rounding_clause or _unrounded(evidence, system)
    return f" under {signals}{_contact(evidence, system)}{exclusion}"


def _rule(clock: Clock) -> str:
    """Return the schedule of the modes in words."""
    if clock.is_round:
        return f", in rounds of {clock.length} steps"
    return " after dwell times" if clock.counts_stays else ", deadlines missed as the rule allows"


def _unrounded(evidence: AbstractEvidence, system: SwitchedSystem) -> str:
    """Say that a statement leaves out the rounding of the law, if it has any."""
    covered = not system.roundings or evidence.covers_rounding
    return "" if covered else ", for the law computed without rounding"


def _contact(evidence: AbstractEvidence, system: SwitchedSystem) -> str:
    # Free motion among the modes is covered by a statement about all of them.
    if system.flights is not None:
        return ", contact may be lost"
    if system.contact is None:
        return ""
    return (
        ", contact may be lost" if evidence.covers_lost_contact else ", as long as contact is kept"
    )


def _growing_contact(evidence: AbstractEvidence, system: SwitchedSystem) -> str:
    if evidence.covers_lost_contact:
        return ", contact lost and made as that motion says"
    if evidence.covers_loss(system):
        return ""
    if system.flights is not None:
        return f", {AT_ANY_DEFLECTION}"
    return f", {IN_KEPT_CONTACT}" if system.contact is not None else ""


def _bound(bound: Bound, arm: Fraction | None) -> str:
    sizes = [f"|{c.name}| <= {lower(c.bound, DIGITS)} {c.unit}".rstrip() for c in bound.channels]
    unit, limit, notes = bound.output.unit, bound.output.limit, []
    if arm is not None and unit == "N*m":
        notes.append(f"{upper(bound.level / arm, DIGITS)} N at {float(arm):g} m")
    if limit is not None:
        limit_note = "within" if bound.level <= limit else "not shown to keep"
        notes.append(f"{limit_note} its limit of {lower(limit, DIGITS)} {unit}")
    level = f"{upper(bound.level, DIGITS)} {unit}".rstrip()
    notes_clause = f" ({'; '.join(notes)})" if notes else ""
    return f"|{bound.output.name}| <= {level}{notes_clause} from rest while {', '.join(sizes)}"
