"""What may be exported, and where it was written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nrs_design.exporters.export import Export


def export_facts(
    name: str, result: Export, written: Sequence[Path] = (), proof: Path | None = None
) -> dict[str, Any]:
    """Return the verdict and the record of an export."""
    record = result.record
    certified = result.may_be_written and result.certificate is not None
    return {
        "spec": name,
        "verdict": result.verdict,
        "reason": result.reason or None,
        "file": str(written[0]) if written else None,
        "files": list(map(str, written)),
        "certificate": str(proof) if certified and proof else None,
        "record": record.model_dump(mode="json", by_alias=True) if record else None,
    }
