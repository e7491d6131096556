"""Which spec a result is about."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nrs_design.spec import LoadedSpec


def spec_facts(loaded: LoadedSpec) -> dict[str, Any]:
    """Return which spec a result is about, as every document begins."""
    return {"spec": loaded.spec.name, "spec_sha256": loaded.sha256}
