"""Borders drawn finer: tiles that are not proved are halved beside those that are."""

from __future__ import annotations

from dataclasses import replace

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import SpecError
from nrs_design.pipeline import Designed
from nrs_design.progress import Progress, silent
from nrs_design.sweeps.paint import repaint
from nrs_design.sweeps.tile_map import TileMap
from nrs_design.sweeps.tiles import MOST_TILES, TileCut, TileGrid


def refined(
    found: TileMap, designed: Designed | None, times: int, progress: Progress = silent
) -> TileMap:
    """Halve the intervals of tiles that are not proved, but lie beside one that is.

    The border goes through all other fields: a grid stays a grid.

    Parameters
    ----------
    found : TileMap
        The map.
    designed : Designed or None
        The gains of the spec.
    times : int
        How often.
    progress : callable
        Told how many tiles are decided.

    Raises
    ------
    SpecError
        If the tiles become too many.
    """
    for _ in range(times):
        grid = finer_grid(found)
        if grid is None:
            break
        found = repaint(found, grid, designed, progress)
    return found


def finer_grid(found: TileMap) -> TileGrid | None:
    """Return the tiles with borders of what is proved halved; None if there is none to halve.

    Raises
    ------
    SpecError
        If the tiles become too many.
    """
    fields = list(found.grid.fields)
    for axis, field in enumerate(found.grid.fields):
        if field.cut is TileCut.INTERVAL:
            fields[axis] = field.cut_finer(_beside_proved(found, axis))
    grid = replace(found.grid, fields=tuple(fields))
    if grid.shape == found.grid.shape:
        return None
    if grid.count > MOST_TILES:
        raise SpecError(
            f"the refined map has {grid.count} tiles, more than {MOST_TILES}",
            remedy="refine less often",
        )
    return grid


def _beside_proved(found: TileMap, axis: int) -> set[int]:
    """Return which tiles along a field are not proved, beside one that is."""
    beside = set[int]()
    for place, tile in found.tiles.items():
        if tile.verdict is Verdict.PROVED or tile.wrong:
            continue
        for step in (-1, 1):
            other = (*place[:axis], place[axis] + step, *place[axis + 1 :])
            near = found.tiles.get(other)
            if near is not None and near.verdict is Verdict.PROVED:
                beside.add(place[axis])
    return beside
