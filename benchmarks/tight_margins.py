"""Families that hardly have a common quadratic function: one strategy for both kinds."""

from __future__ import annotations

from benchmarks.families import Matrices, crowded_family, narrow_family
from benchmarks.many_modes import compare_at_once
from benchmarks.measure import Comparison, Size, time_side_by_side
from benchmarks.peers import gradient_ends_within, solve_lazily

N, M, SEED, DECIMALS = 12, 64, 7, 4
# Both have t* = 0.01 or a little below.
NARROWNESS, SPREAD = 0.008, 0.6719
# Never slower than the better strategy by more than this factor.
TARGET = 1 / 1.3


def run(size: Size) -> tuple[Comparison, ...]:
    """Compare with both ways to use a solver, and with the gradient iteration."""
    repeats, cap = size.pick((5, 30.0), (1, 10.0), (1, 0.1))
    n, m = size.pick((N, M), (N, M), (4, 4))
    families = {
        "many modes bind": crowded_family(n, m, SEED, SPREAD),
        "few modes bind": narrow_family(n, m, SEED, NARROWNESS),
    }
    return tuple(
        row
        for name, matrices in families.items()
        for row in _compare(f"tight, n = {n}, m = {m}, {name}", matrices, repeats, cap)
    )


def _compare(work: str, matrices: Matrices, repeats: int, cap: float) -> tuple[Comparison, ...]:
    at_once, ours, note, (lazily,) = compare_at_once(
        matrices, DECIMALS, repeats, lambda: solve_lazily(matrices)
    )
    (gradient,), (ended,) = time_side_by_side(1, lambda: gradient_ends_within(matrices, cap))
    stopped = "" if ended else f"peer stopped after {cap:.0f} s"
    taken = gradient if ended else None
    return (
        Comparison(work, "cvxpy, all modes", at_once, ours, TARGET, note),
        Comparison(work, "cvxpy, always lazy", lazily, ours, TARGET),
        Comparison(work, "Liberzon-Tempo gradient", taken, ours, TARGET, stopped, cap),
    )
