"""The processor of all axes: their laws run at the same samples, and a body moves in between."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

from nrs_design.errors import PoseError
from nrs_design.progress import Progress
from nrs_design.simulation.run import Run
from nrs_design.simulation.sampled_axis import SampledAxis, SampleInputs

# Samples after which it is told how far the run is.
_OFTEN = 20_000


class AbstractBody(Protocol):
    """What the commands of all axes move, and what touches them."""

    def move(self, axes: Sequence[SampledAxis], commands: Sequence[float], width: float) -> None:
        """Move all axes under held commands: angles, velocities, and dampers of tissue.

        Parameters
        ----------
        axes : sequence of SampledAxis
            As they are.
        commands : sequence of float
            One for each.
        width : float
            Time in s.

        Raises
        ------
        PoseError
            If the robot cannot reach where they would go.
        """


class Motors:
    """Every axis by itself: its motor, and tissue that may load it."""

    def move(self, axes: Sequence[SampledAxis], commands: Sequence[float], width: float) -> None:
        """Move every axis; see `AbstractBody`.

        Parameters
        ----------
        axes, commands, width
            As there.
        """
        for axis in axes:
            axis.move(width)


def run_axes(
    axes: Sequence[SampledAxis], body: AbstractBody, engine: str, max_steps: int, tell: Progress
) -> tuple[Run, ...]:
    """Run the laws of all axes on one processor, at the same samples.

    Parameters
    ----------
    axes : sequence of SampledAxis
        At rest; their scenarios are equally long, and jitter is that of the first one.
    body : AbstractBody
        What they move.
    engine : str
        Its name.
    max_steps : int
        Samples after which the run ends.
    tell : callable
        Told how far the run is.

    Returns
    -------
    tuple of Run
        One for each axis.
    """
    first = axes[0]
    wanted = math.floor(first.scenario.duration / first.T + 1e-9) + 1
    count = min(wanted, max_steps)
    inputs = [SampleInputs.of(a.scenario, first.T, a.delay, a.late, a.misses, count) for a in axes]
    instants = [*inputs[0].times.tolist(), float(inputs[0].times[-1]) + first.T]
    drawn = [(f.hand, f.noise, f.ages, f.lates, f.missed) for f in inputs]
    rows = [list(zip(*(column.tolist() for column in f), strict=True)) for f in drawn]
    stopped = None
    if count < wanted:
        stopped = f"{max_steps} samples by {instants[count - 1]:.6g} s: the budget is used up"
    for k in range(count):
        t = instants[k]
        commands = [axis.sample(t, *row[k]) for axis, row in zip(axes, rows, strict=True)]
        try:
            body.move(axes, commands, instants[k + 1] - t)
        except PoseError:
            stopped = f"the robot leaves what it can reach after {t:.6g} s"
            break
        if k % _OFTEN == 0:
            tell(f"{t:.3g} s")
    return tuple(axis.finish(engine, one, stopped) for axis, one in zip(axes, inputs, strict=True))
