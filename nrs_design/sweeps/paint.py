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

from collections.abc import Callable
from contextlib import suppress
from functools import partial

from nrs_design.certificates.certificate import Verdict
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
from nrs_design.sweeps.board import Board, at, halves_of, places_of
from nrs_design.sweeps.tile_map import Place, TileMap
from nrs_design.sweeps.tiles import Box, TileGrid

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
    return _Painter(Board(grid), designed, progress).painted()


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
    board = Board(grid)
    board.take(coarse)
    return _Painter(board, designed, progress).painted()


class _Painter:
    """Paints the tiles of a board."""

    def __init__(self, board: Board, kept: Designed | None, progress: Progress) -> None:
        self.board, self.kept, self.progress = board, kept, progress
        self._posed: dict[Box, Posed | str] = {}

    def painted(self) -> TileMap:
        """Decide all tiles."""
        board = self.board
        self._carry_known()
        for column in board.proved:
            self._find_growth(column)
        self._prove(board.whole)
        for column in board.proved:
            self._find_words(column)
        return board.tile_map()

    def _carry_known(self) -> None:
        """Carry on what is proved on a coarser grid."""
        board = self.board
        for certificate, box in zip(tuple(board.certificates), tuple(board.boxes), strict=True):
            columns, level = board.of_columns(box)
            found = QuickVerdict(Verdict.PROVED, certificate)
            wider, more = self._carried(columns, level, found)
            if wider != columns:
                board.put_proved(wider, more, level)

    def _find_growth(self, column: Place) -> None:
        """Find the lowest level at which a mode grows by itself."""
        low, high, witness = self.board.proved[column], self.board.refuted[column], OPEN
        level = low + 1
        while low + 1 < high:
            found = self._asked(at(column), level, run_quick_growth)
            self.board.witnesses += 1
            low, high = (low, level) if found.grows else (level, high)
            witness = found if found.grows else witness
            # The lowest first, then the highest: most columns have either, or none.
            level = self.board.top if high > self.board.top else (low + high) // 2
        self.board.put_refuted(column, high, witness)

    def _find_words(self, column: Place) -> None:
        """Find a low level at which a word of modes grows, where it is neither proved nor refuted.

        From the highest one down, where there is most that may grow.
        """
        low, high, witness = self.board.proved[column], self.board.refuted[column], OPEN
        level = high - 1
        while low + 1 < high:
            found = self._asked(at(column), level, run_quick_witness)
            self.board.witnesses += 1
            if not found.grows and witness is OPEN:
                break
            low, high = (low, level) if found.grows else (level, high)
            witness = found if found.grows else witness
            level = (low + high) // 2
        self.board.put_refuted(column, high, witness)

    def _prove(self, box: Box) -> None:
        """Prove what can be proved of the columns of a box."""
        columns = list(places_of(box))
        if all(self.board.proved[column] >= self.board.ceiling[column] for column in columns):
            return
        self.progress(f"{len(self.board.tiles)} tiles decided, {self.board.proofs} programs")
        if len(columns) == 1:
            self._bisect(columns[0])
            return
        split = [axis for axis in self.board.mixed if box[axis][0] != box[axis][1]]
        level = min(self.board.ceiling[column] for column in columns)
        # What pays for one column alone is asked of that alone.
        if not split and sum(self.board.proved[column] < level for column in columns) > 1:
            self._try(box, level)
        for half in halves_of(box, split):
            self._prove(half)

    def _bisect(self, column: Place) -> None:
        """Find the highest level that is proved, from the highest that may be on."""
        level = self.board.ceiling[column]
        while self.board.proved[column] < self.board.ceiling[column]:
            if not self._try(at(column), level):
                self.board.ceiling[column] = level - 1
            level = (self.board.proved[column] + self.board.ceiling[column] + 1) // 2

    def _try(self, box: Box, level: int) -> bool:
        """Solve a program for a box; carry the form that it finds to the columns beside it."""
        self.board.proofs += 1
        found = self._asked(box, level, run_quick_proof)
        if found.verdict is not Verdict.PROVED:
            return False
        self.board.put_proved(*self._carried(box, level, found), level)
        return True

    def _carried(self, box: Box, level: int, found: QuickVerdict) -> tuple[Box, QuickVerdict]:
        """Carry a form to the columns beside a box, as far as it proves them with those of it."""
        assert found.certificate is not None
        for axis in range(len(box)):
            for beyond in (-1, 1) if axis not in self.board.mixed else ():
                while (wider := self._wider(box, axis, beyond, level)) is not None:
                    how = partial(run_known_proof, certificate=found.certificate)
                    self.board.carried += 1
                    more = self._asked(wider, level, how)
                    if more.verdict is not Verdict.PROVED:
                        break
                    box, found = wider, more
        return box, found

    def _wider(self, box: Box, axis: int, beyond: int, level: int) -> Box | None:
        """Return a box with the columns beside it, if these may be proved and are not."""
        first, last = box[axis]
        new = first - 1 if beyond < 0 else last + 1
        if not self.board.whole[axis][0] <= new <= self.board.whole[axis][1]:
            return None
        beside = list(places_of((*box[:axis], (new, new), *box[axis + 1 :])))
        if any(self.board.ceiling[column] < level for column in beside):
            return None
        if all(self.board.proved[column] >= level for column in beside):
            return None
        return (*box[:axis], (min(first, new), max(last, new)), *box[axis + 1 :])

    def _asked(self, box: Box, level: int, how: Callable[[Posed], QuickVerdict]) -> QuickVerdict:
        """Decide a box of columns at a level; nothing is known of what makes no system."""
        whole = self.board.leveled(box, (level, level))
        if whole not in self._posed:
            if len(self._posed) >= KEPT_SPECS:
                del self._posed[next(iter(self._posed))]
            try:
                self._posed[whole] = Posed.of(self.board.grid.spec_of(whole), self.kept)
            except NrsDesignError as error:
                self._posed[whole] = self.board.wrong[whole] = error.message
        posed = self._posed[whole]
        return how(posed) if isinstance(posed, Posed) else OPEN


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
            check_own_gains(grid.spec_of(at(place)), gains_text(designed))
