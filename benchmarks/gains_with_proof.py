"""Gains with their proof: how many designs are evaluated, beside a search that knows no slopes.

The peer is SciPy's `differential_evolution` on the same cost, constraint and penalty, over the same
gains. It ends as soon as it is within `WITHIN` of the cost that was found here.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution

from benchmarks.measure import Finding, Size
from nrs_design.design.trust_region import (
    ConstrainedProblem,
    Evaluation,
    minimize_in_trust_region,
)
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.free_gains import gain_branches
from nrs_design.pipeline.proof_constraints import evaluator, rate_constraint
from nrs_design.pipeline.runs import run_interaction
from nrs_design.progress import silent
from nrs_design.spec import read_spec

Array = NDArray[np.float64]

SPEC = Path(__file__).parents[1] / "specs/neuroboscope/soft-tissue-sampled.nrs.yaml"
WANTED = 2.0
WITHIN, FEWER = 5e-4, 20
# The peer looks for dampings only, a box around what is found: that is easier.
BOX = 0.3


class Reached(Exception):
    """The peer is as good."""


def run(size: Size) -> tuple[Finding, ...]:
    """Count evaluations of the decay rate, ours and the peer's."""
    most = size.pick(400, 60, 3)
    text = SPEC.read_text(encoding="utf-8").replace(
        "Mt: {min: 0.01 kg*m^2, max: 1 kg*m^2}", "Mt: 0.01 kg*m^2"
    )
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.nrs.yaml"
        path.write_text(text, encoding="utf-8")
        designed = run_interaction(read_spec(path), "has no gains")
        (gains,) = gain_branches(designed, run_analysis(designed))
        constraint = rate_constraint(WANTED, WANTED)

        def evaluate(x: Array, expected: Array | None) -> Evaluation:
            # Each has its own budget, which the peer would use up.
            return evaluator(gains, (constraint,), silent)(x, expected)

        problem = ConstrainedProblem(gains.cost, evaluate, gains.low, gains.high, gains.spared)
        start = process_time()
        ours = minimize_in_trust_region(problem, evaluate(gains.optimum(), None))
        taken, count = process_time() - start, 0

        def merit(x: Array) -> float:
            nonlocal count
            count += 1
            if count > most:
                raise Reached
            found = gains.cost(x) + problem.penalty(evaluate(x, None).values)
            if found < ours.cost + WITHIN:
                raise Reached
            return found

        box = [(value - BOX, value + BOX) for value in ours.last.x]
        with suppress(Reached):
            differential_evolution(merit, box, seed=1, popsize=8, polish=False)
    end = f"at least {count - 1}" if count > most else f"{count}"
    return (
        Finding(
            "dampings of two controllers with a proved decay of 2 1/s, at the least cost",
            f"{ours.evaluations} designs, {end} by differential evolution within {WITHIN:g}",
            f"{FEWER} times fewer",
            count >= FEWER * ours.evaluations,
            taken,
        ),
    )
