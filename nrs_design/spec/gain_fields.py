"""Field types for gains: given, or to be chosen by the design."""

from __future__ import annotations

from typing import Annotated

from nrs_design.spec import kinds
from nrs_design.spec.model import ReadBefore, SpecModel, required
from nrs_design.spec.quantity_fields import AnyQuantity, bounds_of, quantity_schema
from nrs_design.spec.range_checks import BOUND_CHECKS


class GainSpec(SpecModel):
    """A gain: fixed, with ``min == max``, or to be designed within bounds."""

    min: AnyQuantity = required("smallest value that the design may choose")
    max: AnyQuantity = required("largest value that the design may choose")

    checks = BOUND_CHECKS

    @property
    def fixed(self) -> bool:
        """Whether the design may choose only one value."""
        return self.min.rational_part == self.max.rational_part


InertiaGain = Annotated[GainSpec, bounds_of(kinds.INERTIA, GainSpec, positive=False)]
DampingGain = Annotated[GainSpec, bounds_of(kinds.IMPEDANCE, GainSpec)]
# No design chooses it.
SpringGain = Annotated[
    GainSpec,
    ReadBefore(bounds_of(kinds.SPRING, GainSpec).read, quantity_schema(kinds.SPRING)),
]
