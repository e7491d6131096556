"""``python -m benchmarks``: run them and print the ratios."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from datetime import UTC, datetime
from importlib import import_module

from benchmarks.measure import Comparison, Finding, machine_facts

BENCHMARKS = (
    "cold_pair",
    "verify_shipped",
    "many_modes",
    "tight_margins",
    "high_order",
    "exact_check",
    "random_families",
    "gradient_share",
    "beyond_quadratic",
    "impedance_optimum",
    "tissue_fits",
    "robot_dynamics",
    "scaling",
    "bounded_runs",
    "instruction_counts",
    "scenario_runs",
)
MET = {True: "yes", False: "NO", None: "-"}


def main() -> None:
    options = _parse()
    results: list[Comparison | Finding] = []
    facts = machine_facts()
    for name in options.only or BENCHMARKS:
        print(f"running {name}", file=sys.stderr)
        results += import_module(f"benchmarks.{name}").run(options.quick)
    date = f"{datetime.now(UTC):%Y-%m-%d}"
    if options.json:
        print(
            json.dumps({"date": date, "machine": facts, "results": _documents(results)}, indent=2)
        )
        return
    print(f"{date}, {facts}\n")
    _print_comparisons([r for r in results if isinstance(r, Comparison)])
    _print_findings([r for r in results if isinstance(r, Finding)])


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer repeats and sizes")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument("--only", action="append", choices=BENCHMARKS, help="run this one")
    return parser.parse_args()


def _documents(results: list[Comparison | Finding]) -> list[dict[str, object]]:
    return [
        {**asdict(r), **({"ratio": r.ratio} if isinstance(r, Comparison) else {}), "met": r.met}
        for r in results
    ]


def _print_comparisons(results: list[Comparison]) -> None:
    """Print ratios as a Markdown table."""
    if not results:
        return
    print("| work | peer | peer s | ours s | ratio | aim | met | circumstances |")
    print("|---|---|---|---|---|---|---|---|")
    for r in results:
        stopped = f"> {r.at_least_seconds:.0f}" if r.peer_seconds is None else ""
        peer = stopped or f"{r.peer_seconds:.3g}"
        ratio = f"{'> ' if stopped else ''}{r.ratio:.3g}"
        aim = "-" if r.target is None else f"{r.target:.3g}"
        print(
            f"| {r.work} | {r.peer} | {peer} | {r.our_seconds:.3g} | {ratio} | "
            f"{aim} | {MET[r.met]} | {r.note} |"
        )


def _print_findings(results: list[Finding]) -> None:
    """Print what is not a ratio of two times as a Markdown table."""
    if not results:
        return
    print("\n| work | result | aim | met | s |")
    print("|---|---|---|---|---|")
    for r in results:
        print(f"| {r.work} | {r.result} | {r.aim} | {MET[r.met]} | {r.seconds:.3g} |")


main()
