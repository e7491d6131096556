"""Search for a common quadratic function, in several ways and coordinates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from math import gcd

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.evidence.graph import MODES, Node
from nrs_design.proof.mode import Time
from nrs_design.search.balance import mean_norm
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.decay import fastest_first, rate_of
from nrs_design.search.family import Family
from nrs_design.search.lmi import find_common_quadratic, margins
from nrs_design.search.rounding import BITS, claims, digits, rate_at, round_rate, unscale
from nrs_design.work import Allowance, NotAffordableError

BACK_OFF = Fraction(1999, 2000)
# The largest rate is bracketed to this share of the slowest mode's.
SMALLEST = 2.0**-14

Array = NDArray[np.float64]


def one_form(Q: Matrix, log2: int, rate: Fraction) -> FormsOnGraph:
    """Return one form over ``2^log2`` for all modes."""
    return FormsOnGraph((Node(MODES, Q),), log2, rate)


def search_by_lmi(family: Family) -> Candidates[FormsOnGraph]:
    """Search by semidefinite programming; then, if asked to, raise the rate."""
    time, allowance = family.system.time, family.allowance
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    least = rate_at(0.0, family.limit, time)
    try:
        Q = find_common_quadratic(family.matrices, time, least, allowance=allowance)
    except NotAffordableError:
        Q = mean_norm(family.matrices, time)
        if margins(family.matrices, Q, time, least).min() <= 0:
            raise
        yield from _at_own_rate(family, Q)
        return None
    if Q is None:
        return NO_MARGIN
    if family.optimize_rate:
        yield from _fastest(family)
    yield from _at_own_rate(family, Q)
    return None


def _fastest(family: Family) -> Iterator[Candidate[FormsOnGraph]]:
    """Yield functions for the largest rates that fit into the budget."""
    time = family.system.time

    def solve(rate: float, allowance: Allowance) -> Array | None:
        return find_common_quadratic(family.matrices, time, rate, allowance=allowance)

    found = fastest_first(
        solve, family.limit, time, family.allowance, resolution=0.0, smallest=SMALLEST
    )
    try:
        for Q, claim in found:
            for evidence in round_quadratic(family, Q, claim):
                yield Candidate(evidence, "found with the largest decay rate")
    except NotAffordableError:
        return


def decide_one_state(family: Family) -> Candidates[FormsOnGraph]:
    """Take ``V(x) = x^2``, at a rate computed exactly: modes may be nearer to 1 than floats are."""
    system = family.system
    numbers = [mode.A.fractions()[0][0] for mode in system.modes]
    claimed = BACK_OFF * -max(numbers)
    if system.time is Time.DISCRETE:
        claimed = 1 - BACK_OFF * (1 - max(map(abs, numbers)))
    yield Candidate(one_form(((1,),), 0, round_rate(claimed, system.time)))
    return None


def search_by_gradient(family: Family) -> Candidates[FormsOnGraph]:
    """Search by the Liberzon-Tempo iteration; then, if asked to, raise the rate."""
    from nrs_design.search.gradient import find_by_gradient, find_faster_by_gradient

    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    # The rungs below need time as well.
    family = replace(family, allowance=family.allowance.part(0.5))
    result = find_by_gradient(family)
    if result.Q is None:
        return f"not converged after {result.updates} updates"
    words = f"found after {result.updates} updates"
    if family.optimize_rate:
        faster = find_faster_by_gradient(family, result.Q)
        more = f"with a decay rate near the largest after {faster.updates} more"
        if faster.Q is not None:
            yield from _at_own_rate(family, faster.Q, f"{words}, {more}")
    yield from _at_own_rate(family, result.Q, words)
    return None


def _at_own_rate(
    family: Family, Q: Array, words: str = "found"
) -> Iterator[Candidate[FormsOnGraph]]:
    """Yield roundings of a function at rates just below the one that it shows itself."""
    rate, time = rate_of(family.matrices, Q, family.system.time), family.system.time
    for claim in claims(1.0, rate, time):
        for evidence in round_quadratic(family, Q, claim):
            yield Candidate(evidence, words)


def round_quadratic(family: Family, Q: Array, claim: Fraction) -> Iterator[FormsOnGraph]:
    """Yield roundings that floating point thinks worth the time of the exact check, and the last.

    Q is in the coordinates of the family, `claim` the rate. The scale of a quadratic function is
    free: common factors of two go.
    """
    largest = np.abs(Q).max()
    if not np.isfinite(largest) or largest == 0:
        return
    unit = np.ldexp(Q, -int(np.frexp(largest)[1]))
    for bits in digits():
        rounded = np.ldexp(np.rint(np.ldexp((unit + unit.T) / 2, bits)), -bits)
        margin = margins(family.matrices, rounded, family.system.time, float(claim)).min()
        if margin > 0 or bits == BITS[-1]:
            rows, denominator_log2 = unscale(unit, family.exponents, bits)
            common = gcd(*(entry for row in rows for entry in row)) or 1
            twos = (common & -common).bit_length() - 1
            reduced = tuple(tuple(entry >> twos for entry in row) for row in rows)
            yield one_form(reduced, max(denominator_log2 - twos, 0), claim)
