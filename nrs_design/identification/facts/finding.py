"""What the documents of all identifications have."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from nrs_design.identification.finding import Finding, is_synthetic

if TYPE_CHECKING:
    from nrs_design.identification.statistics import Estimate
    from nrs_design.identification.tables.table import Source

# Of JSON.
Facts = dict[str, Any]


def finding_facts(found: Finding, facts: Facts) -> Facts:
    """Return the facts that an identification alone has, with those that all have."""
    return {
        "synthetic": is_synthetic(found.sources),
        "records": source_facts(found.sources),
        **facts,
        "remarks": list(found.remarks),
        "doubts": list(found.doubts),
        "caveats": list(found.caveats),
    }


def estimate_numbers(estimate: Estimate) -> dict[str, float | None]:
    """Return an estimate for JSON, which has no infinity; None says unlimited."""
    low, high = (end if math.isfinite(end) else None for end in (estimate.low, estimate.high))
    return {"value": estimate.value, "low": low, "high": high}


def source_facts(files: Iterable[Source]) -> list[dict[str, Any]]:
    """Return what identifies the data files, for JSON."""
    return [
        {"file": str(file.path), "sha256": file.sha256, "synthetic": file.synthetic}
        for file in files
    ]
