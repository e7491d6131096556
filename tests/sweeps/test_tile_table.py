"""Tiles as CSV and as arrays: the same, and whose they are."""

import csv
import io

import numpy as np
import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.output import MAP, MAP_ARCHIVE
from nrs_design.spec import read_spec
from nrs_design.sweeps.tile_map import TileMap, TileVerdict
from nrs_design.sweeps.tile_table import tiles_csv, tiles_npz
from nrs_design.sweeps.tiles import read_tiles
from tests.support import ROOT

SAMPLED = ROOT / "specs" / "neuroboscope" / "soft-tissue-sampled.nrs.yaml"


class Named:
    """A certificate, of which a table needs the id."""

    def __init__(self, name):
        self.id = name


@pytest.fixture(scope="module")
def found():
    fields = ["environments.soft.stiffness=300..900/3 N/m", "sampling.delay=0..1"]
    grid = read_tiles(read_spec(SAMPLED), SAMPLED, fields)
    open_tile = TileVerdict(Verdict.INCONCLUSIVE)
    tiles = {(k, level): open_tile for k in range(3) for level in range(2)}
    tiles[0, 0] = tiles[0, 1] = TileVerdict(Verdict.PROVED, 1)
    tiles[2, 1] = TileVerdict(Verdict.INCONCLUSIVE, 0, "in kept contact")
    return TileMap(grid, tiles, (Named("a" * 64), Named("b" * 64)), ((), ()), 1, 0, 1)


def test_arrays_have_an_axis_for_each_field(found):
    content = tiles_npz(found)
    assert content.startswith(MAP_ARCHIVE)
    assert content == tiles_npz(found)
    with np.load(io.BytesIO(content)) as arrays:
        assert arrays["verdict"].shape == (3, 2)
        assert arrays["values_0"].tolist() == [300, 500, 700, 900]
        assert arrays["values_1"].tolist() == [0, 1]
        assert arrays["fields"].tolist()[1] == ["sampling.delay", "", "up to"]
        assert arrays["certificate"].tolist() == [[1, 1], [-1, -1], [-1, 0]]
        rows = list(csv.reader(io.StringIO(tiles_csv(found))))[1:]
        names = [*arrays["certificates"].tolist(), ""]
        flat = zip(
            arrays["verdict"].ravel(),
            arrays["certificate"].ravel(),
            arrays["refuted_in"].ravel(),
            strict=True,
        )
        assert [row[:3] for row in rows] == [[v, names[k], where] for v, k, where in flat]


def test_a_table_says_what_a_tile_covers(found):
    text = tiles_csv(found)
    assert text.encode().startswith(MAP)
    assert text.splitlines()[6].endswith(",in kept contact,700..900 N/m,1")
