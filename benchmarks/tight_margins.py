"""Families that hardly have a common quadratic function: one strategy for both kinds."""

from __future__ import annotations

from benchmarks.families import Matrices, crowded_family, narrow_family, to_system
from benchmarks.measure import Comparison, Size, prove, time_side_by_side
from benchmarks.peers import Solution, gradient_ends_within, solve_all_at_once, solve_lazily
from nrs_design.search.certification import Certification

N, M, SEED, DECIMALS = 12, 64, 7, 4
# Both have t* = 0.01 or a little below.
NARROWNESS, SPREAD = 0.008, 0.6719
# Never slower than the better strategy by more than this factor.
TARGET = 1 / 1.3
CAP, QUICK_CAP, SMOKE_CAP = 30.0, 10.0, 0.1


def run(size: Size) -> tuple[Comparison, ...]:
    """Compare with both ways to use a solver, and with the gradient iteration."""
    repeats, cap = size.pick((5, CAP), (1, QUICK_CAP), (1, SMOKE_CAP))
    n, m = size.pick((N, M), (N, M), (4, 4))
    crowded = crowded_family(n, m, SEED, SPREAD)
    narrow = narrow_family(n, m, SEED, NARROWNESS)
    return (
        *_compare("many modes bind", crowded, repeats, cap),
        *_compare("few modes bind", narrow, repeats, cap),
    )


def _compare(name: str, matrices: Matrices, repeats: int, cap: float) -> tuple[Comparison, ...]:
    system = to_system(matrices, DECIMALS)
    prove(to_system(matrices[:2], DECIMALS))
    (at_once, lazily, ours), (solution, _, found) = time_side_by_side(
        repeats,
        lambda: solve_all_at_once(matrices),
        lambda: solve_lazily(matrices),
        lambda: prove(system),
    )
    assert isinstance(solution, Solution)
    assert isinstance(found, Certification)
    note = (
        f"t* = {solution.t:.3g}; peer: {solution.status} in floating point; "
        f"ours: {found.verdict}, checked exactly"
    )
    m, n = matrices.shape[:2]
    work = f"tight, n = {n}, m = {m}, {name}"
    return (
        Comparison(work, "cvxpy, all modes", at_once, ours, TARGET, note),
        Comparison(work, "cvxpy, always lazy", lazily, ours, TARGET),
        _gradient(matrices, work, ours, cap),
    )


def _gradient(matrices: Matrices, work: str, ours: float, cap: float) -> Comparison:
    (seconds,), (ended,) = time_side_by_side(1, lambda: gradient_ends_within(matrices, cap))
    note = "" if ended else f"peer stopped after {cap:.0f} s"
    peer = "Liberzon-Tempo gradient"
    return Comparison(work, peer, seconds if ended else None, ours, TARGET, note, cap)
