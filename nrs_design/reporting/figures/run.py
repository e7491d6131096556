"""Simulated switching: the norm under its bound, and the active mode."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.style import (
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    color,
    legend,
    new_figure,
    row_labels,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.simulation.norms import Array
    from nrs_design.simulation.switched import SwitchedRun

# Largest number of rows, and number of modes up to which every mode has a row of its own.
_ROWS, _SINGLE_ROWS = 24, 6


@styled
def draw_run(
    response: SwitchedRun,
    norm: Array,
    bound: tuple[str, Array] | None,
    system: SwitchedSystem,
    label: str,
    deflection: str = "",
) -> Figure:
    """Draw a norm over time, its proved bound, the deflection, and the mode that is active.

    The norm is over its first value. `deflection` names the last state, if it is one that shows
    when contact is lost.
    """
    groups = groups_of(response, _names(system))
    labels, height = row_labels([group.name for group in groups])
    rows = height * len(groups)
    heights = [2.6, *([1.4] if deflection else []), rows]
    figure = new_figure(1.0 + sum(heights))
    norm_axes, *signal_axes, mode_axes = figure.subplots(
        len(heights), 1, sharex=True, height_ratios=heights
    )
    discrete = system.time is Time.DISCRETE
    shape = {"marker": "o", "markersize": 2.5} if discrete and len(norm) <= 80 else {}
    norm_axes.semilogy(
        response.time, np.maximum(norm, np.finfo(float).tiny), color=BLUE, label="run", **shape
    )
    if bound is not None:
        norm_axes.semilogy(response.time, bound[1], "--", color=VERMILLION, label=bound[0])
    norm_axes.set_ylabel(label)
    for axes in signal_axes:
        _draw_deflection(axes, response, deflection)
    if discrete:
        mode_axes.locator_params(axis="x", integer=True)
    draw_modes(mode_axes, response, groups, labels)
    mode_axes.set_xlabel("Time [steps]" if discrete else "Time [s]")
    legend(figure, norm_axes)
    return figure


def _draw_deflection(axes: Axes, response: SwitchedRun, name: str) -> None:
    """Draw the deflection over its largest value, shaded while there is no contact."""
    depth = response.state[:, -1]
    axes.plot(response.time, depth / np.abs(depth).max(), color=BLUE, label=name)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    free, place = (depth <= 0).tolist(), axes.get_xaxis_transform()
    axes.fill_between(
        response.time, 0, 1, where=free, transform=place, color=MUTED, alpha=0.25, linewidth=0
    )
    axes.set_ylabel("Deflection over\nits largest value [1]")
    axes.set_title(f"{name.partition(' [')[0]}; shaded: no contact", loc="left", fontsize=9.5)


@dataclass(frozen=True)
class Group:
    """Modes that are drawn alike: one, or all that there is no room for."""

    name: str
    modes: tuple[int, ...]
    tint: str


def groups_of(response: SwitchedRun, names: Sequence[str]) -> list[Group]:
    """Return the modes of a run in the order of their first use, the last ones together.

    Of many, those with one controller and contact are one: a reader asks for these, not for
    corners of ranges.
    """
    modes = list(dict.fromkeys(response.mode.tolist()))
    if len(modes) > _SINGLE_ROWS:
        alike: dict[str, list[int]] = {}
        for mode in modes:
            alike.setdefault("/".join(names[mode].split("/")[:2]), []).append(mode)
        if len(alike) <= _SINGLE_ROWS:
            return [
                Group(name if len(modes) == 1 else f"{name}: {len(modes)}", tuple(modes), color(i))
                for i, (name, modes) in enumerate(alike.items())
            ]
    single = modes if len(modes) <= _ROWS else modes[: _ROWS - 1]
    groups = [Group(names[m], (m,), color(i)) for i, m in enumerate(single)]
    if len(modes) > len(single):
        remaining_modes = tuple(modes[len(single) :])
        groups.append(Group(f"{len(remaining_modes)} other modes", remaining_modes, MUTED))
    return groups


def _names(system: SwitchedSystem) -> list[str]:
    return [mode.name for mode in system.modes]


def draw_modes(
    axes: Axes, response: SwitchedRun, groups: Sequence[Group], labels: Sequence[str]
) -> None:
    """Draw one bar for each time that a mode is active, one row for each group of modes."""
    edges = np.flatnonzero(np.diff(response.mode)) + 1
    starts = np.concatenate([[0], edges])
    ends = np.concatenate([edges, [len(response.mode)]])
    for row, group in enumerate(groups):
        spans = [
            (response.time[a], response.time[b] - response.time[a])
            for a, b in zip(starts, ends, strict=True)
            if response.mode[a] in group.modes
        ]
        place = (row - 0.35, 0.7)
        axes.broken_barh(spans, place, color=group.tint, linewidth=0, label=group.name)
    axes.set_yticks(range(len(groups)), labels, fontsize=9)
    axes.set_ylim(len(groups) - 0.4, -0.6)
    axes.set_title("Active mode", loc="left", fontsize=9.5)
    axes.grid(visible=False, axis="y")
