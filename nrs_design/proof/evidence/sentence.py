"""The sentence that a graph of forms proves, assembled from what it covers."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock, Stay
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted

MAX_NAMED = 8


def ruled_sentence(system: SwitchedSystem, rate: Fraction) -> str:
    """State a bound, up to a constant factor, on every solution that keeps the rules."""
    continuous = system.time is Time.CONTINUOUS
    law, bound = ("x' = A x", "exp(-alpha t)") if continuous else ("x+ = A x", "rho^t")
    return (
        f"Every solution of {law} under the declared switching ({_signals(system)}) satisfies "
        f"|x(t)| <= c {bound} |x(0)| with {rate_words(rate, system.time)} and some constant c "
        "that is the same for all signals."
    )


def free_sentence(
    system: SwitchedSystem,
    rate: Fraction,
    degree: int,
    count: int,
    *,
    lost: bool,
    once: bool,
    alike: bool = True,
) -> str:
    """State a bound on every solution under arbitrary switching.

    The rate is alpha in 1/s, or rho per step; `degree` is half that of the forms, `count` how many
    there are at one place, at most. `once`: the largest of them bounds the state, without a factor
    in front; `alike`: that in free motion is that in contact without the deflection.
    """
    continuous = system.time is Time.CONTINUOUS
    x = "w" if lost else "x"
    modes = f"the {len(system.modes)} modes" if len(system.modes) > 1 else "its one mode"
    parts = []
    clock = system.clock
    if clock is not None and clock.is_round:
        parts.append(f"in rounds of {clock.length} steps,")
    law = "x' = A x" if continuous else "x+ = A x"
    of = "" if x == "w" else f" of {law}"
    among = f"switching arbitrarily among {modes}"
    if lost and system.contact is not None:
        free = counted(len(system.contact.free), "mode")
        among = (
            "with contact lost and made again at any time and switching arbitrarily among "
            f"{counted(len(system.modes), 'mode')} in contact and {free} of free motion"
        )
    if clock is not None:
        kept = ", with contact lost and made again at any time" if lost else ""
        rule = "dwell times allow" if clock.counts_stays else "rule for missed deadlines allows"
        which = "whose turn it is" if clock.is_round else f"that the {rule}"
        among = f"with any mode in force {which}{kept}"
    front = "" if once else "c "
    bound = f"{front}exp(-alpha t) |{x}(0)|" if continuous else f"{front}rho^t |{x}(0)|"
    parts.append(
        f"every solution{of}, {among}, satisfies |{x}(t)| <= {bound} with "
        f"{rate_words(rate, system.time)}"
    )
    text = " ".join(parts)
    text = f"{text[0].upper()}{text[1:]}, {_norm(system, x, degree, count, lost=lost, alike=alike)}"
    text += "" if once else ", and with some constant c that is the same for all signals"
    return f"{text}. Where free motion ends is not claimed." if lost else f"{text}."


def _norm(
    system: SwitchedSystem, x: str, degree: int, count: int, *, lost: bool, alike: bool
) -> str:
    """Say in which norm the bound is."""
    of = [] if system.clock is None else [f"of {_turn(system.clock)}"]
    of += [] if alike else ["of contact or of free motion"]
    which = f" with the Q {' and '.join(of)}" if of else ""
    parts = []
    if lost:
        parts.append(
            f"{x} holds the states other than the deflection, and the deflection where it is "
            "positive"
        )
    if degree > 1:
        form = f"positive definite form{'s' * (count > 1)} of degree {2 * degree} in {x}"
        which = "" if system.clock is None else f", that of {_turn(system.clock)}"
        said = f"the largest of some {form}" if count > 1 else f"a {form}"
        parts.append(f"|{x}|^{2 * degree} is {said}{which}")
    elif count > 1:
        parts.append(f"|{x}| is the largest of all sqrt({x}' Q {x}) there")
    elif lost or which:
        parts.append(f"|{x}| = sqrt({x}' Q {x}){which}")
    else:
        return f"in the norm |{x}| = sqrt({x}' Q {x})"
    return f"where {', and '.join(parts)}"


def _signals(system: SwitchedSystem) -> str:
    """Say which switching signals a system has."""
    switching = system.switching
    unit = "s" if system.time is Time.CONTINUOUS else "steps"
    parts = []
    if switching.dwell_time > 0:
        others = "each other mode" if switching.stays else "each mode"
        parts.append(f"{_time_words(Stay(switching.dwell_time), unit)} in {others}")
    parts += [f"{_time_words(stay, unit)} in {name}" for name, stay in switching.stays[:MAX_NAMED]]
    if len(switching.stays) > MAX_NAMED:
        parts.append(f"{len(switching.stays)} modes with dwell times of their own")
    if switching.transitions is not None:
        parts.append(counted(len(switching.transitions), "allowed transition"))
    if switching.resets:
        parts.append(counted(len(switching.resets), "reset"))
    return ", ".join(parts) or "arbitrary"


def _time_words(stay: Stay, unit: str) -> str:
    """Say how long a mode stays, rounded so that no other stay is claimed to be covered."""
    if stay.longest is None:
        return f"at least {rounded_up(stay.shortest, _unit(unit, stay.shortest))}"
    last = rounded_down(stay.longest, _unit(unit, stay.longest))
    return f"{rounded_up(stay.shortest)} to {last}" if stay.shortest > 0 else f"at most {last}"


def _unit(unit: str, time: Fraction) -> str:
    return "step" if unit == "steps" and time == 1 else unit


def _turn(clock: Clock) -> str:
    """Say what decides which form it is."""
    return "the step of its round" if clock.is_round else "the state of the rule"
