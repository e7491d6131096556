"""A location of the hybrid loop: controller in force, contacts, and the guards that end it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nrs_design.simulation.flow import Flow
from nrs_design.simulation.loop import Loop, LoopMode
from nrs_design.simulation.scenario import Array

# Tolerance of guards in rad, N m and rad/s: rounding lets neither contact nor logic chatter.
TOLERANCE = 1e-12
# Points of a run, at least.
POINTS = 2000


@dataclass(frozen=True)
class Location:
    """The loop under one controller in one contact, with the guards that end it."""

    index: int  # In the order in which locations are entered
    controller: str  # In force
    mode: LoopMode  # The loop
    # Guards: depths below all surfaces, pushes of `damped` surfaces, `bounds` of conditions.
    flow: Flow
    damped: tuple[int, ...]  # Indices of the surfaces whose pushes are watched
    pushes: Array  # Shape (surfaces, n). Rows of all pushes.
    # Switch, condition, and side (0 lower, 1 upper) of each bound.
    bounds: tuple[tuple[int, int, int], ...]

    @classmethod
    def enter(
        cls,
        loop: Loop,
        controller: str,
        inside: Sequence[bool],
        touched: tuple[int, ...],
        direction: int,
        index: int,
    ) -> Location:
        """Return the loop under a controller in contact, with the signals that may end it.

        `inside`: whether the robot is below each surface; `touched`: indices of those that push;
        `direction`: sign of the one that was touched last.
        """
        scenario, mode, one = loop.scenario, loop.mode(controller, touched), loop.row("one")
        each = range(len(scenario.surfaces))
        pushes = np.array([loop.push(j, mode) for j in each]).reshape(-1, len(one))
        damped = tuple(j for j in each if inside[j] and loop.is_damped(j))
        rows = [*(loop.depth(j, mode) for j in each), *(pushes[j] for j in damped)]
        bounds = []
        for i, switch in enumerate(scenario.control.switches):
            for k, condition in enumerate(switch.conditions):
                if switch.source != controller:
                    continue
                signal = loop.signal(condition.signal, mode, direction)
                for end, bound, sign in ((0, condition.low, 1), (1, condition.high, -1)):
                    if np.isfinite(bound):
                        rows.append(sign * (signal - bound * one))
                        bounds.append((i, k, end))
        # At the end of a flow, its signal is beyond the tolerance.
        across = np.full(len(rows), 2 * TOLERANCE)
        step = scenario.duration / POINTS
        flow = Flow(mode.A, np.array(rows).reshape(-1, len(one)), across, step)
        return cls(index, controller, mode, flow, damped, pushes, tuple(bounds))
