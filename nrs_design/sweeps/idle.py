"""Fields of a map that have no part in what it decides: their tiles say nothing about them."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

from nrs_design.errors import NrsDesignError
from nrs_design.pipeline import Designed
from nrs_design.pipeline.quick_verdict import Posed
from nrs_design.proof.system import SwitchedSystem
from nrs_design.sweeps.tiles import TileGrid


def idle_fields(grid: TileGrid, designed: Designed | None) -> tuple[str, ...]:
    """Return the paths of fields with which nothing changes that a verdict is about.

    The spec as it stands is compared with what it is in the first and in the last tile of a field:
    a stiffness that no controller touches makes no difference.

    Parameters
    ----------
    grid : TileGrid
        The tiles.
    designed : Designed or None
        The gains of the spec; None for given matrices.
    """
    alone = (TileGrid(grid.loaded, (field,)) for field in grid.fields)
    return tuple(one.fields[0].field.path for one in alone if _is_idle(one, designed))


def _is_idle(grid: TileGrid, designed: Designed | None) -> bool:
    specs = [grid.loaded]
    for place in {0, grid.count - 1}:
        with suppress(NrsDesignError):
            specs.append(grid.spec_of(((place, place),)))
    try:
        asis, *others = (_decided(Posed.of(loaded, designed).system) for loaded in specs)
    except NrsDesignError:
        return False
    differ = len({loaded.sha256 for loaded in specs}) > 1
    return differ and all(other == asis for other in others)


def _decided(system: SwitchedSystem) -> SwitchedSystem:
    """Return what a verdict on stability is about: not names, nor what disturbs the loop."""
    return replace(system, name="", assumptions=(), channels=(), outputs=())
