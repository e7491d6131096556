"""Instructions of exported laws on a Cortex-M4F, counted twice, with cycles, stack and code."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from benchmarks.cortex import Compiled, Counts, measure, versions
from benchmarks.measure import Finding, Size
from nrs_design.controllers.shipped import shipped_law
from nrs_design.exporters.build import build_unproved
from nrs_design.exporters.formats.c import header_text, source_text
from nrs_design.exporters.self_test import draw_cases
from nrs_design.exporters.text import CNames
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec

HERE = Path(__file__).parent
SPECS = HERE.parent / "specs" / "neuroboscope"
PERIOD = Fraction(1, 500)
COUNT, FEW, FEWEST = 1000, 100, 20


# Each law by its name: its spec, and how many instructions are aimed for.
LAWS = {
    "hybrid impedance axis with guards": (HERE / "hybrid.nrs.yaml", 200),
    "soft-tissue-sampled": (SPECS / "soft-tissue-sampled.nrs.yaml", None),
    "force-limit-sampled": (SPECS / "force-limit-sampled.nrs.yaml", None),
}


def run(size: Size) -> tuple[Finding, ...]:
    """Count every law; one more line says whether both ways of counting agree."""
    count, alike, findings = size.pick(COUNT, FEW, FEWEST), [], []
    for name, (file, goal) in LAWS.items():
        begin = perf_counter()
        found, valid = _count(file, count)
        seconds = perf_counter() - begin
        alike.append(bool((found.instructions == found.by_clock).all()))
        most = int(found.instructions.max())
        aim = "-" if goal is None else f"at most {goal}"
        findings.append(
            Finding(name, _words(found, valid), aim, goal is None or most <= goal, seconds)
        )
    result = f"{sum(alike)} of {len(alike)} laws alike in each of {count} cases; {versions()}"
    aim = "both ways to count agree"
    return (*findings, Finding("instructions, counted twice", result, aim, all(alike), 0.0))


def _count(file: Path, count: int) -> tuple[Counts, NDArray[np.bool_]]:
    """Count cases of the law of a spec, and return which of them are not refused."""
    loaded = read_spec(file)
    designed = run_design(loaded)
    assert designed is not None
    law = shipped_law(designed.spec, designed.design, PERIOD)
    # What the comments of its C say of a proof is not compiled.
    record = build_unproved(loaded, designed.design, "a benchmark", PERIOD, None)
    names, cases = CNames(record.spec.name), draw_cases(law, count)
    texts = header_text(record, law, names), source_text(record, law, names)
    rows = cases.rows[:, : bool(law.modes) + len(law.inputs) + len(law.states)]
    compiled = Compiled(names.spec, *texts, names.lower, rows, len(law.states))
    with TemporaryDirectory() as folder:
        found = measure(Path(folder), compiled)
    return found, cases.rows[:, cases.columns.index("valid")] == 1


def _words(found: Counts, valid: NDArray[np.bool_]) -> str:
    n, refused = found.instructions[valid], found.instructions[~valid]
    return (
        f"{n.min()}, {np.mean(n):.1f}, {n.max()} instructions (least, mean, most), "
        f"{refused.max()} at most where a step is refused; "
        f"{found.cycles[valid].min()} to {found.cold_cycles.max()} cycles, modelled; "
        f"stack {found.stack} B, code {found.code} B"
    )
