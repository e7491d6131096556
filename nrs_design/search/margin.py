"""The largest box of parameters, and the shortest dwell time, that still have a proof."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict, refutes_in_contact
from nrs_design.errors import AssemblyError
from nrs_design.progress import Progress, silent
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.tried import Tried, sharpen, sharpened
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


@dataclass(frozen=True)
class BoxMargin:
    """How far the declared ranges can be stretched about their nominal values."""

    # Largest scale that was proved, 1 being the declared ranges; None if not even the nominal
    # values (scale 0) were.
    proved: Fraction | None
    # Smallest scale that was refuted; None if the search ended without a refutation. What lies
    # between the two is undecided.
    refuted: Fraction | None
    proof: Certification | None  # At the scale `proved`
    end: str = ""  # Where the search for a refutation ended, and why there, if it found none
    # In which contact alone it is refuted, where its loss must be covered; empty for any.
    refuted_in: str = ""


def find_margin(
    assemble: Assemble,
    certify: Certify,
    known: Certification | None = None,
    progress: Progress = silent,
) -> BoxMargin:
    """Bracket the largest provable scale and the smallest refutable one, then bisect both.

    A proof for a box is a proof for every smaller one, and a refutation is one for every larger
    one, so the search needs no more than brackets. Every scale that counts as proved or refuted has
    evidence that passed the exact check. `known`, found at scale 1, perhaps by a longer search, is
    the least that is reported. An `AssemblyError` if not even the nominal values make a system.
    """
    proofs = {} if known is None else {Fraction(1): known}

    def decide(scale: Fraction) -> Certification | str:
        system = _assembled(scale, assemble)
        if isinstance(system, AssemblyError):
            return system.message
        proofs[scale] = certify(system)
        return proofs[scale]

    tried = Tried(decide, progress, "box scaled by")
    if known is not None:
        tried.remember(Fraction(1), known)
    elif tried.makes_no_system(Fraction(0)):
        assemble(Fraction(0))  # Raises what is wrong, and where.
    if not tried.that_are(Verdict.PROVED) and not tried.is_proved(Fraction(0)):
        refuted = _smallest_refuted(tried, assemble)
        return BoxMargin(None, refuted, None, _end(tried, refuted), tried.refuted_in(refuted))
    high = Fraction(1)
    while high <= LARGEST_SCALE and tried.is_proved(high):
        high *= 2
    if high <= LARGEST_SCALE:
        sharpen(max(tried.that_are(Verdict.PROVED)), high, STEPS, tried.is_proved)
    refuted = _smallest_refuted(tried, assemble)
    low = max(tried.that_are(Verdict.PROVED))
    return BoxMargin(low, refuted, proofs[low], _end(tried, refuted), tried.refuted_in(refuted))


def _assembled(scale: Fraction, assemble: Assemble) -> SwitchedSystem | AssemblyError:
    """Return the system at a scale, or what keeps the scale from making one."""
    try:
        return assemble(scale)
    except AssemblyError as error:
        return error


def _end(tried: Tried[Fraction], refuted: Fraction | None) -> str:
    """Say where scales that are not refuted end, and why there; nothing if one is refuted."""
    return "" if refuted is not None else tried.end("scaled by up to", "wider ones make no system")


def _smallest_refuted(tried: Tried[Fraction], assemble: Assemble) -> Fraction | None:
    """Return the smallest scale found to be refuted: from what was tried, or beyond it."""
    high = max(*tried.all(), Fraction(1))
    for _ in range(DOUBLINGS):
        if tried.that_are(Verdict.REFUTED) or tried.makes_no_system(high):
            break
        high *= 2
        tried.is_refuted(high)
    if not tried.that_are(Verdict.REFUTED) and tried.makes_no_system(high):

        def makes_system(scale: Fraction) -> bool:
            system = _assembled(scale, assemble)
            if isinstance(system, AssemblyError):
                tried.remember(scale, system.message)
            return not isinstance(system, AssemblyError)

        tried.is_refuted(sharpen(tried.longest(), high, STEPS, makes_system))
    return sharpened(tried, Verdict.REFUTED, REFUTED_STEPS, up=False)


@dataclass(frozen=True)
class DwellMargin:
    """How short the time between switches may be."""

    # Shortest dwell time that was proved, in s; zero if arbitrary switching is stable; None if none
    # was.
    proved: Fraction | None
    refuted: Fraction | None  # Longest one that was refuted
    proof: Certification | None  # At `proved`
    longest: Fraction  # Longest dwell time that the search has decided about, from zero on
    refuted_in: str = ""  # As of `BoxMargin`


def find_shortest_dwell(
    system: SwitchedSystem,
    certify: Certify,
    known: Certification | None = None,
    progress: Progress = silent,
) -> DwellMargin:
    """Find the largest switching rate that has a proof: the shortest provable dwell time.

    A proof for a dwell time is one for every longer one, and a refutation one for every shorter
    one. The bracket begins at what is known; it is widened by doubling up to the longest dwell time
    that a spec can declare, or narrowed by halving, and then bisected. One for all modes is sought,
    and there are no longest ones.
    """
    proofs: dict[Fraction, Certification] = {}

    def decide(dwell: Fraction) -> Certification:
        switching = replace(system.switching, dwell_time=dwell, stays=())
        # From where motions decay under saturation is no matter of a margin.
        proofs[dwell] = certify(replace(system, switching=switching, saturation=None))
        return proofs[dwell]

    tried, longest = Tried(decide, progress, "dwell time", "s"), Fraction(LONGEST_DWELL)
    if known is not None and (dwell := _common_dwell(system, known)) is not None:
        tried.remember(dwell, known)
        proofs[dwell] = known
    if tried.is_proved(Fraction(0)):
        return DwellMargin(Fraction(0), None, proofs[Fraction(0)], tried.longest())
    if _has_unstable_mode(proofs[Fraction(0)]):
        return DwellMargin(None, longest, None, longest, tried.refuted_in(Fraction(0)))
    proved = min(tried.that_are(Verdict.PROVED), default=None) or _widen(tried, system)
    if proved is None:
        refuted = sharpened(tried, Verdict.REFUTED, REFUTED_STEPS, up=True)
        return DwellMargin(None, refuted, None, longest, tried.refuted_in(refuted))
    for _ in range(HALVINGS):
        if not tried.is_proved(proved / 2):
            break
        proved /= 2
    low = max(dwell for dwell in tried.all() if dwell < proved)
    proved = sharpen(proved, low, DWELL_STEPS, tried.is_proved)
    refuted = sharpened(tried, Verdict.REFUTED, REFUTED_STEPS, up=True)
    where = tried.refuted_in(refuted)
    return DwellMargin(proved, refuted, proofs[proved], tried.longest(), where)


def _common_dwell(system: SwitchedSystem, known: Certification) -> Fraction | None:
    """Return the one dwell time for all modes at which the verdict on their own ones holds, too.

    Where no mode is left sooner than the slowest of them may be, all of them keep their own times;
    a signal that keeps these keeps the shortest of them everywhere.
    """
    times = [stay.shortest for stay in system.stays().values()]
    if known.verdict is Verdict.PROVED:
        return max(times)
    refuted = known.verdict is Verdict.REFUTED or known.refuted_in is not None
    if refuted or min(times) == max(times):
        return min(times)
    return None


def _has_unstable_mode(found: Certification) -> bool:
    """Tell whether a refutation holds for every dwell time."""
    evidence = found.evidence or refutes_in_contact(found.system, found.statements)
    return evidence is not None and evidence.names_unstable_mode


def _widen(tried: Tried[Fraction], system: SwitchedSystem) -> Fraction | None:
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
