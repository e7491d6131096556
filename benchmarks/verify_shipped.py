"""Every shipped certificate verified against its spec, from the start of the process to its end."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from statistics import median

from benchmarks.measure import Child, Finding, Size, run_child

ROOT = Path(__file__).parents[1]
WANTED_SECONDS = 0.5


def run(size: Size) -> tuple[Finding, ...]:
    """Measure whole processes, the certificates in turn; the slowest comes first."""
    specs = {path.name.split(".")[0]: path for path in (ROOT / "specs").glob("*/*.nrs.yaml")}
    every = sorted((ROOT / "reports").glob("*.cert.json"))
    certificates = size.pick(every, every, every[:1])
    children: dict[Path, list[Child]] = {path: [] for path in certificates}
    with tempfile.TemporaryDirectory() as folder:
        # The first round compiles all modules and does not count.
        for k in range(size.pick(8, 4, 2)):
            for path in certificates:
                spec = specs[path.name.split(".")[0]]
                command = ["-m", "nrs_design", "verify", str(path), str(spec), "--quiet"]
                child = run_child([sys.executable, *command], folder)
                if k:
                    children[path].append(child)
    findings = (_finding(path, found) for path, found in children.items())
    return tuple(sorted(findings, key=lambda finding: -finding.seconds))


def _finding(path: Path, children: list[Child]) -> Finding:
    document = json.loads(path.read_text(encoding="utf-8"))
    free = len(document.get("contact", {}).get("free", ()))
    kinds = dict.fromkeys(statement["kind"] for statement in document["statements"])
    result = f"{len(document['modes']) + free} modes of order {len(document['states'])}"
    # What else the machine does makes the processor time longer, never shorter.
    least = min(child.processor for child in children)
    taken = median(child.seconds for child in children)
    return Finding(
        f"verify {path.name.removesuffix('.cert.json')}, cold process",
        f"{document['verdict']}; {result}; {', '.join(kinds)}; least processor time {least:.3g} s",
        f"wall time below {WANTED_SECONDS} s",
        taken < WANTED_SECONDS,
        taken,
    )
