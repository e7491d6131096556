"""Families with a common quadratic function: our proof, and all modes in one problem of a solver.

Of order 20 a general solver slows down, or calls its answer inaccurate.
"""

from __future__ import annotations

from benchmarks.families import stable_family, to_system
from benchmarks.measure import Comparison, Size, prove, time_side_by_side
from benchmarks.peers import Solution, solve_all_at_once
from nrs_design.search.certification import Certification

DECIMALS, TARGET = 3, 20.0
# Order, modes, and the ratio that is aimed for.
SIZES = ((6, 512, TARGET), (6, 2048, TARGET), (4, 1024, TARGET), (20, 32, None))


def run(size: Size) -> tuple[Comparison, ...]:
    """Measure inside this process, with all imports done."""
    sizes = size.pick(SIZES, (SIZES[0], SIZES[-1]), ((3, 4, TARGET),))
    return tuple(_compare(*each, size.pick(3, 1, 1)) for each in sizes)


def _compare(n: int, m: int, target: float | None, repeats: int) -> Comparison:
    matrices = stable_family(n, m, seed=n * m)
    system = to_system(matrices, DECIMALS)
    prove(to_system(matrices[:2], DECIMALS))  # Imports are not what is measured.
    (theirs, ours), (solution, found) = time_side_by_side(
        repeats, lambda: solve_all_at_once(matrices), lambda: prove(system)
    )
    assert isinstance(solution, Solution)
    assert isinstance(found, Certification)
    note = (
        f"t* = {solution.t:.3g}; peer: {solution.status} in floating point; "
        f"ours: {found.verdict}, all {len(matrices)} modes checked exactly"
    )
    return Comparison(f"n = {n}, m = {m}", "cvxpy, all modes", theirs, ours, target, note)
