"""Order 20: an exact proof where a general solver slows down or calls its answer inaccurate."""

from __future__ import annotations

from benchmarks.families import stable_family, to_system
from benchmarks.measure import Comparison, Finding, Size, prove, time_side_by_side
from benchmarks.peers import Solution, solve_all_at_once
from nrs_design.certificates.certificate import Verdict
from nrs_design.search.certification import Certification

SIZE, DECIMALS = (20, 32), 3


def run(size: Size) -> tuple[Comparison | Finding, ...]:
    """Measure inside this process, with all imports done."""
    N, M = size.pick(SIZE, SIZE, (4, 3))
    matrices = stable_family(N, M, seed=N * M)
    system = to_system(matrices, DECIMALS)
    prove(to_system(matrices[:1, :4, :4], DECIMALS))
    (theirs, ours), (solution, found) = time_side_by_side(
        size.pick(3, 1, 1),
        lambda: solve_all_at_once(matrices),
        lambda: prove(system),
    )
    assert isinstance(solution, Solution)
    assert isinstance(found, Certification)
    note = (
        f"t* = {solution.t:.3g}; peer: {solution.status} in floating point; "
        f"ours: {found.verdict} by {found.method}, all {M} modes checked exactly"
    )
    work = f"n = {N}, m = {M}"
    proved = found.verdict is Verdict.PROVED
    return (
        Comparison(work, "cvxpy, all modes", theirs, ours, None, note),
        Finding(work, f"{found.verdict}", "an exact proof", proved, ours),
    )
