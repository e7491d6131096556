"""The law of an export that a processor runs."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.shipped import shipped_law
from nrs_design.exporters.export import Export


def law_of(export: Export) -> StepLaw:
    """Return the law of an export, as operations.

    Raises
    ------
    DesignError
        If nothing may be exported, or a controller has no step yet.
    """
    record = export.shipped()
    assert export.spec is not None
    assert export.design is not None
    assert record.sample_time is not None
    return shipped_law(export.spec, export.design, Fraction(record.sample_time.exact))
