"""The gradient iteration beside the LMI: cells of a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.proof.evidence.fields import rate_words

if TYPE_CHECKING:
    from nrs_design.search.method_run import MethodRun

COLUMNS = ("method", "coordinates", "order", "outcome", "updates", "proved rate", "condition of Q")


def cells_of(run: MethodRun) -> tuple[str, ...]:
    """Write one run in `COLUMNS`."""
    return (
        str(run.method),
        str(run.coordinates or ""),
        str(run.order or ""),
        run.outcome,
        "" if run.updates is None else str(run.updates),
        _rate(run),
        "" if run.condition is None else f"{run.condition:.3g}",
    )


def _rate(run: MethodRun) -> str:
    evidence, system = run.certification.evidence, run.certification.system
    rate = None if evidence is None else evidence.proved_rate(system)
    return "none" if rate is None else rate_words(rate, system.time)
