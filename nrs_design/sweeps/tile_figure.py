"""Which tiles are proved, refuted or undecided, as a figure."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict
from nrs_design.reporting.style import BLUE, GRID, INK, ORANGE, VERMILLION, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.sweeps.marks import Mark
    from nrs_design.sweeps.tile_map import TileMap
    from nrs_design.sweeps.tiles import TileField

LOOKS = {
    str(Verdict.PROVED): BLUE,
    str(Verdict.REFUTED): VERMILLION,
    str(Verdict.INCONCLUSIVE): GRID,
}


@styled
def draw_tile_map(found: TileMap, marks: Sequence[Mark] = ()) -> Figure:
    """Draw the tiles of one or two fields, the first one across.

    Parameters
    ----------
    found : TileMap
        Of three fields, the tiles at the first value of the last one.
    marks : sequence of Mark
        Intervals that are drawn in.
    """
    from nrs_design.plotting import Patch, Rectangle

    figure, axes = new_axes()
    across, up = found.grid.fields[0], (*found.grid.fields, None)[1]
    left, bottom = _borders(across), [0.0, 1.0] if up is None else _borders(up)
    for place, tile in found.tiles.items():
        if any(place[2:]):
            continue
        i, j = place[0], place[1] if up is not None else 0
        look = LOOKS.get(tile.shown, ORANGE)
        size = left[i + 1] - left[i], bottom[j + 1] - bottom[j]
        axes.add_patch(
            Rectangle((left[i], bottom[j]), *size, facecolor=look, edgecolor="white", linewidth=0.5)
        )
    axes.set(xlim=(left[0], left[-1]), ylim=(bottom[0], bottom[-1]), xlabel=_label(across))
    if up is None:
        axes.set_yticks([])
    else:
        axes.set_ylabel(_label(up))
        _name_whole(axes, up)
    axes.grid(visible=False)
    for mark in marks:
        _draw_mark(axes, mark)
    handles = [
        Patch(facecolor=LOOKS.get(name, ORANGE), edgecolor=INK, label=name.capitalize())
        for name, count in found.counts().items()
        if count
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    return figure


def _draw_mark(axes: Axes, mark: Mark) -> None:
    """Draw the ends of an interval as lines through the tiles, with its name between them."""
    middle = (mark.low + mark.high) / 2
    line = axes.axvline if mark.axis == 0 else axes.axhline
    for end in {mark.low, mark.high}:
        line(end, color=INK, linewidth=1.0, linestyle="--")
    if mark.axis == 0:
        name = axes.text(middle, 0.98, mark.name, rotation=90, va="top", ha="center")
        name.set_transform(axes.get_xaxis_transform())
    else:
        name = axes.text(0.98, middle, mark.name, va="center", ha="right")
        name.set_transform(axes.get_yaxis_transform())
    name.set(color=INK, clip_on=True)


def _borders(field: TileField) -> list[float]:
    """Return where tiles begin and end: those of single values are around them."""
    values = list(field.values)
    if len(values) > field.count:
        return values
    if len(values) == 1:
        return [values[0] - 0.5, values[0] + 0.5]
    between = [(a + b) / 2 for a, b in pairwise(values)]
    first, last = values[0] - (between[0] - values[0]), values[-1] + (values[-1] - between[-1])
    return [first, *between, last]


def _label(field: TileField) -> str:
    cut = {"up to": ", up to", "interval": "", "point": ""}[str(field.cut)]
    unit = field.unit or "1"
    return f"{field.field.path}{cut} [{unit}]"


def _name_whole(axes: Axes, field: TileField) -> None:
    """Name whole numbers, where the field has no others."""
    if all(value == int(value) for value in field.values) and field.count == len(field.values):
        step = max(1, field.count // 12)
        axes.set_yticks(list(field.values)[::step])
