"""``python -m benchmarks``: run them and print the ratios, each when it is there."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from importlib import import_module
from time import perf_counter

from benchmarks.measure import Comparison, Failure, Finding, Size, machine_facts

BENCHMARKS = (
    "cold_pair",
    "verify_shipped",
    "many_modes",
    "exact_check",
    "random_families",
    "gradient_share",
    "beyond_quadratic",
    "impedance_optimum",
    "tissue_fits",
    "bounded_runs",
    "instruction_counts",
    "scenario_runs",
    "gains_with_proof",
)
Result = Comparison | Finding | Failure
HEADS = {
    Comparison: "| work | peer | peer s | ours s | ratio | aim | met | circumstances |",
    Finding: "| work | result | aim | met | s |",
    Failure: "| benchmark | result | s |",
}
MET = {True: "yes", False: "NO", None: "-"}


def main() -> int:
    """Run them; each result is printed when it is there. One that fails is a result, too."""
    options = _parse()
    results: list[Result] = []
    date, facts = f"{datetime.now(UTC):%Y-%m-%d}", machine_facts()
    if not options.json:
        print(f"{date}, {facts}")
    for name in options.only or BENCHMARKS:
        print(f"running {name}", file=sys.stderr)
        for result in results_of(name, _size(options)):
            if not options.json:
                print_row(result, results[-1] if results else None)
            results.append(result)
    if options.json:
        document = {"date": date, "machine": facts, "results": _documents(results)}
        print(json.dumps(document, indent=2))
    return int(any(isinstance(result, Failure) for result in results))


def results_of(name: str, size: Size) -> Sequence[Result]:
    """Run a benchmark; whatever keeps it from its results is its result."""
    start = perf_counter()
    try:
        found: Sequence[Result] = import_module(f"benchmarks.{name}").run(size)
        return found
    except Exception as error:
        return (Failure(name, f"{type(error).__name__}: {error}", perf_counter() - start),)


def _size(options: argparse.Namespace) -> Size:
    if options.smoke:
        return Size.SMOKE
    return Size.QUICK if options.quick else Size.FULL


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer repeats and sizes")
    parser.add_argument("--smoke", action="store_true", help="tiny: only whether each one runs")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument("--only", action="append", choices=BENCHMARKS, help="run this one")
    return parser.parse_args()


def _documents(results: Sequence[Result]) -> list[dict[str, object]]:
    return [
        {**asdict(r), **({"ratio": r.ratio} if isinstance(r, Comparison) else {}), "met": r.met}
        for r in results
    ]


def print_row(result: Result, above: Result | None) -> None:
    """Print a row of a Markdown table, and the head of the table if the row above is of another."""
    if type(result) is not type(above):
        print(f"\n{HEADS[type(result)]}")
        print("|---" * (HEADS[type(result)].count("|") - 1) + "|")
    print(f"| {' | '.join(_cells(result))} |", flush=True)


def _cells(result: Result) -> tuple[str, ...]:
    if isinstance(result, Failure):
        error = " ".join(result.error.split()).replace("|", "/")
        return result.work, f"FAILED: {error}", f"{result.seconds:.3g}"
    if isinstance(result, Finding):
        return result.work, result.result, result.aim, MET[result.met], f"{result.seconds:.3g}"
    r = result
    peer, ours, ratio = (f"{number:.3g}" for number in (r.peer_seconds, r.our_seconds, r.ratio))
    aim = "-" if r.target is None else f"{r.target:.3g}"
    return r.work, r.peer, peer, ours, ratio, aim, MET[r.met], r.note


if __name__ == "__main__":
    sys.exit(main())
