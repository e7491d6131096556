"""What is known of tiles while they are decided: by columns, and levels of these."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from nrs_design.certificates.certificate import Certificate, Verdict
from nrs_design.errors import SpecError
from nrs_design.pipeline.quick_verdict import QuickVerdict
from nrs_design.sweeps.tile_map import Place, TileMap, TileVerdict
from nrs_design.sweeps.tiles import Box, Span, TileCut, TileGrid


class Board:
    """Tiles with their verdicts; a column is a tile of all fields but the one that has levels.

    Parameters
    ----------
    grid : TileGrid
        The tiles.
    """

    def __init__(self, grid: TileGrid) -> None:
        self.grid = grid
        cuts = [one.cut for one in grid.fields]
        self._leveled = cuts.index(TileCut.UP_TO) if TileCut.UP_TO in cuts else None
        self.top = 0 if self._leveled is None else grid.shape[self._leveled] - 1
        others = [k for k in range(len(cuts)) if k != self._leveled]
        self.whole: Box = tuple((0, grid.shape[k] - 1) for k in others)
        # Along which fields columns make no box: values by themselves have no range.
        self.mixed = [axis for axis, k in enumerate(others) if cuts[k] is TileCut.POINT]
        columns = list(places_of(self.whole))
        # Highest level that is proved, and highest that may be: those above are refuted, or were
        # not proved.
        self.proved = dict.fromkeys(columns, -1)
        self.ceiling = dict.fromkeys(columns, self.top)
        self.refuted = dict.fromkeys(columns, self.top + 1)  # From this level on
        self.tiles: dict[Place, TileVerdict] = {}
        self.certificates: list[Certificate] = []
        self.boxes: list[Box] = []
        self.wrong: dict[Box, str] = {}
        self.proofs = self.carried = self.witnesses = 0

    def tile_map(self) -> TileMap:
        """Return all tiles; those of which nothing is known are inconclusive."""
        places = list(places_of(tuple((0, count - 1) for count in self.grid.shape)))
        for place in places:
            if place not in self.tiles:
                wrong = self.wrong.get(at(place)) or self._is_no_spec(at(place))
                self.tiles[place] = TileVerdict(Verdict.INCONCLUSIVE, wrong=wrong)
        return TileMap(
            self.grid,
            {place: self.tiles[place] for place in places},
            tuple(self.certificates),
            tuple(self.boxes),
            self.proofs,
            self.carried,
            self.witnesses,
        )

    def take(self, coarse: TileMap) -> None:
        """Take what is proved on a coarser grid."""
        spans = [
            [fine.span_of(old, k) for k in range(old.count)]
            for fine, old in zip(self.grid.fields, coarse.grid.fields, strict=True)
        ]
        finer = [
            tuple((on[first][0], on[last][1]) for on, (first, last) in zip(spans, box, strict=True))
            for box in coarse.boxes
        ]
        places: dict[int, int] = {}
        for place, tile in coarse.tiles.items():
            if tile.verdict is not Verdict.PROVED or tile.certificate is None:
                continue
            old = tile.certificate
            if old not in places:
                places[old] = len(self.certificates)
                self.certificates.append(coarse.certificates[old])
                self.boxes.append(finer[old])
            box = tuple(on[k] for on, k in zip(spans, place, strict=True))
            for fine in places_of(box):
                self.tiles[fine] = TileVerdict(Verdict.PROVED, places[old])
                column, level = self._parted(fine)
                self.proved[column] = max(self.proved[column], level)
        self.proofs, self.carried = coarse.proofs, coarse.carried
        self.witnesses = coarse.witnesses

    def put_refuted(self, column: Place, level: int, witness: QuickVerdict) -> None:
        """Write down that a column is refuted from a level on, if there is a witness.

        Parameters
        ----------
        column : tuple of int
            The column.
        level : int
            The lowest that is refuted.
        witness : QuickVerdict
            About the spec of the column at this level; what says nothing is left.
        """
        if not witness.grows:
            return
        box = at(column)
        kept = self._kept_as(witness, self.leveled(box, (level, level)))
        for k in self._valid(box, level, self.refuted[column] - 1):
            tile = TileVerdict(witness.verdict, kept, witness.refuted_in)
            self.tiles[self._place(column, k)] = tile
        self.refuted[column] = level
        self.ceiling[column] = min(self.ceiling[column], level - 1)

    def put_proved(self, box: Box, found: QuickVerdict, level: int) -> None:
        """Write down a proof of a box up to a level.

        Parameters
        ----------
        box : Box
            Of columns.
        found : QuickVerdict
            A proof of the spec of the box at the level.
        level : int
            The highest that is proved.
        """
        kept = self._kept_as(found, self.leveled(box, (0, level)))
        first = min(self.proved[column] for column in places_of(box)) + 1
        levels = self._valid(box, first, level)
        for column in places_of(box):
            for k in levels:
                if k > self.proved[column]:
                    self.tiles[self._place(column, k)] = TileVerdict(Verdict.PROVED, kept)
            self.proved[column] = max(self.proved[column], level)

    def _kept_as(self, found: QuickVerdict, box: Box) -> int:
        """Keep a certificate, and return its place."""
        assert found.certificate is not None
        self.certificates.append(found.certificate)
        self.boxes.append(box)
        return len(self.certificates) - 1

    def _is_no_spec(self, tile: Box) -> str:
        """Say why a tile makes no spec; empty if it makes one."""
        try:
            self.grid.spec_of(tile)
        except SpecError as error:
            return error.message
        return ""

    def _valid(self, box: Box, first: int, last: int) -> list[int]:
        """Return the levels of a span at which a box makes a spec.

        An upper end between two that make one makes one, too.
        """
        levels = range(first, last + 1)
        ends = [k for k in {first, last} if not self._is_no_spec(self.leveled(box, (k, k)))]
        if len(ends) == len({first, last}):
            return list(levels)
        return [k for k in levels if not self._is_no_spec(self.leveled(box, (k, k)))]

    def leveled(self, box: Box, levels: Span) -> Box:
        """Return a box of columns with a span of levels."""
        if self._leveled is None:
            return box
        return (*box[: self._leveled], levels, *box[self._leveled :])

    def _place(self, column: Place, level: int) -> Place:
        return tuple(first for first, _ in self.leveled(at(column), (level, level)))

    def of_columns(self, box: Box) -> tuple[Box, int]:
        """Return the columns of a box, and its highest level."""
        if self._leveled is None:
            return box, 0
        return (*box[: self._leveled], *box[self._leveled + 1 :]), box[self._leveled][1]

    def _parted(self, place: Place) -> tuple[Place, int]:
        """Return the column of a tile, and its level."""
        if self._leveled is None:
            return place, 0
        return (*place[: self._leveled], *place[self._leveled + 1 :]), place[self._leveled]


def at(column: Place) -> Box:
    """Return the box of one column, or of one tile."""
    return tuple((k, k) for k in column)


def places_of(box: Box) -> Iterator[Place]:
    """Yield what lies in a box, the last field fastest."""
    return product(*(range(first, last + 1) for first, last in box))


def halves_of(box: Box, among: list[int]) -> tuple[Box, Box]:
    """Halve a box where it is longest, the lower half first.

    Parameters
    ----------
    box : Box
        More than one tile.
    among : list of int
        The fields to choose from; all if there are none.
    """
    axis = max(among or range(len(box)), key=lambda k: box[k][1] - box[k][0])
    first, last = box[axis]
    middle = (first + last) // 2
    return (
        (*box[:axis], (first, middle), *box[axis + 1 :]),
        (*box[:axis], (middle + 1, last), *box[axis + 1 :]),
    )
