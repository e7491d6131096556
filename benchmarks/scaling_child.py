"""Prove one random family in a process of its own: ``python -m benchmarks.scaling_child n m``."""

from __future__ import annotations

import sys
from time import perf_counter

from benchmarks.families import stable_family, to_system
from benchmarks.measure import prove


def main() -> None:
    n, m = map(int, sys.argv[1:])
    system = to_system(stable_family(n, m, seed=n * m), decimals=3)
    start = perf_counter()
    verdict = prove(system).verdict
    print(f"{verdict} {perf_counter() - start}")


main()
