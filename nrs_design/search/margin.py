"""The largest box of parameters, and the shortest dwell time, that still have a proof."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import AssemblyError
from nrs_design.proof.bounds import nearly
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec.switching import LONGEST_DWELL

if TYPE_CHECKING:
    from nrs_design.search.certification import Certification

LARGEST_SCALE = 64
STEPS = 8
DWELL_STEPS = 12
# A box that is not decided is slow to try: fewer steps for the smallest one that is refuted.
REFUTED_STEPS = 6
DOUBLINGS = 3
# Proofs for ever shorter dwell times, but none for zero: enough of them.
HALVINGS = 64

Assemble = Callable[[Fraction], SwitchedSystem]
Certify = Callable[[SwitchedSystem], "Certification"]
Outcome = tuple[Verdict | None, "Certification | None"]


@dataclass(frozen=True)
class BoxMargin:
    """How far the declared ranges can be stretched about their nominal values.

    Parameters
    ----------
    proved : Fraction or None
        Largest scale that was proved, 1 being the declared ranges; None if not even the nominal
        values (scale 0) were.
    refuted : Fraction or None
        Smallest scale that was refuted; None if the search ended without a refutation. What lies
        between the two is undecided.
    proof : Certification or None
        At the scale `proved`.
    end : str
        Where the search for a refutation ended, and why there, if it found none.
    """

    proved: Fraction | None
    refuted: Fraction | None
    proof: Certification | None
    end: str = ""


def find_margin(
    assemble: Assemble, certify: Certify, known: Certification | None = None
) -> BoxMargin:
    """Bracket the largest provable scale and the smallest refutable one, then bisect both.

    A proof for a box is a proof for every smaller one, and a refutation is one for every larger
    one, so the search needs no more than brackets. Every scale that counts as proved or refuted
    has evidence that passed the exact check.

    Parameters
    ----------
    assemble : callable
        Gives the system for a scale; an AssemblyError says that the scale makes no sense.
    certify : callable
        Decides a system.
    known : Certification, optional
        What was found at scale 1, perhaps by a longer search: no worse is reported.

    Raises
    ------
    AssemblyError
        If not even the nominal values make a system, so that no box does.
    """
    faults: dict[Fraction, AssemblyError] = {}
    tried = _Tried(lambda scale: _try(scale, assemble, certify, faults))
    if known is not None:
        tried.remember(Fraction(1), known)
    elif tried.makes_no_system(Fraction(0)):
        raise faults[Fraction(0)]
    if not tried.that_are(Verdict.PROVED) and not tried.is_proved(Fraction(0)):
        refuted = _smallest_refuted(tried, assemble, faults)
        return BoxMargin(None, refuted, None, _end(tried, faults, refuted))
    high = Fraction(1)
    while high <= LARGEST_SCALE and tried.is_proved(high):
        high *= 2
    if high <= LARGEST_SCALE:
        _sharpen(max(tried.that_are(Verdict.PROVED)), high, STEPS, tried.is_proved)
    refuted = _smallest_refuted(tried, assemble, faults)
    low = max(tried.that_are(Verdict.PROVED))
    return BoxMargin(low, refuted, tried.certification(low), _end(tried, faults, refuted))


def _end(tried: _Tried, faults: Mapping[Fraction, AssemblyError], refuted: Fraction | None) -> str:
    """Say where scales that are not refuted end, and why there; nothing if one is refuted."""
    if refuted is not None:
        return ""
    longest = max(scale for scale in tried.all() if not tried.makes_no_system(scale))
    beyond = [faults[scale].message for scale in sorted(faults) if scale > longest]
    why = f"wider ones make no system ({beyond[0]})" if beyond else "the search ends there"
    return f"none scaled by up to {nearly(longest)} is refuted: {why}"


def _smallest_refuted(
    tried: _Tried, assemble: Assemble, faults: dict[Fraction, AssemblyError]
) -> Fraction | None:
    """Return the smallest scale found to be refuted: from what was tried, or beyond it."""
    high = max(tried.largest(), Fraction(1))
    for _ in range(DOUBLINGS):
        if tried.that_are(Verdict.REFUTED) or tried.makes_no_system(high):
            break
        high *= 2
        tried.is_refuted(high)
    if not tried.that_are(Verdict.REFUTED) and tried.makes_no_system(high):
        widest = max(scale for scale in tried.all() if not tried.makes_no_system(scale))

        def makes_system(scale: Fraction) -> bool:
            return _assembled(scale, assemble, faults) is not None

        tried.is_refuted(_sharpen(widest, high, STEPS, makes_system))
    refuted = min(tried.that_are(Verdict.REFUTED), default=None)
    below = [scale for scale in tried.all() if refuted is not None and scale < refuted]
    if refuted is None or not below:
        return refuted
    return _sharpen(refuted, max(below), REFUTED_STEPS, tried.is_refuted)


def _sharpen(
    accepted: Fraction, other: Fraction, steps: int, accepts: Callable[[Fraction], bool]
) -> Fraction:
    """Bisect between a number that is accepted and one that is not; return the last accepted."""
    for _ in range(steps):
        middle = (accepted + other) / 2
        if accepts(middle):
            accepted = middle
        else:
            other = middle
    return accepted


class _Tried:
    """What has been tried so far: nothing is tried twice."""

    def __init__(self, decide: Callable[[Fraction], Outcome]) -> None:
        self._decide = decide
        self._outcomes: dict[Fraction, Outcome] = {}

    def __call__(self, number: Fraction) -> Outcome:
        if number not in self._outcomes:
            self._outcomes[number] = self._decide(number)
        return self._outcomes[number]

    def remember(self, number: Fraction, found: Certification) -> None:
        self._outcomes[number] = found.verdict, found

    def is_proved(self, number: Fraction) -> bool:
        return self(number)[0] is Verdict.PROVED

    def is_refuted(self, number: Fraction) -> bool:
        return self(number)[0] is Verdict.REFUTED

    def makes_no_system(self, number: Fraction) -> bool:
        return self(number)[0] is None

    def certification(self, number: Fraction) -> Certification | None:
        return self(number)[1]

    def all(self) -> list[Fraction]:
        return list(self._outcomes)

    def largest(self) -> Fraction:
        return max(self._outcomes)

    def that_are(self, verdict: Verdict) -> list[Fraction]:
        return [number for number, found in self._outcomes.items() if found[0] is verdict]


def _assembled(
    scale: Fraction, assemble: Assemble, faults: dict[Fraction, AssemblyError]
) -> SwitchedSystem | None:
    """Return the system at a scale, or note why the scale makes none."""
    try:
        return assemble(scale)
    except AssemblyError as error:
        faults[scale] = error
        return None


def _try(
    scale: Fraction, assemble: Assemble, certify: Certify, faults: dict[Fraction, AssemblyError]
) -> Outcome:
    """Return the verdict at a scale; None if the scale makes no system."""
    system = _assembled(scale, assemble, faults)
    if system is None:
        return None, None
    certification = certify(system)
    return certification.verdict, certification


@dataclass(frozen=True)
class DwellMargin:
    """How short the time between switches may be.

    Parameters
    ----------
    proved : Fraction or None
        Shortest dwell time that was proved, in s; zero if arbitrary switching is stable; None if
        none was.
    refuted : Fraction or None
        Longest one that was refuted.
    proof : Certification or None
        At `proved`.
    longest : Fraction
        Longest dwell time that the search has decided about, from zero on.
    """

    proved: Fraction | None
    refuted: Fraction | None
    proof: Certification | None
    longest: Fraction


def find_shortest_dwell(
    system: SwitchedSystem, certify: Certify, known: Certification | None = None
) -> DwellMargin:
    """Find the largest switching rate that has a proof: the shortest provable dwell time.

    Parameters
    ----------
    system : SwitchedSystem
        With its own dwell times, perhaps zero; it has no longest ones. One for all modes is sought.
    certify : callable
        Decides a system.
    known : Certification, optional
        What was found for the system as it stands, perhaps by a longer search: no worse is
        reported.

    Notes
    -----
    A proof for a dwell time is one for every longer one, and a refutation one for every shorter
    one. The bracket begins at what is known; it is widened by doubling up to the longest dwell
    time that a spec can declare, or narrowed by halving, and then bisected.
    """

    def decide(dwell: Fraction) -> Outcome:
        switching = replace(system.switching, dwell_time=dwell, stays=())
        # From where motions decay under saturation is no matter of a margin.
        found = certify(replace(system, switching=switching, saturation=None))
        return found.verdict, found

    tried, longest = _Tried(decide), Fraction(LONGEST_DWELL)
    if known is not None and (dwell := _common_dwell(system, known)) is not None:
        tried.remember(dwell, known)
    if tried.is_proved(Fraction(0)):
        return DwellMargin(Fraction(0), None, tried.certification(Fraction(0)), tried.largest())
    if _has_unstable_mode(tried.certification(Fraction(0))):
        return DwellMargin(None, longest, None, longest)
    proved = min(tried.that_are(Verdict.PROVED), default=None) or _widen(tried, system)
    if proved is None:
        return DwellMargin(None, _longest_refuted(tried), None, longest)
    for _ in range(HALVINGS):
        if not tried.is_proved(proved / 2):
            break
        proved /= 2
    low = max(dwell for dwell in tried.all() if dwell < proved)
    proved = _sharpen(proved, low, DWELL_STEPS, tried.is_proved)
    return DwellMargin(
        proved, _longest_refuted(tried), tried.certification(proved), tried.largest()
    )


def _common_dwell(system: SwitchedSystem, known: Certification) -> Fraction | None:
    """Return the one dwell time for all modes at which the verdict on their own ones holds, too.

    Where no mode is left sooner than the slowest of them may be, all of them keep their own times;
    a signal that keeps these keeps the shortest of them everywhere.
    """
    times = [stay.shortest for stay in system.stays().values()]
    if known.verdict is Verdict.PROVED:
        return max(times)
    if known.verdict is Verdict.REFUTED or min(times) == max(times):
        return min(times)
    return None


def _has_unstable_mode(found: Certification | None) -> bool:
    """Tell whether a refutation holds for every dwell time."""
    evidence = None if found is None else found.evidence
    return evidence is not None and evidence.names_unstable_mode


def _widen(tried: _Tried, system: SwitchedSystem) -> Fraction | None:
    """Double the dwell time until it is proved, from the modes' own time or what is refuted."""
    dwell = max((*tried.that_are(Verdict.REFUTED), _fastest_time(system)))
    while dwell < LONGEST_DWELL:
        if tried.is_proved(dwell):
            return dwell
        dwell *= 2
    longest = Fraction(LONGEST_DWELL)
    return longest if tried.is_proved(longest) else None


def _fastest_time(system: SwitchedSystem) -> Fraction:
    """Return a power of two near one over the largest entry of all modes, in s."""
    entries = (abs(e) for mode in system.modes for row in mode.A.fractions() for e in row)
    largest = max(entries, default=Fraction(0)) or Fraction(1)
    size = largest.denominator.bit_length() - largest.numerator.bit_length()
    return Fraction(2) ** size


def _longest_refuted(tried: _Tried) -> Fraction | None:
    refuted = max(tried.that_are(Verdict.REFUTED), default=None)
    above = [dwell for dwell in tried.all() if refuted is not None and dwell > refuted]
    if refuted is None or not above:
        return refuted
    return _sharpen(refuted, min(above), REFUTED_STEPS, tried.is_refuted)
