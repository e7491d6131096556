"""Search for one quadratic function for all coupled axes in discrete time (untrusted).

Maximize t subject to ``0 <= Q <= I`` and every condition of `nrs_design.proof.steps` with at least
t to spare. The rate is looked for without roundings, which have little influence; then functions
that cover them come first.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.conewise_program import Motions, separating_coordinates
from nrs_design.search.decay import bisect_position
from nrs_design.search.disturbed import (
    DisturbedProblem,
    DisturbedSolution,
    balanced,
    problem_of,
    roundings,
    transformed,
)
from nrs_design.search.draw import one_form
from nrs_design.search.family import Family
from nrs_design.search.rounding import claims, rate_at
from nrs_design.search.sdp import solve_blocks, symmetric_basis
from nrs_design.work import Allowance

Array = NDArray[np.float64]

# The largest rate is looked for to this share.
RESOLUTION, SMALLEST = 2.0**-9, 2.0**-12
# Shares of the rate of the slowest mode that are tried where any rate will do.
ANY = (0.25, 0.05, 0.01, 2e-3)


def search_coupled_steps(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a function for all axes, with the largest rate if that is asked for."""
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    motions = Motions.of(family)
    T = separating_coordinates(motions)
    whole, units = balanced(transformed(problem_of(family, motions), T))
    if not all(np.isfinite(part).all() for part in (T, whole.contact, whole.free, units)):
        return OUT_OF_RANGE
    exact = whole.without_roundings().distinct()
    time, limit = family.system.time, family.limit

    def holds(position: float) -> bool:
        return _solve(exact, rate_at(position, limit, time), half) is not None

    half = family.allowance.part(0.5)
    if family.optimize_rate:
        position = bisect_position(holds, RESOLUTION, SMALLEST)
    else:
        position = next((share for share in ANY if holds(share)), 0.0)
    if not position:
        return NO_MARGIN
    for own in (whole.distinct(), exact) if family.system.roundings else (exact,):
        for claim in claims(position, limit, time):
            found = _solve(own, float(claim), family.allowance)
            if found is None:
                continue
            for item in roundings(family, found, T, units):
                graph = one_form(
                    family.system,
                    item.Q,
                    item.log2,
                    claim,
                    crossings=item.multipliers,
                    roundings=item.roundings,
                    couplings=item.couplings,
                    lost=family.system.contact is not None,
                )
                yield Candidate(graph)
    return None


def _solve(own: DisturbedProblem, rate: float, allowance: Allowance) -> DisturbedSolution | None:
    """Look for a function that keeps a share of itself, with as much to spare as possible."""
    n, lost, basis = own.order, own.multipliers, symmetric_basis(own.order)
    k, unknowns = len(basis), len(basis) + lost + own.errors + 1
    blocks: list[tuple[Array, Array]] = []
    for condition in own.conditions(basis, 1 - rate**2):
        stack = condition.stack(0, lost)
        side = stack.shape[-1]
        images = np.zeros((unknowns, side, side))
        images[: len(stack)], images[-1] = stack, -np.eye(side)
        blocks.append((np.zeros((side, side)), images))
    for sign, constant in ((1.0, np.zeros((n, n))), (-1.0, np.eye(n))):
        images = np.zeros((unknowns, n, n))
        images[:k] = sign * basis
        images[-1] = -np.eye(n) if sign > 0 else 0.0
        blocks.append((constant, images))
    for i in range(k, unknowns - 1):
        images = np.zeros((unknowns, 1, 1))
        images[i] = 1.0
        blocks.append((np.zeros((1, 1)), images))
    x = solve_blocks(blocks, allowance)
    if x is None or x[-1] <= 0:
        return None
    Q = np.asarray(np.tensordot(x[:k], basis, axes=1))
    crossings, taus = np.split(x[k:-1], [lost])
    return DisturbedSolution(Q, crossings, np.zeros(0), taus, float(x[-1]))
