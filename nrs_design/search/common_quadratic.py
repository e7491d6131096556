"""Search for a common quadratic function, in several ways and coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import gcd

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.evidence.graph import MODES, Node
from nrs_design.proof.mode import Time
from nrs_design.search.balance import mean_norm
from nrs_design.search.candidates import OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.decay import rate_of
from nrs_design.search.family import Family
from nrs_design.search.lmi import find_common_quadratic, margins
from nrs_design.search.rates import Rates, at_own_rate, propose
from nrs_design.search.rounding import digits, rate_at, round_rate, unscale
from nrs_design.work import Allowance, NotAffordableError

BACK_OFF = Fraction(1999, 2000)
# The largest rate is bracketed to this share of the slowest mode's.
SMALLEST = 2.0**-14

Array = NDArray[np.float64]


def one_form(Q: Matrix, log2: int, rate: Fraction) -> FormsOnGraph:
    """Return one form over ``2^log2`` for all modes."""
    return FormsOnGraph((Node(MODES, Q),), log2, rate)


@dataclass(frozen=True)
class CommonQuadratic:
    """The program of a quadratic function for all modes, in the coordinates of a family."""

    family: Family
    is_dear = False

    def solve(self, rate: float, allowance: Allowance) -> Array | None:
        """Return a function at a rate."""
        family = self.family
        return find_common_quadratic(family.matrices, family.system.time, rate, allowance)

    def own_rate(self, Q: Array) -> float:
        """Return the rate that a function shows."""
        return rate_of(self.family.matrices, Q, self.family.system.time)

    def roundings(
        self, Q: Array, claim: Fraction, digits: Sequence[int], *, errors: bool = False
    ) -> Iterator[FormsOnGraph]:
        """Yield roundings that floating point thinks worth the exact check, and the last.

        The scale of a quadratic function is free: common factors of two go.
        """
        family, largest = self.family, np.abs(Q).max()
        if not np.isfinite(largest) or largest == 0:
            return
        unit = np.ldexp(Q, -int(np.frexp(largest)[1]))
        for bits in digits:
            rounded = np.ldexp(np.rint(np.ldexp((unit + unit.T) / 2, bits)), -bits)
            margin = margins(family.matrices, rounded, family.system.time, float(claim)).min()
            if margin > 0 or bits == digits[-1]:
                rows, denominator_log2 = unscale(unit, family.exponents, bits)
                common = gcd(*(entry for row in rows for entry in row)) or 1
                twos = (common & -common).bit_length() - 1
                reduced = tuple(tuple(entry >> twos for entry in row) for row in rows)
                yield one_form(reduced, max(denominator_log2 - twos, 0), claim)


def search_by_lmi(family: Family) -> Candidates[FormsOnGraph]:
    """Search by semidefinite programming; then, if asked to, raise the rate."""
    time, program = family.system.time, CommonQuadratic(family)
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    try:
        rates = Rates(resolution=0.0, smallest=SMALLEST)
        return (yield from propose(program, family, family.limit, rates))
    except NotAffordableError:
        Q = mean_norm(family.matrices, time)
        if margins(family.matrices, Q, time, rate_at(0.0, family.limit, time)).min() <= 0:
            raise
    yield from at_own_rate(program, Q, family, digits())
    return None


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
    words, program = f"found after {result.updates} updates", CommonQuadratic(family)
    if family.optimize_rate:
        faster = find_faster_by_gradient(family, result.Q)
        more = f"with a decay rate near the largest after {faster.updates} more"
        if faster.Q is not None:
            yield from at_own_rate(program, faster.Q, family, digits(), f"{words}, {more}")
    yield from at_own_rate(program, result.Q, family, digits(), words)
    return None
