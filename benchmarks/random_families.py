"""Does a common quadratic function exist? Random families, each decided exactly one way."""

from __future__ import annotations

from collections import Counter
from time import perf_counter

import numpy as np

from benchmarks.families import Matrices, hurwitz_family, to_system
from benchmarks.measure import Comparison, Finding, Size
from benchmarks.peers import solve_all_at_once
from nrs_design.certificates.certificate import CommonQuadraticStatus
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method

COUNT, QUICK_COUNT, SMOKE_COUNT = 400, 60, 6
SEED, DECIMALS = 2026, 4
ORDERS, MODES = (2, 12), (2, 5)


def run(size: Size) -> tuple[Comparison | Finding, ...]:
    """Decide all of them, and let a solver script give its opinion on the same ones."""
    families = draw_families(size.pick(COUNT, QUICK_COUNT, SMOKE_COUNT))
    theirs = ours = 0.0
    counts: Counter[str] = Counter()
    for matrices in families:
        system = to_system(matrices, DECIMALS)
        start = perf_counter()
        decision = _decide(system)
        middle = perf_counter()
        opinion = solve_all_at_once(matrices)
        theirs, ours = theirs + perf_counter() - middle, ours + middle - start
        counts[str(decision)] += 1
        counts["opinion"] += opinion.t > 0
    work = f"{len(families)} random families, n = 2..12, m = 2..5"
    decided = counts["exists"] + counts["impossible"]
    result = (
        f"{decided} decided exactly: {counts['exists']} with a function, "
        f"{counts['impossible']} proved to have none"
    )
    note = f"peer: t > 0 for {counts['opinion']}, and nothing proved"
    return (
        Comparison(work, "cvxpy, all modes", theirs, ours, None, note),
        Finding(work, result, "all decided", decided == len(families), ours),
    )


def _decide(system: SwitchedSystem) -> CommonQuadraticStatus:
    limits = Limits(optimize_rate=False)
    status = certify(system, Method.LMI, limits).common_quadratic
    if status is not CommonQuadraticStatus.UNKNOWN:
        return status
    return certify(system, Method.OBSTRUCTION, limits).common_quadratic


def draw_families(count: int) -> list[Matrices]:
    rng = np.random.default_rng(SEED)
    sizes = [
        (int(rng.integers(*ORDERS, endpoint=True)), int(rng.integers(*MODES, endpoint=True)))
        for _ in range(count)
    ]
    return [hurwitz_family(rng, n, m) for n, m in sizes]
