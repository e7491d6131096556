"""One two-mode pair in a cold process: a solver script, and mere imports, against the proof.

The second comparison is with bare imports, the third with a command on the same libraries that does
nothing: a command of Typer loads more than its import, to read its first argument. The fourth sets
that command beside the bare imports: what is left for a proof, of the times that are wanted.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from statistics import median

from benchmarks.measure import Comparison, Size, run_child

HERE = Path(__file__).parent
TARGET = 4.0
WANTED_SECONDS = 0.6
IMPORTS = "import numpy, typer, pydantic, ruamel.yaml"
# The proof may take so many times what the imports take.
MOST_IMPORTS = 1.4


def run(size: Size) -> tuple[Comparison, ...]:
    """Measure whole processes, in turn."""
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "pair.cert.json")
        spec = str(HERE / "soft-tissue-pair.nrs.yaml")
        ours = [sys.executable, "-m", "nrs_design"]
        prove = [*ours, "certify-switching", spec, "--out", out, "--no-optimize-rate", "--json"]
        commands = (
            [sys.executable, str(HERE / "peer_pair.py")],
            [sys.executable, "-c", IMPORTS],
            [sys.executable, str(HERE / "empty_command.py")],
            prove,
            [*ours, "verify", out, spec],
        )
        # The first round compiles all modules and does not count.
        rounds = [
            [run_child(command, folder) for command in commands] for _ in range(size.pick(10, 4, 2))
        ][1:]
    script, imports, empty, proof, check = (
        median(children[k].seconds for children in rounds) for k in range(len(commands))
    )
    theirs, _, _, mine, _ = rounds[-1]
    document = json.loads(mine.output)
    note = (
        f"peer: {theirs.output.strip()} in floating point, {theirs.megabytes:.0f} MB; "
        f"ours: {document['verdict']} exactly, alpha {document['decay_rate']:.4g} 1/s, certificate "
        f"written, {mine.megabytes:.0f} MB; at most {WANTED_SECONDS} s "
        f"{'kept' if proof <= WANTED_SECONDS else 'MISSED'}"
    )
    bare = f"python -c '{IMPORTS}'"
    pair, least = "one pair, cold process, no rate search", 1 / MOST_IMPORTS
    limit = f"at most {MOST_IMPORTS} times as long is wanted: {{:.2f}} times"
    start = f"{empty / imports:.2f} times: what a proof on these libraries starts from"
    nothing = "command that does nothing"
    parts = f"{nothing}: these imports, flint, one model of pydantic, Typer's parse"
    verified = "its certificate verified, cold process"
    return (
        Comparison(pair, "cvxpy script", script, proof, TARGET, note),
        Comparison(pair, bare, imports, proof, least, limit.format(proof / imports)),
        Comparison(pair, f"{nothing}, on the same libraries", empty, proof, None),
        Comparison(parts, bare, imports, empty, None, start),
        Comparison(verified, bare, imports, check, least, limit.format(check / imports)),
    )
