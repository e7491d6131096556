"""The processor of an axis: its law runs at every sample, and motor and tissue move in between."""

from __future__ import annotations

import math

from nrs_design.progress import Progress
from nrs_design.simulation.run import Run
from nrs_design.simulation.sampled_axis import SampledAxis, SampleInputs

# Samples after which it is told how far the run is.
_OFTEN = 20_000


def run_axis(axis: SampledAxis, max_steps: int, tell: Progress) -> Run:
    """Run the law of an axis at the samples of its scenario, at most so many."""
    wanted = math.floor(axis.scenario.duration / axis.T + 1e-9) + 1
    count = min(wanted, max_steps)
    inputs = SampleInputs.of(axis.scenario, axis.T, axis.delay, axis.late, axis.misses, count)
    instants = [*inputs.times.tolist(), float(inputs.times[-1]) + axis.T]
    drawn = (inputs.hand, inputs.noise, inputs.ages, inputs.lates, inputs.missed)
    rows = list(zip(*(column.tolist() for column in drawn), strict=True))
    stopped = None
    if count < wanted:
        stopped = f"{max_steps} samples by {instants[count - 1]:.6g} s: the budget is used up"
    for k in range(count):
        t = instants[k]
        axis.sample(t, *rows[k])
        axis.move(instants[k + 1] - t)
        if k % _OFTEN == 0:
            tell(f"{t:.3g} s")
    return axis.finish(inputs, stopped)
