"""What a new text of a spec changes."""

from __future__ import annotations

from nrs_design.spec.describe import describe
from nrs_design.spec.load import LoadedSpec, parse_spec


def spec_changes(loaded: LoadedSpec, text: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return what a new text of a spec changes, and what it has no longer, a line each."""
    old, new = (
        {row.name: row.written for row in describe(spec)}
        for spec in (loaded.spec, parse_spec(text))
    )
    was = {name: old.get(name, "not there") for name in new}
    changed = (f"{n}: {was[n]} -> {w}" for n, w in new.items() if w != was[n])
    lost = (f"{n}: {w}" for n, w in old.items() if n not in new)
    return tuple(changed), tuple(lost)
