"""Search for one quadratic function for all coupled axes, by CVXPY (untrusted).

Maximize t subject to ``0 <= Q <= I`` and every condition of the evidence with at least t to spare,
in coordinates in which the numbers are of like size. The condition is off the hot path, and written
as it stands.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.conewise_program import Motions, separating_coordinates
from nrs_design.search.conewise_quadratic import numerators
from nrs_design.search.decay import fastest_first
from nrs_design.search.draw import one_form
from nrs_design.search.family import Family, to_floats
from nrs_design.search.raw import LOADING, PER_PROGRAM, solve_by_cvxpy
from nrs_design.search.rounding import claims, rate_at, unscale
from nrs_design.search.sdp import begin, program_cost
from nrs_design.work import Allowance, Cost, NotAffordableError

Array = NDArray[np.float64]

# Few roundings: as with those of the arithmetic, coarse ones seldom pass.
DIGITS = (16, 24, 32, 40, 50, 60)
# The largest rate is looked for to this share: a program takes a while.
RESOLUTION = 2.0**-9
SMALLEST = 2.0**-12


@dataclass(frozen=True)
class CoupledSolution:
    """A quadratic function and its multipliers, in floating point."""

    Q: Array
    taus: Array
    multipliers: Array


@dataclass(frozen=True)
class CoupledProblem:
    """Motions and couplings in floating point."""

    motions: Motions  # In contact and free
    columns: Array  # Shape (k, c, n). The B of the couplings, for every mode and free mode.
    rows: Array  # Shape (k, c, n). Their q.
    # Shape (c,). Columns are multiplied by these, and rows divided by them, so that both are of
    # like size.
    scales: Array

    @classmethod
    def of(cls, family: Family, motions: Motions, T: Array) -> CoupledProblem:
        """Convert the couplings of a system to coordinates ``x = T z`` of a family.

        Parameters
        ----------
        family : Family
            Of the system.
        motions : Motions
            In these coordinates.
        T : ndarray, shape (n, n)
            Invertible.
        """
        d, couplings = family.exponents, family.system.couplings
        columns = np.stack([to_floats(item.columns)[:, :, 0] for item in couplings], axis=1)
        rows = np.stack([to_floats(item.rows)[:, 0, : len(d)] for item in couplings], axis=1)
        columns = np.ldexp(columns, -d) @ np.linalg.inv(T).T
        rows = np.ldexp(rows, d) @ T
        sizes = [np.linalg.norm(part, axis=-1).max(axis=0) for part in (columns, rows)]
        scales = np.sqrt(np.divide(sizes[1], sizes[0], out=np.ones(len(couplings))))
        scales[~(scales > 0)] = 1.0
        return cls(motions, columns * scales[:, None], rows / scales[:, None], scales)


def search_coupled_axes(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a function for all axes; then, if asked to, raise the rate."""
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    motions = Motions.of(family)
    T = separating_coordinates(motions)
    own = motions.transformed(T)
    problem = CoupledProblem.of(family, own, T)
    parts = (T, own.contact, own.free, own.pulls, problem.columns, problem.rows)
    if not all(np.isfinite(part).all() for part in parts):
        return OUT_OF_RANGE
    family.allowance.take(Cost(LOADING), "loading CVXPY")

    def solve(rate: float, allowance: Allowance) -> CoupledSolution | None:
        return _solve(problem, rate, allowance)

    time = family.system.time
    solution = solve(rate_at(0.0, family.limit, time), family.allowance)
    if solution is None:
        return NO_MARGIN
    if family.optimize_rate:
        yield from _fastest(family, problem, solve, T)
    for claim in claims(1.0, best_rate(problem, solution), time):
        for evidence in _roundings(family, problem, solution, T, claim):
            yield Candidate(evidence)
    return None


def _fastest(
    family: Family,
    problem: CoupledProblem,
    solve: Callable[[float, Allowance], CoupledSolution | None],
    T: Array,
) -> Iterator[Candidate[FormsOnGraph]]:
    """Yield functions for the largest rates that fit into the budget."""
    given = family.limit, family.system.time, family.allowance
    try:
        for solution, claim in fastest_first(
            solve, *given, resolution=RESOLUTION, smallest=SMALLEST
        ):
            for evidence in _roundings(family, problem, solution, T, claim):
                yield Candidate(evidence, "found with the largest decay rate")
    except NotAffordableError:
        return


def _roundings(
    family: Family, problem: CoupledProblem, solution: CoupledSolution, T: Array, claim: Fraction
) -> Iterator[FormsOnGraph]:
    """Yield roundings of a solution in coordinates ``x = T z`` of the family.

    The multiplier of a coupling is divided by the square of its scale; that of a force has the
    scale of the deflection, as in `nrs_design.search.conewise_quadratic`.
    """
    inverse = np.linalg.inv(T)
    Q = inverse.T @ solution.Q @ inverse
    exponent = int(np.frexp(np.abs(Q).max())[1])
    taus = np.ldexp(solution.taus / problem.scales**2, -exponent)
    scaled = np.ldexp(solution.multipliers / T[-1, -1], -exponent)
    shift = -int(family.exponents[-1])
    for bits in DIGITS:
        rows, log2 = unscale(np.ldexp(Q, -exponent), family.exponents, bits)
        whole, multipliers = numerators(taus, log2), numerators(scaled, log2 + shift)
        lost = family.system.contact is not None
        yield one_form(
            family.system,
            rows,
            max(log2, 0),
            claim,
            crossings=multipliers,
            couplings=whole,
            lost=lost,
        )


def best_rate(problem: CoupledProblem, solution: CoupledSolution) -> float:
    """Return the rate in 1/s that a solution shows; the multipliers of forces are left alone.

    Parameters
    ----------
    problem : CoupledProblem
        For which it was found.
    solution : CoupledSolution
        With positive definite Q and positive multipliers.
    """
    lowest = []
    for where, A, B, q, pull in _situations(problem):
        Q, crossing = solution.Q[:where, :where], np.zeros((where, where))
        if pull is not None:
            crossing[-1] = solution.multipliers[pull[0]] * pull[1]
        weighted = Q @ B.T / np.sqrt(solution.taus)
        left = Q @ A + q.T @ np.diag(solution.taus) @ q / 2 + weighted @ weighted.T / 2 - crossing
        L = np.linalg.inv(np.linalg.cholesky(Q))
        lowest.append(np.linalg.eigvalsh(-L @ (left + left.T) @ L.T)[0] / 2)
    return float(min(lowest))


def _situations(
    problem: CoupledProblem,
) -> Iterator[tuple[int, Array, Array, Array, tuple[int, Array] | None]]:
    """Yield how many states move, their A, B and q, and where a force could pull, which and how."""
    motions = problem.motions
    n, m = motions.contact.shape[-1], len(motions.contact)
    for k, A in enumerate(motions.contact):
        yield n, A, problem.columns[k], problem.rows[k], None
    for k, A in enumerate(motions.free, m):
        yield n - 1, A[:-1, :-1], problem.columns[k][:, :-1], problem.rows[k][:, :-1], None
    pairs = product(enumerate(motions.free, m), motions.pulls)
    for i, ((k, A), pull) in enumerate(pairs):
        yield n, A, problem.columns[k], problem.rows[k], (i, pull)


def _solve(problem: CoupledProblem, rate: float, allowance: Allowance) -> CoupledSolution | None:
    """Look for a function that decreases at a rate in floating point, with the largest margin."""
    import cvxpy

    cp: Any = cvxpy
    motions = problem.motions
    m, f, p = map(len, (motions.contact, motions.free, motions.pulls))
    n, c = motions.contact.shape[-1], len(problem.scales)
    unknowns = n * (n + 1) // 2 + c + f * p + 1
    cost = program_cost(unknowns, unknowns, [(n + c, unknowns)] * (m + f * (1 + p) + 2))
    cost = replace(cost, work=PER_PROGRAM + cost.work)
    what = f"a program of {unknowns - 1} unknowns and {m + f * (1 + p)} blocks"
    begun = begin(allowance, cost, what)
    Q, t, identity = cp.Variable((n, n), symmetric=True), cp.Variable(), np.eye(n)
    taus, multipliers = cp.Variable(c), cp.Variable(max(f * p, 1), nonneg=True)
    conditions = [Q << identity, Q >> t * identity]
    for where, A, B, q, pull in _situations(problem):
        part = Q[:where, :where]
        decrease = -(A.T @ part + part @ A + 2 * rate * part) - q.T @ cp.diag(taus) @ q
        if pull is not None:
            crossing = np.outer(identity[-1], pull[1])
            decrease += multipliers[pull[0]] * (crossing + crossing.T)
        form = cp.bmat([[decrease, -part @ B.T], [-B @ part, cp.diag(taus)]])
        conditions.append((form + form.T) / 2 - t * np.eye(where + c) >> 0)
    program = cp.Problem(cp.Maximize(t), conditions)
    try:
        # That a solution may be inaccurate is no news: no solver is trusted.
        with warnings.catch_warnings(action="ignore"):
            solve_by_cvxpy(program, begun)
    except cp.SolverError:
        return None
    found = Q.value, taus.value, multipliers.value if f * p else np.zeros(0), t.value
    if any(part is None or not np.isfinite(part).all() for part in found) or t.value <= 0:
        return None
    return CoupledSolution(*map(np.asarray, found[:3]))
