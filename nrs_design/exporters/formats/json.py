"""The export record itself, as JSON; ``nrs-design schema --of export`` describes it."""

from __future__ import annotations

from nrs_design.exporters import DESIGN, Format
from nrs_design.exporters.export import Export
from nrs_design.exporters.record import dump_record
from nrs_design.output import EXPORT

FORMAT = Format(
    "gains with what is proved of them; the record that every format holds",
    DESIGN,
    {".export.json": EXPORT},
)


def render(export: Export) -> dict[str, bytes]:
    """Return the file of an export, by its ending."""
    return {".export.json": dump_record(export.shipped()).encode()}
