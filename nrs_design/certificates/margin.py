"""The largest box of parameters, and the shortest dwell time, that still have a proof."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import AssemblyError
from nrs_design.switched.system import SwitchedSystem

if TYPE_CHECKING:
    from nrs_design.certificates.certify import Certification

LARGEST_SCALE = 64
STEPS = 8
DWELL_STEPS = 12

Assemble = Callable[[Fraction], SwitchedSystem]
Certify = Callable[[SwitchedSystem], "Certification"]


@dataclass(frozen=True)
class BoxMargin:
    """How far the declared ranges can be stretched about their nominal values.

    Parameters
    ----------
    proved : Fraction or None
        Largest scale that was proved, 1 being the declared ranges; None if not even the nominal
        values (scale 0) were.
    refuted : Fraction or None
        Smallest larger scale that was refuted; None if the search ended without a refutation.
    proof : Certification or None
        At the scale `proved`.
    """

    proved: Fraction | None
    refuted: Fraction | None
    proof: Certification | None


def find_margin(assemble: Assemble, certify: Certify) -> BoxMargin:
    """Bracket the largest provable scale, then bisect.

    A proof for a box is a proof for every smaller one, so the search needs no more than a
    bracket. Every scale that counts as proved has evidence that passed the exact check.

    Parameters
    ----------
    assemble : callable
        Gives the system for a scale; an AssemblyError says that the scale makes no sense.
    certify : callable
        Decides a system.
    """
    proved, proof = _try(Fraction(0), assemble, certify)
    if proved is not Verdict.PROVED:
        return BoxMargin(None, Fraction(0) if proved is Verdict.REFUTED else None, None)
    low, high, refuted = Fraction(0), Fraction(1), None
    while high <= LARGEST_SCALE:
        verdict, found = _try(high, assemble, certify)
        if verdict is not Verdict.PROVED:
            refuted = high if verdict is Verdict.REFUTED else refuted
            break
        low, proof, high = high, found, 2 * high
    else:
        return BoxMargin(low, None, proof)
    for _ in range(STEPS):
        middle = (low + high) / 2
        verdict, found = _try(middle, assemble, certify)
        if verdict is Verdict.PROVED:
            low, proof = middle, found
        else:
            high = middle
            refuted = middle if verdict is Verdict.REFUTED else refuted
    return BoxMargin(low, refuted, proof)


def _try(
    scale: Fraction, assemble: Assemble, certify: Certify
) -> tuple[Verdict | None, Certification | None]:
    """Return the verdict at a scale; None if the scale makes no system."""
    try:
        system = assemble(scale)
    except AssemblyError:
        return None, None
    certification = certify(system)
    return certification.verdict, certification


@dataclass(frozen=True)
class DwellMargin:
    """How short the time between switches may be.

    Parameters
    ----------
    proved : Fraction or None
        Shortest dwell time that was proved, in s (discrete time: steps); zero if arbitrary
        switching is stable; None if none was.
    refuted : Fraction or None
        Longest shorter one that was refuted.
    proof : Certification or None
        At `proved`.
    """

    proved: Fraction | None
    refuted: Fraction | None
    proof: Certification | None


def find_shortest_dwell(system: SwitchedSystem, certify: Certify, start: Fraction) -> DwellMargin:
    """Find the largest switching rate that has a proof: the shortest provable dwell time.

    Parameters
    ----------
    system : SwitchedSystem
        Its own dwell time is left out of account.
    certify : callable
        Decides a system.
    start : Fraction
        A time of the order of the modes' own, in s.

    Notes
    -----
    The bracket is found by doubling, then bisected. A proof for a dwell time is one for every
    longer one.
    """

    def attempt(dwell: Fraction) -> Certification:
        return certify(replace(system, switching=replace(system.switching, dwell_time=dwell)))

    free = attempt(Fraction(0))
    if free.verdict is Verdict.PROVED:
        return DwellMargin(Fraction(0), None, free)
    low, high = Fraction(0), start
    refuted = low if free.verdict is Verdict.REFUTED else None
    proof = attempt(high)
    while proof.verdict is not Verdict.PROVED:
        refuted = high if proof.verdict is Verdict.REFUTED else refuted
        low, high = high, 2 * high
        if high > LARGEST_SCALE * start:
            return DwellMargin(None, refuted, None)
        proof = attempt(high)
    for _ in range(DWELL_STEPS):
        middle = (low + high) / 2
        found = attempt(middle)
        if found.verdict is Verdict.PROVED:
            high, proof = middle, found
        else:
            low = middle
            refuted = middle if found.verdict is Verdict.REFUTED else refuted
    return DwellMargin(high, refuted, proof)
