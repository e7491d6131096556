"""Which tiles are proved, which are refuted: a box at a time, and never by guess.

A proof for the spec of a box is one for each of its tiles. So boxes are halved until they are
proved, or are single tiles; a single tile that is not proved is refuted by a witness, or undecided.
Where a field takes upper ends, what is proved is proved below, and what is refuted is refuted
above, by the same witness.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from itertools import product

from nrs_design.certificates.certificate import Certificate, Verdict
from nrs_design.errors import SpecError
from nrs_design.pipeline import Designed
from nrs_design.pipeline.certification import gains_text
from nrs_design.pipeline.free_gains import check_own_gains
from nrs_design.pipeline.quick_verdict import QuickVerdict, run_quick_proof, run_quick_witness
from nrs_design.progress import Progress, silent
from nrs_design.sweeps.tiles import Box, Span, TileCut, TileGrid

Place = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class TileVerdict:
    """What is known of one tile."""

    verdict: Verdict
    certificate: int | None = None  # Place of the one that covers it, or of its witness
    # Of what it is refuted, if that leaves the loss of contact open: then it is inconclusive.
    refuted_in: str | None = None
    wrong: str = ""  # Why there is nothing to decide

    @property
    def shown(self) -> str:
        """Its verdict in words."""
        return str(self.verdict) if self.refuted_in is None else f"refuted {self.refuted_in}"


@dataclass(frozen=True, slots=True)
class TileMap:
    """Every tile with its verdict."""

    grid: TileGrid
    tiles: dict[Place, TileVerdict]
    certificates: tuple[Certificate, ...]  # Each about the spec of a box
    boxes: tuple[Box, ...]  # Of each certificate
    proofs: int  # How many were tried
    witnesses: int

    def counts(self) -> dict[str, int]:
        """Return how many tiles there are of each verdict, the proved ones first."""
        found = Counter(tile.shown for tile in self.tiles.values())
        rest = {name: found[name] for name in sorted(found) if name not in ORDER}
        return {name: found[name] for name in ORDER[:2]} | rest | {ORDER[2]: found[ORDER[2]]}


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
    painter = _Painter(grid, designed, progress)
    painter.paint()
    whole = tuple((0, count - 1) for count in grid.shape)
    tiles = {place: painter.tiles[place] for place in _places(whole)}
    return TileMap(
        grid,
        tiles,
        tuple(painter.certificates),
        tuple(painter.boxes),
        painter.proofs,
        painter.witnesses,
    )


def check_corners(grid: TileGrid, designed: Designed | None) -> None:
    """Refuse a map in whose first or last tile the spec by itself would have other gains.

    Raises
    ------
    DesignError
        If it would. A tile that makes no spec has no certificate, and is passed over.
    """
    gains = gains_text(designed)
    for place in (tuple(0 for _ in grid.shape), tuple(count - 1 for count in grid.shape)):
        try:
            loaded = grid.spec_of(tuple((k, k) for k in place))
        except SpecError:
            continue
        check_own_gains(loaded, gains)


OPEN = Verdict.INCONCLUSIVE
ORDER = tuple(map(str, (Verdict.PROVED, Verdict.REFUTED, OPEN)))


@dataclass
class _Painter:
    """Paints tiles; upper ends of one field, if there is one, are climbed from the lowest."""

    grid: TileGrid
    kept: Designed | None
    progress: Progress
    tiles: dict[Place, TileVerdict] = field(default_factory=dict)
    certificates: list[Certificate] = field(default_factory=list)
    boxes: list[Box] = field(default_factory=list)
    proofs: int = 0
    witnesses: int = 0

    @property
    def climbed(self) -> int | None:
        """The field whose upper ends are climbed."""
        cuts = [one.cut for one in self.grid.fields]
        return cuts.index(TileCut.UP_TO) if TileCut.UP_TO in cuts else None

    def paint(self) -> None:
        """Decide all tiles."""
        base = tuple((0, count - 1) for count in self.grid.shape)
        if self.climbed is None:
            self._climb(base, 0, 0, 1)
        else:
            top = base[self.climbed][1]
            self._climb(self._at(base, (0, 0)), 0, top, 1)

    def _at(self, base: Box, levels: Span) -> Box:
        """Return a box with a span of levels."""
        if self.climbed is None:
            return base
        return (*base[: self.climbed], levels, *base[self.climbed + 1 :])

    def _climb(self, base: Box, low: int, top: int, step: int) -> None:
        """Decide a box of all fields but the one that is climbed, proved below a level."""
        if low > top:
            return
        self.progress(f"{len(self.tiles)} tiles decided")
        level, whole = min(low + step - 1, top), self._must_split(base)
        found = OPENED if whole else self._proved(self._at(base, (level, level)))
        single = all(first == last for first, last in base)
        if found.verdict is Verdict.PROVED:
            # All ages, or other things, up to an end: a proof holds below it, too.
            self._put(self._at(base, (low, level)), found, self._at(base, (0, level)))
            self._climb(base, level + 1, top, 2 * step)
        elif step > 1:
            self._climb(base, low, top, 1)
        elif not single:
            for half in _halves(base, whole):
                self._climb(half, low, top, 1)
        elif found.wrong:
            # Such as an age below the shortest one: the next level may well make a spec.
            self._put(self._at(base, (low, low)), found, base)
            self._climb(base, low + 1, top, 1)
        elif found.grows:
            self._put(self._at(base, (low, top)), found, self._at(base, (low, low)))
        else:
            self._refute(base, low, top, found)

    def _refute(self, base: Box, low: int, top: int, found: QuickVerdict) -> None:
        """Look for the lowest level with a witness, where the lowest of all is not proved."""
        refuted, open_up_to = top + 1, low - 1
        witness, level = found, low
        while open_up_to + 1 < refuted:
            tried = self._witness(self._at(base, (level, level)))
            if tried.grows:
                refuted, witness = level, tried
            else:
                open_up_to = level
            # First the lowest, then the highest, then between.
            level = top if level == low and refuted > top else (open_up_to + refuted) // 2
            if level <= open_up_to:
                break
        if open_up_to >= low or refuted > top:
            self._put(self._at(base, (low, min(refuted - 1, top))), found, base)
        if refuted <= top:
            self._put(self._at(base, (refuted, top)), witness, self._at(base, (refuted, refuted)))

    def _proved(self, box: Box) -> QuickVerdict:
        self.proofs += 1
        try:
            return run_quick_proof(self.grid.spec_of(box), self.kept)
        except SpecError as error:
            return QuickVerdict(OPEN, wrong=error.message)

    def _witness(self, box: Box) -> QuickVerdict:
        self.witnesses += 1
        try:
            return run_quick_witness(self.grid.spec_of(box), self.kept)
        except SpecError as error:
            return QuickVerdict(OPEN, wrong=error.message)

    def _put(self, covered: Box, found: QuickVerdict, box: Box) -> None:
        """Write down what is known of tiles, and the certificate, which is about a box."""
        at = None
        if found.certificate is not None:
            at = len(self.certificates)
            self.certificates.append(found.certificate)
            self.boxes.append(box)
        for place in _places(covered):
            self.tiles[place] = TileVerdict(found.verdict, at, found.refuted_in, found.wrong)

    def _must_split(self, box: Box) -> list[int]:
        """Return along which fields a box is no box: values by themselves have no range."""
        return [
            axis
            for axis, (one, (first, last)) in enumerate(zip(self.grid.fields, box, strict=True))
            if one.cut is TileCut.POINT and first != last
        ]


OPENED = QuickVerdict(OPEN)


def _places(box: Box) -> list[Place]:
    return list(product(*(range(first, last + 1) for first, last in box)))


def _halves(box: Box, among: list[int]) -> tuple[Box, Box]:
    """Halve a box where it is longest, the lower half first."""
    axes = among or list(range(len(box)))
    axis = max(axes, key=lambda k: box[k][1] - box[k][0])
    first, last = box[axis]
    middle = (first + last) // 2
    return (
        (*box[:axis], (first, middle), *box[axis + 1 :]),
        (*box[:axis], (middle + 1, last), *box[axis + 1 :]),
    )
