"""Which tiles are proved, which are refuted: a box at a time, and never by guess.

A proof for the spec of a box is one for each of its tiles. Where a field takes upper ends, its
levels, what is proved is proved below, and what is refuted is refuted above, by the same witness.
So

1. modes that grow are looked for first, which is cheap: the lowest such level of every column,
2. a program is solved for boxes of the columns that are left, at the highest level that is open in
   all of them. A form that it finds is carried to the columns beside it: to check it there takes no
   program. A box that is not proved is halved, and a column is bisected,
3. words of modes that grow are looked for in what is still open.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from itertools import product

from nrs_design.certificates.certificate import Certificate, Verdict
from nrs_design.errors import NrsDesignError, SpecError
from nrs_design.pipeline import Designed
from nrs_design.pipeline.certification import gains_text
from nrs_design.pipeline.free_gains import check_own_gains
from nrs_design.pipeline.quick_verdict import (
    OPEN,
    Posed,
    QuickVerdict,
    run_known_proof,
    run_quick_growth,
    run_quick_proof,
    run_quick_witness,
)
from nrs_design.progress import Progress, silent
from nrs_design.sweeps.tile_map import Place, TileMap, TileVerdict
from nrs_design.sweeps.tiles import Box, Span, TileCut, TileGrid

# So many specs are kept with their modes, as the next question is often about one of them.
KEPT_SPECS = 8


def run_tile_map(grid: TileGrid, designed: Designed | None, progress: Progress = silent) -> TileMap:
    """Decide every tile.

    Parameters
    ----------
    grid : TileGrid
        The tiles.
    designed : Designed or None
        The gains of the spec; None for given matrices.
    progress : callable
        Told how many tiles are decided.
    """
    return _Painter(grid, designed, progress).painted()


def repaint(
    coarse: TileMap, grid: TileGrid, designed: Designed | None, progress: Progress = silent
) -> TileMap:
    """Decide the tiles of a finer grid: what was proved stays so.

    Parameters
    ----------
    coarse : TileMap
        The map so far.
    grid : TileGrid
        With the borders of the coarse one, and more.
    designed, progress
        As for `run_tile_map`.
    """
    painter = _Painter(grid, designed, progress)
    painter.take(coarse)
    return painter.painted()


class _Painter:
    """Paints tiles; a column is a tile of all fields but the one that has levels."""

    def __init__(self, grid: TileGrid, kept: Designed | None, progress: Progress) -> None:
        self.grid, self.kept, self.progress = grid, kept, progress
        cuts = [one.cut for one in grid.fields]
        self.leveled = cuts.index(TileCut.UP_TO) if TileCut.UP_TO in cuts else None
        self.top = 0 if self.leveled is None else grid.shape[self.leveled] - 1
        shape = [n for k, n in enumerate(grid.shape) if k != self.leveled]
        self.whole: Box = tuple((0, n - 1) for n in shape)
        self.mixed = [
            axis
            for axis, one in enumerate(o for k, o in enumerate(grid.fields) if k != self.leveled)
            if one.cut is TileCut.POINT
        ]
        columns = list(_places(self.whole))
        # Highest level that is proved, and highest that may be: those above are refuted, or were
        # not proved.
        self.proved = dict.fromkeys(columns, -1)
        self.ceiling = dict.fromkeys(columns, self.top)
        self.refuted = dict.fromkeys(columns, self.top + 1)
        self.tiles: dict[Place, TileVerdict] = {}
        self.certificates: list[Certificate] = []
        self.boxes: list[Box] = []
        self.proofs = self.carried = self.witnesses = 0
        self._posed: dict[Box, Posed | str] = {}
        self.wrong: dict[Box, str] = {}

    def painted(self) -> TileMap:
        """Decide all tiles."""
        for column in self.proved:
            self._find_growth(column)
        self._prove(self.whole)
        for column in self.proved:
            self._find_words(column)
        places = list(_places(tuple((0, count - 1) for count in self.grid.shape)))
        for place in places:
            if place not in self.tiles:
                wrong = self.wrong.get(_at(place)) or self._is_no_spec(_at(place))
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
            at = tile.certificate
            if at not in places:
                places[at] = len(self.certificates)
                self.certificates.append(coarse.certificates[at])
                self.boxes.append(finer[at])
            box = tuple(on[k] for on, k in zip(spans, place, strict=True))
            for fine in _places(box):
                self.tiles[fine] = TileVerdict(Verdict.PROVED, places[at])
                column, level = self._parted(fine)
                self.proved[column] = max(self.proved[column], level)
        self.proofs, self.carried = coarse.proofs, coarse.carried
        self.witnesses = coarse.witnesses
        for certificate, box in zip(tuple(self.certificates), tuple(self.boxes), strict=True):
            columns, level = self._of_columns(box)
            found = QuickVerdict(Verdict.PROVED, certificate)
            wider, more = self._carried(columns, level, found)
            if wider != columns:
                self._put_proved(wider, more, level)

    def _find_growth(self, column: Place) -> None:
        """Find the lowest level at which a mode grows by itself."""
        low, high, witness = self.proved[column], self.refuted[column], OPEN
        level = low + 1
        while low + 1 < high:
            found = self._asked(_at(column), level, run_quick_growth)
            self.witnesses += 1
            low, high = (low, level) if found.grows else (level, high)
            witness = found if found.grows else witness
            # The lowest first, then the highest: most columns have either, or none.
            level = self.top if high > self.top else (low + high) // 2
        self._refute(column, high, witness)

    def _find_words(self, column: Place) -> None:
        """Find a low level at which a word of modes grows, where it is neither proved nor refuted.

        From the highest one down, where there is most that may grow.
        """
        low, high, witness = self.proved[column], self.refuted[column], OPEN
        level = high - 1
        while low + 1 < high:
            found = self._asked(_at(column), level, run_quick_witness)
            self.witnesses += 1
            if not found.grows and witness is OPEN:
                break
            low, high = (low, level) if found.grows else (level, high)
            witness = found if found.grows else witness
            level = (low + high) // 2
        self._refute(column, high, witness)

    def _refute(self, column: Place, level: int, witness: QuickVerdict) -> None:
        """Write down that a column is refuted from a level on, if there is a witness."""
        if not witness.grows:
            return
        box = _at(column)
        at = self._kept_as(witness, self._leveled(box, (level, level)))
        for k in self._valid(box, level, self.refuted[column] - 1):
            tile = TileVerdict(witness.verdict, at, witness.refuted_in)
            self.tiles[self._place(column, k)] = tile
        self.refuted[column] = level
        self.ceiling[column] = min(self.ceiling[column], level - 1)

    def _prove(self, box: Box) -> None:
        """Prove what can be proved of the columns of a box."""
        columns = list(_places(box))
        if all(self.proved[column] >= self.ceiling[column] for column in columns):
            return
        self.progress(f"{len(self.tiles)} tiles decided, {self.proofs} programs")
        if len(columns) == 1:
            self._bisect(columns[0])
            return
        split = [axis for axis in self.mixed if box[axis][0] != box[axis][1]]
        level = min(self.ceiling[column] for column in columns)
        # What pays for one column alone is asked of that alone.
        if not split and sum(self.proved[column] < level for column in columns) > 1:
            self._try(box, level)
        for half in _halves(box, split):
            self._prove(half)

    def _bisect(self, column: Place) -> None:
        """Find the highest level that is proved, from the highest that may be on."""
        level = self.ceiling[column]
        while self.proved[column] < self.ceiling[column]:
            if not self._try(_at(column), level):
                self.ceiling[column] = level - 1
            level = (self.proved[column] + self.ceiling[column] + 1) // 2

    def _try(self, box: Box, level: int) -> bool:
        """Solve a program for a box; carry the form that it finds to the columns beside it."""
        self.proofs += 1
        found = self._asked(box, level, run_quick_proof)
        if found.verdict is not Verdict.PROVED:
            return False
        self._put_proved(*self._carried(box, level, found), level)
        return True

    def _carried(self, box: Box, level: int, found: QuickVerdict) -> tuple[Box, QuickVerdict]:
        """Carry a form to the columns beside a box, as far as it proves them with those of it."""
        assert found.certificate is not None
        for axis in range(len(box)):
            for beyond in (-1, 1) if axis not in self.mixed else ():
                while (wider := self._wider(box, axis, beyond, level)) is not None:
                    how = partial(run_known_proof, certificate=found.certificate)
                    self.carried += 1
                    more = self._asked(wider, level, how)
                    if more.verdict is not Verdict.PROVED:
                        break
                    box, found = wider, more
        return box, found

    def _wider(self, box: Box, axis: int, beyond: int, level: int) -> Box | None:
        """Return a box with the columns beside it, if these may be proved and are not."""
        first, last = box[axis]
        new = first - 1 if beyond < 0 else last + 1
        if not self.whole[axis][0] <= new <= self.whole[axis][1]:
            return None
        beside = list(_places((*box[:axis], (new, new), *box[axis + 1 :])))
        if any(self.ceiling[column] < level for column in beside):
            return None
        if all(self.proved[column] >= level for column in beside):
            return None
        return (*box[:axis], (min(first, new), max(last, new)), *box[axis + 1 :])

    def _put_proved(self, box: Box, found: QuickVerdict, level: int) -> None:
        """Write down a proof of a box up to a level."""
        at = self._kept_as(found, self._leveled(box, (0, level)))
        first = min(self.proved[column] for column in _places(box)) + 1
        levels = self._valid(box, first, level)
        for column in _places(box):
            for k in levels:
                if k > self.proved[column]:
                    self.tiles[self._place(column, k)] = TileVerdict(Verdict.PROVED, at)
            self.proved[column] = max(self.proved[column], level)

    def _kept_as(self, found: QuickVerdict, box: Box) -> int:
        """Keep a certificate, and return its place."""
        assert found.certificate is not None
        self.certificates.append(found.certificate)
        self.boxes.append(box)
        return len(self.certificates) - 1

    def _asked(self, box: Box, level: int, how: Callable[[Posed], QuickVerdict]) -> QuickVerdict:
        """Decide a box of columns at a level; nothing is known of what makes no system."""
        whole = self._leveled(box, (level, level))
        if whole not in self._posed:
            if len(self._posed) >= KEPT_SPECS:
                del self._posed[next(iter(self._posed))]
            try:
                self._posed[whole] = Posed.of(self.grid.spec_of(whole), self.kept)
            except NrsDesignError as error:
                self._posed[whole] = self.wrong[whole] = error.message
        posed = self._posed[whole]
        return how(posed) if isinstance(posed, Posed) else OPEN

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
        ends = [k for k in {first, last} if not self._is_no_spec(self._leveled(box, (k, k)))]
        if len(ends) == len({first, last}):
            return list(levels)
        return [k for k in levels if not self._is_no_spec(self._leveled(box, (k, k)))]

    def _leveled(self, box: Box, levels: Span) -> Box:
        """Return a box of columns with a span of levels."""
        return box if self.leveled is None else (*box[: self.leveled], levels, *box[self.leveled :])

    def _place(self, column: Place, level: int) -> Place:
        return tuple(first for first, _ in self._leveled(_at(column), (level, level)))

    def _of_columns(self, box: Box) -> tuple[Box, int]:
        """Return the columns of a box, and its highest level."""
        if self.leveled is None:
            return box, 0
        return (*box[: self.leveled], *box[self.leveled + 1 :]), box[self.leveled][1]

    def _parted(self, place: Place) -> tuple[Place, int]:
        """Return the column of a tile, and its level."""
        if self.leveled is None:
            return place, 0
        return (*place[: self.leveled], *place[self.leveled + 1 :]), place[self.leveled]


def _at(column: Place) -> Box:
    return tuple((k, k) for k in column)


def _places(box: Box) -> Iterator[Place]:
    return product(*(range(first, last + 1) for first, last in box))


def _halves(box: Box, among: list[int]) -> tuple[Box, Box]:
    """Halve a box where it is longest, the lower half first."""
    axis = max(among or range(len(box)), key=lambda k: box[k][1] - box[k][0])
    first, last = box[axis]
    middle = (first + last) // 2
    return (
        (*box[:axis], (first, middle), *box[axis + 1 :]),
        (*box[:axis], (middle + 1, last), *box[axis + 1 :]),
    )


def check_corners(grid: TileGrid, designed: Designed | None) -> None:
    """Refuse a map in whose first or last tile the spec by itself would have other gains.

    Parameters
    ----------
    grid : TileGrid
        The tiles.
    designed : Designed or None
        The gains of the spec.

    Raises
    ------
    DesignError
        If it would. A tile that makes no spec has no certificate, and is passed over.
    """
    for place in (tuple(0 for _ in grid.shape), tuple(count - 1 for count in grid.shape)):
        with suppress(SpecError):
            check_own_gains(grid.spec_of(_at(place)), gains_text(designed))
