"""Tiles as tables: CSV, and arrays for NumPy."""

from __future__ import annotations

import csv
import io

import numpy as np

from nrs_design.arrays.archive import to_archive
from nrs_design.sweeps.tile_map import TileMap

ABOUT = "a map of nrs-design"


def tiles_csv(found: TileMap) -> str:
    """Return a row for each tile: its verdict, the id of its certificate, and what it covers."""
    written = io.StringIO()
    rows = csv.writer(written, lineterminator="\n")
    paths = (field.field.path for field in found.grid.fields)
    rows.writerow(["verdict", "certificate", "refuted_in", *paths])
    for place, tile in found.tiles.items():
        certificate = None if tile.certificate is None else found.certificates[tile.certificate].id
        at = [field.text(k) for field, k in zip(found.grid.fields, place, strict=True)]
        rows.writerow([str(tile.verdict), certificate, tile.refuted_in, *at])
    return written.getvalue()


def tiles_npz(found: TileMap) -> bytes:
    """Return arrays with an axis for each field, and what these axes are.

    ``verdict`` and ``refuted_in`` hold words; ``certificate`` the place of one in ``certificates``,
    which holds ids, or -1; ``values_0`` and so on the values of the fields, of intervals the
    borders; ``fields`` their paths, units and cuts.
    """
    grid = found.grid
    shape, tiles = grid.shape, found.tiles.values()
    arrays = {
        "verdict": np.array([str(tile.verdict) for tile in tiles], dtype=np.str_).reshape(shape),
        "refuted_in": np.array([tile.refuted_in or "" for tile in tiles], np.str_).reshape(shape),
        "certificate": np.array(
            [-1 if tile.certificate is None else tile.certificate for tile in tiles], np.int64
        ).reshape(shape),
        "certificates": np.array([one.id for one in found.certificates], dtype=np.str_),
        "fields": np.array(
            [[field.field.path, field.unit, str(field.cut)] for field in grid.fields], np.str_
        ),
    }
    values = {f"values_{k}": np.array(field.values) for k, field in enumerate(grid.fields)}
    return to_archive(ABOUT, arrays | values)
