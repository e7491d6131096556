"""Tiles of a map: how many a second, how many programs, and what an undecided tile costs.

A map decides boxes of tiles, so its time is set beside that of one proof a tile. Times are those of
the processor: where others use the machine, clocks tell what these leave.
"""

from __future__ import annotations

from pathlib import Path
from time import process_time

from benchmarks.measure import Comparison, Finding, Size
from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import NrsDesignError
from nrs_design.pipeline import Designed, run_design
from nrs_design.pipeline.quick_verdict import Posed, run_quick_growth, run_quick_proof
from nrs_design.pipeline.written_gains import with_own_gains
from nrs_design.spec import read_spec
from nrs_design.sweeps.paint import run_tile_map
from nrs_design.sweeps.tiles import TileGrid, read_tiles

SPEC = Path(__file__).parents[1] / "specs/neuroboscope/soft-tissue-sampled.nrs.yaml"
STIFFNESS = "environments.soft.stiffness=17..4340/16 N/m"
MOST_PROGRAMS = 15


def run(size: Size) -> tuple[Comparison | Finding, ...]:
    """Measure a map of 16 intervals of stiffness over ages of the force sample."""
    oldest = size.pick(10, 3, 1)
    designed = run_design(read_spec(SPEC))
    assert designed is not None
    given = with_own_gains(designed)
    grid = read_tiles(given, SPEC, [STIFFNESS, f"sampling.delay=0..{oldest}"])
    start = process_time()
    found = run_tile_map(grid, designed)
    seconds = process_time() - start
    start = process_time()
    for place in found.tiles:
        _alone(grid, designed, place)
    alone = process_time() - start
    proved, undecided = _costs(grid, designed)
    return (
        Finding(
            f"{grid.count} tiles, 16 intervals of stiffness, ages up to {oldest}",
            f"{grid.count / seconds:.1f} tiles a second; {found.proofs} programs, "
            f"{found.carried} forms carried on",
            f"at most {MOST_PROGRAMS} programs",
            found.proofs <= MOST_PROGRAMS,
            seconds,
        ),
        Comparison(
            f"{grid.count} tiles, a box at a time",
            "each by itself",
            alone,
            seconds,
            None,
            "a mode that grows, else one program; processor time",
        ),
        Finding(
            "an undecided tile beside a proved one",
            f"{undecided / proved:.2f} times",
            "at most twice",
            undecided <= 2 * proved,
            undecided,
        ),
    )


def _alone(grid: TileGrid, designed: Designed, place: tuple[int, ...]) -> Verdict:
    posed = Posed.of(grid.spec_of(tuple((k, k) for k in place)), designed)
    if run_quick_growth(posed).grows:
        return Verdict.REFUTED
    return run_quick_proof(posed).verdict


def _costs(grid: TileGrid, designed: Designed) -> tuple[float, float]:
    """Return the seconds of a program for a proved tile and for one that none proves."""
    seconds = []
    for box, verdict in (((1, 1), Verdict.PROVED), ((0, 0), Verdict.INCONCLUSIVE)):
        posed = Posed.of(grid.spec_of((box, (1, 1))), designed)
        start = process_time()
        found = run_quick_proof(posed)
        seconds.append(process_time() - start)
        if found.verdict is not verdict:
            raise NrsDesignError(f"the tile {box} is {found.verdict}", remedy="take another one")
    return seconds[0], seconds[1]
