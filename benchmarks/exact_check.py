"""The exact check alone, as `certify` makes it, against leading minors in SymPy (SABBATH)."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from time import perf_counter

from benchmarks.measure import Comparison, Finding, Size, time_side_by_side
from benchmarks.sylvester import check_apart, proved_family
from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.system import SwitchedSystem

ORDERS, QUICK_ORDERS = (6, 8, 13, 18, 21), (6, 8, 13)
TARGET = 500.0
# The aim is stated for these orders and above.
FROM_ORDER = 13
PEERS = {"python": "SymPy alone", "flint": "SymPy on python-flint"}
FAMILY_ORDER, FAMILY_MODES, FAMILY_SECONDS = 20, 1000, 0.7


def run(size: Size) -> tuple[Comparison | Finding, ...]:
    """Check two modes at several orders, then a large family."""
    orders = size.pick(ORDERS, QUICK_ORDERS, QUICK_ORDERS[:1])
    modes = size.pick(FAMILY_MODES, FAMILY_MODES, 10)
    pairs = [comparison for n in orders for comparison in _check_pair(n)]
    return (*pairs, _check_family(modes, size.pick(5, 1, 1)))


def _check_pair(n: int) -> list[Comparison]:
    system, evidence = proved_family(n, 2)
    (ours,), (fault,) = time_side_by_side(9, lambda: evidence.find_fault(system))
    comparisons = []
    for ground_types, peer in PEERS.items():
        accepted, theirs = check_apart(n, ground_types)
        note = "the same Q and rate, accepted by both" if accepted and not fault else "DISAGREE"
        target = TARGET if n >= FROM_ORDER else None
        work = f"exact check, 2 modes, n = {n}"
        comparisons.append(Comparison(work, peer, theirs, ours, target, note))
    return comparisons


def _check_family(modes: int, repeats: int) -> Finding:
    system, evidence = proved_family(FAMILY_ORDER, modes)
    times: Sequence[float] = [_time_check(system, evidence) for _ in range(repeats)]
    seconds = median(times)
    work = f"exact check, n = {FAMILY_ORDER}, m = {modes}"
    result = f"{len(system.modes) + 1} forms in {seconds:.2f} s"
    return Finding(work, result, f"below {FAMILY_SECONDS} s", seconds < FAMILY_SECONDS, seconds)


def _time_check(system: SwitchedSystem, evidence: FormsOnGraph) -> float:
    start = perf_counter()
    assert evidence.find_fault(system) is None
    return perf_counter() - start
