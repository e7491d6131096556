"""Many modes with a common quadratic function: all of them in one problem, or added lazily."""

from __future__ import annotations

from benchmarks.families import stable_family, to_system
from benchmarks.measure import Comparison, Size, prove, time_side_by_side
from benchmarks.peers import Solution, solve_all_at_once
from nrs_design.search.certification import Certification

SIZES = ((6, 512), (6, 2048), (4, 1024))
QUICK_SIZES, SMOKE_SIZES = ((6, 512),), ((3, 4),)
TARGET = 20.0


def run(size: Size) -> tuple[Comparison, ...]:
    """Measure inside this process, with all imports done."""
    sizes = size.pick(SIZES, QUICK_SIZES, SMOKE_SIZES)
    return tuple(_compare(n, m, size.pick(3, 1, 1)) for n, m in sizes)


def _compare(n: int, m: int, repeats: int) -> Comparison:
    matrices = stable_family(n, m, seed=n * m)
    system = to_system(matrices, decimals=3)
    prove(to_system(matrices[:2], decimals=3))
    (theirs, ours), (solution, found) = time_side_by_side(
        repeats,
        lambda: solve_all_at_once(matrices),
        lambda: prove(system),
    )
    assert isinstance(solution, Solution)
    assert isinstance(found, Certification)
    note = (
        f"t* = {solution.t:.3g}; peer: {solution.status} in floating point; "
        f"ours: {found.verdict}, all {m} modes checked exactly"
    )
    return Comparison(f"n = {n}, m = {m}", "cvxpy, all modes", theirs, ours, TARGET, note)
