"""``python -m benchmarks``: run them and print the ratios."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from datetime import UTC, datetime
from importlib import import_module

from benchmarks.measure import Comparison, machine_facts

BENCHMARKS = ("cold_pair", "many_modes", "tight_margins", "impedance_optimum", "robot_dynamics")


def main() -> None:
    options = _parse()
    results: list[Comparison] = []
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
    _print_table(results)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer repeats and sizes")
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    parser.add_argument("--only", action="append", choices=BENCHMARKS, help="run this one")
    return parser.parse_args()


def _documents(results: list[Comparison]) -> list[dict[str, object]]:
    return [{**asdict(r), "ratio": r.ratio, "met": r.met} for r in results]


def _print_table(results: list[Comparison]) -> None:
    """Print the results as a Markdown table."""
    print("| work | peer | peer s | ours s | ratio | aim | met | circumstances |")
    print("|---|---|---|---|---|---|---|---|")
    for r in results:
        stopped = f"> {r.at_least_seconds:.0f}" if r.peer_seconds is None else ""
        peer = stopped or f"{r.peer_seconds:.3g}"
        ratio = f"{'> ' if stopped else ''}{r.ratio:.3g}"
        print(
            f"| {r.work} | {r.peer} | {peer} | {r.our_seconds:.3g} | {ratio} | "
            f"{r.target:.2g} | {'yes' if r.met else 'NO'} | {r.note} |"
        )


main()
