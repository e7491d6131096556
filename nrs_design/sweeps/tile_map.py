"""Tiles with what is known of them, and the certificates that show it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from nrs_design.certificates.certificate import Certificate, Verdict
from nrs_design.sweeps.tiles import Box, TileGrid

Place = tuple[int, ...]
ORDER = tuple(map(str, (Verdict.PROVED, Verdict.REFUTED, Verdict.INCONCLUSIVE)))


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
    proofs: int  # How many programs were solved for forms
    carried: int  # How often a known form was checked for other tiles
    witnesses: int  # How often growth was looked for

    def counts(self) -> dict[str, int]:
        """Return how many tiles there are of each verdict, the proved ones first."""
        found = Counter(tile.shown for tile in self.tiles.values())
        rest = {name: found[name] for name in sorted(found) if name not in ORDER}
        return {name: found[name] for name in ORDER[:2]} | rest | {ORDER[2]: found[ORDER[2]]}
