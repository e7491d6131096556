"""One two-mode pair in a cold process: a solver script against ``nrs-design certify-switching``."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from statistics import median

from benchmarks.measure import Comparison, run_child

HERE = Path(__file__).parent
TARGET = 3.0
WANTED_SECONDS = 0.6


def run(quick: bool) -> tuple[Comparison, ...]:
    """Measure wall time and peak memory of both processes, in turn."""
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "pair.cert.json")
        spec = str(HERE / "soft-tissue-pair.nrs.yaml")
        ours = [sys.executable, "-m", "nrs_design", "certify-switching", spec, "--out", out]
        ours += ["--no-optimize-rate", "--json"]
        peer = [sys.executable, str(HERE / "peer_pair.py")]
        # The first pair compiles all modules and does not count.
        pairs = [
            (run_child(peer, folder), run_child(ours, folder)) for _ in range(4 if quick else 10)
        ][1:]
    theirs, mine = pairs[-1]
    document = json.loads(mine.output)
    seconds = median(m.seconds for _, m in pairs)
    note = (
        f"peer: {theirs.output.strip()} in floating point, {theirs.megabytes:.0f} MB; "
        f"ours: {document['verdict']} exactly, alpha {document['decay_rate']:.4g} 1/s, certificate "
        f"written, {mine.megabytes:.0f} MB; at most {WANTED_SECONDS} s "
        f"{'kept' if seconds <= WANTED_SECONDS else 'MISSED'}"
    )
    return (
        Comparison(
            "one pair, cold process, no rate search",
            "cvxpy script",
            median(p.seconds for p, _ in pairs),
            seconds,
            TARGET,
            note,
        ),
    )
