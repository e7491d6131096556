"""Time and peak memory against the number of modes and against the order.

``python -m benchmarks.scaling n m`` proves one random family in a process of its own.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from benchmarks.families import stable_family, to_system
from benchmarks.measure import Finding, Size, prove, run_child

MODES, QUICK_MODES, SMOKE_MODES = (16, 64, 256, 1024, 4096, 16384), (16, 64, 256), (4,)
ORDERS, QUICK_ORDERS, SMOKE_ORDERS = (5, 10, 20, 30, 40), (5, 10), (3,)
MEGABYTES = (50, 100, 200, 400, 800)
FIXED_ORDER, FIXED_MODES = 6, 2
FIGURE = Path(__file__).parents[1] / "reports" / "scaling.png"


@dataclass(frozen=True)
class Point:
    """One family: its size, verdict, time of the proof in s, peak memory of the process in MB."""

    n: int
    m: int
    verdict: str
    seconds: float
    megabytes: float


def run(size: Size) -> tuple[Finding, ...]:
    """Measure every size in a cold process; in full, draw the figure too."""
    modes = size.pick(MODES, QUICK_MODES, SMOKE_MODES)
    orders = size.pick(ORDERS, QUICK_ORDERS, SMOKE_ORDERS)
    by_modes = [_measure(FIXED_ORDER, m) for m in modes]
    by_order = [_measure(n, FIXED_MODES) for n in orders]
    if size is Size.FULL:
        _draw(by_modes, by_order)
    return tuple(_report(point) for point in (*by_modes, *by_order))


def _measure(n: int, m: int) -> Point:
    child = run_child([sys.executable, "-m", "benchmarks.scaling", str(n), str(m)])
    verdict, seconds = child.output.split() if child.code == 0 else ("failed", child.seconds)
    return Point(n, m, verdict, float(seconds), child.megabytes)


def _report(point: Point) -> Finding:
    proved = point.verdict == "proved"
    result = f"{point.verdict}, {point.megabytes:.0f} MB"
    return Finding(f"n = {point.n}, m = {point.m}", result, "proved", proved, point.seconds)


def _draw(by_modes: list[Point], by_order: list[Point]) -> None:
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullLocator

    figure = Figure(figsize=(9, 6), layout="constrained")
    axes = figure.subplots(2, 2, sharex="col", sharey="row")
    columns = (
        (by_modes, [p.m for p in by_modes], f"number of modes m (order n = {FIXED_ORDER})"),
        (by_order, [p.n for p in by_order], f"order n (m = {FIXED_MODES} modes)"),
    )
    for (points, sizes, label), (upper, lower) in zip(columns, axes.T, strict=True):
        upper.loglog(sizes, [p.seconds for p in points], "o-")
        lower.loglog(sizes, [p.megabytes for p in points], "s-", color="tab:orange")
        lower.set_xlabel(label)
        lower.set_xticks(sizes, [str(size) for size in sizes])
        lower.set_yticks(MEGABYTES, [str(megabytes) for megabytes in MEGABYTES])
        for panel in (upper, lower):
            panel.xaxis.set_minor_locator(NullLocator())
            panel.grid(alpha=0.3)
        lower.yaxis.set_minor_locator(NullLocator())
    axes[0, 0].set_ylabel("time of the proof (s)")
    axes[1, 0].set_ylabel("peak memory of the process (MB)")
    FIGURE.parent.mkdir(exist_ok=True)
    figure.savefig(FIGURE, dpi=150)


def main() -> None:
    n, m = map(int, sys.argv[1:])
    system = to_system(stable_family(n, m, seed=n * m), decimals=3)
    start = perf_counter()
    verdict = prove(system).verdict
    print(f"{verdict} {perf_counter() - start}")


if __name__ == "__main__":
    main()
