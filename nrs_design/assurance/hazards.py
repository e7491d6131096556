"""Hazards traced to goals, limits, gains, assumptions, tests and the program.

`hazards.toml` lists the hazards. What is met or missed comes from the obligations of the gate,
decided by the same code.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.assurance.register import RecordState, RegisterRow
from nrs_design.gating.obligations import Obligation

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Gains
    from nrs_design.spec.motion import LimitsSpec

_TABLE = Path(__file__).with_name("hazards.toml")
# As the header of an exported monitor names what was left.
_LEFT = re.compile(r"_LEFT_([A-Z]+)\b")


@dataclass(frozen=True, slots=True)
class Hazard:
    """One row of the table."""

    id: str
    name: str
    events: str
    rules: tuple[str, ...]
    goals: tuple[str, ...]
    limits: tuple[str, ...]
    assumptions: tuple[str, ...]
    watched: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TracedHazard:
    """A hazard of one spec, and all that leads from it to the binary."""

    hazard: Hazard
    obligations: tuple[Obligation, ...]  # Each met, missed, proved, ...
    limits: tuple[str, ...]  # As the spec writes them
    gains: tuple[str, ...]  # Of the controllers that it is about, such as ``insertion: Mt, Bt``
    assumptions: tuple[RegisterRow, ...]
    watched: tuple[str, ...]  # What the exported monitor tells

    @property
    def missed(self) -> tuple[Obligation, ...]:
        """Obligations that are not fulfilled."""
        return tuple(item for item in self.obligations if not item.fulfilled)

    @property
    def unsettled(self) -> tuple[str, ...]:
        """Ids of assumptions of which something is left to show."""
        return tuple(row.id for row in self.assumptions if not row.settled)

    @property
    def failed(self) -> tuple[str, ...]:
        """Ids of assumptions whose test failed."""
        return tuple(row.id for row in self.assumptions if row.state is RecordState.FAILED)


@cache
def hazards() -> tuple[Hazard, ...]:
    """Return the table."""
    table: dict[str, dict[str, Any]] = tomllib.loads(_TABLE.read_text(encoding="utf-8"))
    return tuple(_hazard(id, row) for id, row in table.items())


def _hazard(id: str, row: dict[str, Any]) -> Hazard:
    fields: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in row.items()}
    return Hazard(id, **fields)


def ended_in(obligations: Iterable[Obligation]) -> str:
    """Count obligations by how they ended, such as ``1 proved, 2 met``."""
    ended = [item.status.value for item in obligations]
    return ", ".join(f"{ended.count(word)} {word}" for word in dict.fromkeys(ended))


def trace_hazards(
    limits: LimitsSpec | None,
    gains: Gains,
    rows: Iterable[RegisterRow],
    obligations: Sequence[Obligation],
    monitor: str = "",
) -> tuple[TracedHazard, ...]:
    """Return the hazards that a spec has, traced.

    Parameters
    ----------
    limits : LimitsSpec or None
        Of the spec; None for given matrices.
    gains : mapping
        That ship, by controller.
    rows : iterable of RegisterRow
        The register of assumptions.
    obligations : sequence of Obligation
        What the gate asks of this spec, each as it ended.
    monitor : str
        Header of the exported monitor; empty if there is none.
    """
    rows, watched = tuple(rows), frozenset(_LEFT.findall(monitor))
    traced = (_trace(h, limits, gains, rows, obligations, watched) for h in hazards())
    return tuple(t for t in traced if t.obligations or t.assumptions or t.limits)


def _trace(
    hazard: Hazard,
    limits: LimitsSpec | None,
    gains: Gains,
    rows: Sequence[RegisterRow],
    obligations: Iterable[Obligation],
    watched: Collection[str],
) -> TracedHazard:
    about = tuple(item for item in obligations if _is_about(item, hazard))
    named = [item.subject.partition(":")[0] for item in about]
    # What holds for the whole system is about all gains.
    chosen = [name for name in gains if name in named] or list(gains)
    return TracedHazard(
        hazard,
        about,
        tuple(_limits(limits, hazard)),
        tuple(f"{name}: {', '.join(gains[name])}" for name in chosen if gains[name]),
        tuple(row for row in rows if row.kind.id in hazard.assumptions),
        tuple(name for name in hazard.watched if name in watched),
    )


def _is_about(item: Obligation, hazard: Hazard) -> bool:
    return item.rule.id in hazard.rules or item.subject.partition(": ")[2] in hazard.goals


def _limits(limits: LimitsSpec | None, hazard: Hazard) -> Iterable[str]:
    for name in hazard.limits:
        limit = getattr(limits, name, None)
        if limit is not None:
            yield f"{name}: {limit.text}"
