"""Search for the rate of a program, and claims for its solutions (untrusted).

Rates descend, and for each rate the digits grow. A wider gap below the best rate needs fewer
digits, and the first candidate that passes the exact check is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice
from math import floor, isfinite
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.mode import Time
from nrs_design.search.acceptance import NO_MARGIN, Candidate, Candidates
from nrs_design.search.family import Family
from nrs_design.search.work import Allowance, NotAffordableError

S = TypeVar("S")
E = TypeVar("E", bound=AbstractEvidence, covariant=True)

BACK_OFFS = (0.99995, 0.9998, 0.9995, 0.999, 0.998, 0.996, 0.99, 0.9, 0.5, 0.1, 1e-2, 1e-3, 1e-4)
BITS = (4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 50, 60)
# Largest number of rates where a check takes long; bits of a rate.
FEW_RATES = 3
RATE_BITS = 16
# A position is bracketed to this share of itself, or given up as nil below the smallest one.
RESOLUTION, SMALLEST = 2.0**-14, 2.0**-40
# Relative distance of the last position above the largest feasible position.
OVERSHOOT = 2.0**-10
# Few roundings with errors: more digits at once, as every check takes longer.
ERROR_BITS = (24, 32, 40, 50, 60)


def rate_at(position: float, limit: float, time: Time) -> float:
    """Return the rate, in 1/s or per step, at a position from 0, mere stability, to 1."""
    return position * limit if time is Time.CONTINUOUS else 1 - position * (1 - limit)


def position_of(rate: float, limit: float, time: Time) -> float:
    """Return the position of a rate: the inverse of `rate_at`."""
    return rate / limit if time is Time.CONTINUOUS else (1 - rate) / (1 - limit)


def share_of(rate: float, time: Time) -> float:
    """Return the relative decrease of a quadratic form at a rate, in 1/s or per step."""
    return 2 * rate if time is Time.CONTINUOUS else 1 - rate**2


def claims(
    position: float, limit: float, time: Time, nearest: float = BACK_OFFS[0], *, few: bool = False
) -> Iterator[Fraction]:
    """Yield short rates of exponential decay below a position, the fastest decay first.

    At most the share `nearest` of the position is claimed; `few`: not all of them.
    """
    back_offs = (back_off for back_off in BACK_OFFS if back_off <= nearest)
    for back_off in islice(back_offs, FEW_RATES if few else None):
        rate = rate_at(position * back_off, limit, time)
        if not isfinite(rate):
            continue
        claim = round_rate(rate, time)
        if claim > 0 and (time is Time.CONTINUOUS or claim < 1):
            yield claim


def digits(fewest: int = BITS[0]) -> tuple[int, ...]:
    """Return numbers of bits after the binary point, from the fewest on."""
    return tuple(bits for bits in BITS if bits >= fewest)


def round_rate(rate: float | Fraction, time: Time) -> Fraction:
    """Round a rate to a short dyadic number of slower decay."""
    if time is Time.DISCRETE:
        return 1 - _round_down(1 - Fraction(rate))
    return _round_down(Fraction(rate))


def _round_down(value: Fraction) -> Fraction:
    size = value.numerator.bit_length() - value.denominator.bit_length()
    if value >= Fraction(2) ** size:
        size += 1
    unit = Fraction(2) ** (size - RATE_BITS)
    return floor(value / unit) * unit


def round_form(
    M: NDArray[np.float64], shifts: NDArray[np.int64], bits: int
) -> tuple[tuple[int, ...], ...]:
    """Round a symmetric matrix to integers over ``2^bits``, then scale exactly, ``2^s M 2^s``."""
    return round_matrix((M + M.T) / 2, shifts, bits)


def round_matrix(
    M: NDArray[np.float64], shifts: NDArray[np.int64], bits: int
) -> tuple[tuple[int, ...], ...]:
    """Do the same with any matrix.

    No shift s is negative; bits may be. An OverflowError beyond the range of floating point.
    """
    scaled = np.ldexp(M, bits)
    if not np.isfinite(scaled).all():
        raise OverflowError("a form beyond the range of floating point")
    return tuple(
        tuple(round(float(v)) << int(si + sj) for v, sj in zip(row, shifts, strict=True))
        for row, si in zip(scaled, shifts, strict=True)
    )


def unscale(
    Q: NDArray[np.float64], exponents: NDArray[np.int64], bits: int
) -> tuple[tuple[tuple[int, ...], ...], int]:
    """Round to integers over ``2^bits`` and undo the scaling exactly, ``2^-d Q 2^-d``.

    Returns the integers, and the logarithm of their denominator, two to a power of at least zero.
    """
    top = int(exponents.max())
    rows, log2 = round_form(Q, top - exponents, bits), bits + 2 * top
    return (rows, log2) if log2 >= 0 else (tuple(tuple(v << -log2 for v in row) for row in rows), 0)


def numerators(multipliers: NDArray[np.float64], log2: int) -> tuple[int, ...]:
    """Round multipliers to integers over two to a power; none becomes negative."""
    whole = Fraction(2) ** log2
    return tuple(round(max(Fraction(float(entry)), Fraction(0)) * whole) for entry in multipliers)


class RateProgram(Protocol[S, E]):
    """What is solved for a rate, in 1/s or per step."""

    def solve(self, rate: float, allowance: Allowance) -> S | None:
        """Return a solution at a rate."""

    def own_rate(self, solution: S) -> float:
        """Return the rate that a solution shows, perhaps better than the requested rate."""

    def roundings(
        self, solution: S, claim: Fraction, digits: Sequence[int], *, errors: bool = False
    ) -> Iterator[E]:
        """Yield evidence of a rate, with room for errors or without."""


@dataclass(frozen=True)
class Rates:
    """Settings of the search for rates; slow programs are solved rarely."""

    share: float = 1.0  # Share of the budget for the largest rate
    resolution: float = RESOLUTION
    smallest: float = SMALLEST
    nearest: float = BACK_OFFS[0]
    few: bool = False
    bits: Sequence[int] = field(default_factory=digits)
    always: bool = False  # Search for the largest rate even if it is not requested
    words: str = "found with the largest decay rate"


# Solutions take time: the largest rate is bracketed roughly, and a little less is claimed.
POLYNOMIAL = Rates(
    resolution=2.0**-11,
    smallest=2.0**-14,
    nearest=0.998,
    bits=digits(10),
    words="found with a decay rate near the largest",
)


def propose(
    program: RateProgram[S, E],
    family: Family,
    limit: float,
    rates: Rates,
    coverings: Sequence[bool] = (False,),
) -> Candidates[E]:
    """Solve for any rate; then, if asked to, for the largest, which is proposed first.

    Of `coverings` in turn, solutions leave room for errors that they are not solved for, or they do
    not. No solution can beat the limit.
    """
    time, allowance = family.system.time, family.allowance
    first = program.solve(rate_at(0.0, limit, time), allowance)
    if first is None:
        return NO_MARGIN
    part = allowance.part(rates.share)
    half, found = part.part(0.5), list[tuple[float, S]]()

    def shown(position: float) -> float | None:
        """Solve for a position, and return which one the solution shows."""
        if (solution := program.solve(rate_at(position, limit, time), half)) is None:
            return None
        found.append((position_of(program.own_rate(solution), limit, time), solution))
        return found[-1][0]

    def solutions(claim: Fraction, *, covered: bool) -> Iterator[S]:
        """Yield the solution that shows the most, if it shows the claim, and one for the claim.

        That for the claim leaves more room for errors, and is first where they are covered.
        """
        position = position_of(float(claim), limit, time)
        known = sorted(found, key=lambda one: one[0], reverse=True)
        better = [solution for position_shown, solution in known[:1] if position_shown > position]
        yield from () if covered else better
        if (solved := program.solve(float(claim), part)) is not None:
            yield solved
        yield from better if covered else ()

    best = 0.0
    if family.optimize_rate or rates.always:
        best = bisect_position(shown, rates.resolution, rates.smallest)
    for covered in coverings:
        bits = ERROR_BITS if covered else rates.bits
        try:
            for claim in claims(best, limit, time, rates.nearest, few=rates.few):
                for solution in solutions(claim, covered=covered):
                    for evidence in program.roundings(solution, claim, bits, errors=covered):
                        yield Candidate(evidence, rates.words)
        except NotAffordableError:
            if rates.always:
                raise
        if not rates.always:
            yield from at_own_rate(program, first, family, bits, errors=covered)
    return None


def at_own_rate(
    program: RateProgram[S, E],
    solution: S,
    family: Family,
    bits: Sequence[int],
    words: str = "found",
    *,
    errors: bool = False,
) -> Iterator[Candidate[E]]:
    """Yield roundings of a solution at rates just below the one that it shows itself."""
    for claim in claims(1.0, program.own_rate(solution), family.system.time):
        for evidence in program.roundings(solution, claim, bits, errors=errors):
            yield Candidate(evidence, words)


def bisect_position(
    shown: Callable[[float], float | None],
    resolution: float = RESOLUTION,
    smallest: float = SMALLEST,
) -> float:
    """Bisect for the largest feasible position; zero if nothing above the smallest one is.

    Feasible positions come first. For a feasible position, `shown` returns the position that its
    solution shows, perhaps a larger one; otherwise None. The largest is bracketed to a share of
    itself, `resolution`, or to the difference `smallest`, whichever is reached first; the search
    ends early when the work is used up. A solver may fail below the largest, so one position just
    above is tried.
    """
    low, high, failed, is_last = 0.0, 1.0, list[float](), False
    while True:
        position = (low + high) / 2
        if high - low <= max(resolution * high, smallest):
            if is_last or not low:
                return low
            position, is_last = min(low * (1 + OVERSHOOT), 1.0), True
        try:
            found = shown(position)
        except NotAffordableError:
            return low
        if found is None:
            failed.append(position)
        else:
            low = max(position, min(found, 1.0))
        high = min((one for one in failed if one > low), default=1.0)
