"""Simulated switching: the norm under its bound, the active mode, the phase plane."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.formatting import wrapped_label
from nrs_design.reporting.style import (
    BLUE,
    CYCLE,
    DASHES,
    INK,
    MUTED,
    VERMILLION,
    color,
    legend,
    new_axes,
    new_figure,
    row_labels,
    styled,
)
from nrs_design.simulation.norms import Norm, level_curve

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.simulation.norms import Array
    from nrs_design.simulation.switched import SwitchedRun

# More modes than these share a row, and a color; so many at most have one each by all means.
_ROWS, _ALONE = 24, 6


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
    above, *between, below = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    discrete = system.time is Time.DISCRETE
    shape = {"marker": "o", "markersize": 2.5} if discrete and len(norm) <= 80 else {}
    above.semilogy(
        response.time, np.maximum(norm, np.finfo(float).tiny), color=BLUE, label="run", **shape
    )
    if bound is not None:
        above.semilogy(response.time, bound[1], "--", color=VERMILLION, label=bound[0])
    above.set_ylabel(label)
    for axes in between:
        _draw_deflection(axes, response, deflection)
    if discrete:
        below.locator_params(axis="x", integer=True)
    draw_modes(below, response, groups, labels)
    below.set_xlabel("Time [steps]" if discrete else "Time [s]")
    legend(figure, above)
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


@styled
def draw_phase_plane(
    response: SwitchedRun, system: SwitchedSystem, norms: Mapping[str, Norm]
) -> Figure:
    """Draw a run of a system with two states among level curves, all at the value of the start.

    Norms, roots of Lyapunov functions, are by mode, or one for all modes by no name.
    """
    figure, axes = new_axes(4.5)
    # In discrete time only the points are states; the lines lead from one to the next.
    shape = "o" if system.time is Time.DISCRETE else "None"
    groups = groups_of(response, _names(system))
    for row, group in enumerate(groups):
        dashes = DASHES[row // len(CYCLE) % len(DASHES)]
        label = f"mode {group.name}" if len(group.modes) == 1 else group.name
        path = _path_in(response, group.modes)
        axes.plot(
            *path.T, marker=shape, linestyle=dashes, color=group.tint, markersize=3, label=label
        )
    first, tints = system.modes[int(response.mode[0])].name, {g.name: g.tint for g in groups}
    shown = {name: norm for name, norm in norms.items() if not name or name in tints}
    start = float(norms.get(first, norms.get("", np.linalg.norm))(response.state[0]))
    for name, norm in shown.items():
        tint, label = tints.get(name, VERMILLION), f"level of V{name and f', {name}'}"
        axes.plot(*level_curve(norm, start), "--", color=tint, linewidth=1.2, label=label)
    axes.plot(*response.state[0], "o", color=INK, label="start")
    axes.plot(0, 0, "+", color=MUTED, markersize=11, label="rest")
    x, y = (
        f"State {wrapped_label(name, 40)}{'' if '[' in name else ' [no unit given]'}"
        for name in system.states
    )
    axes.set(xlabel=x, ylabel=y)
    legend(figure, axes, 3)
    return figure


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
    used = list(dict.fromkeys(response.mode.tolist()))
    if len(used) > _ALONE:
        alike: dict[str, list[int]] = {}
        for mode in used:
            alike.setdefault("/".join(names[mode].split("/")[:2]), []).append(mode)
        if len(alike) <= _ALONE:
            return [
                Group(name if len(modes) == 1 else f"{name}: {len(modes)}", tuple(modes), color(i))
                for i, (name, modes) in enumerate(alike.items())
            ]
    single = used if len(used) <= _ROWS else used[: _ROWS - 1]
    groups = [Group(names[m], (m,), color(i)) for i, m in enumerate(single)]
    if len(used) > len(single):
        rest = tuple(used[len(single) :])
        groups.append(Group(f"{len(rest)} other modes", rest, MUTED))
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


def _path_in(response: SwitchedRun, modes: tuple[int, ...]) -> Array:
    """Return the states with every step of another mode cut out by NaN."""
    ends = response.state[1:].copy()
    begins = response.state[:-1].copy()
    inside = np.isin(response.mode, modes)
    ends[~inside], begins[~inside] = np.nan, np.nan
    gaps = np.full_like(begins, np.nan)
    gaps[:-1][inside[1:]] = begins[1:][inside[1:]]
    return np.stack([begins, ends, gaps], axis=1).reshape(-1, 2)
