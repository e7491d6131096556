"""The export record itself, as JSON; ``nrs-design schema --of export`` describes it."""

from __future__ import annotations

from nrs_design.exporters.export import Export
from nrs_design.exporters.record import dump_record


def render(export: Export) -> dict[str, bytes]:
    """Return the file of an export, by its ending."""
    return {".export.json": dump_record(export.shipped()).encode()}
