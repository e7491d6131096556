"""Goals for a frequency response over a band: what is felt, and how well the tool follows."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, ClassVar

from nrs_design.proof.text import exact_text
from nrs_design.spec import kinds
from nrs_design.spec.check import Row
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import Label, UnitFraction
from nrs_design.spec.model import ReadBy, SpecModel, optional, pair_schema, required
from nrs_design.spec.quantity import Quantity, is_less
from nrs_design.spec.quantity_fields import Impedance, quantity_schema, read_quantity

_FORM = "write [lowest, highest], such as `[0 Hz, 2 Hz]`"


def _read_band(value: object) -> tuple[Quantity, Quantity]:
    """Read the lowest and the highest frequency."""
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise fault("expected two frequencies", _FORM)
    low, high = (
        read_quantity(end, kinds.BANDWIDTH, i, positive=bool(i)) for i, end in enumerate(value)
    )
    return low, high


Band = Annotated[
    tuple[Quantity, Quantity], ReadBy(_read_band, pair_schema(quantity_schema(kinds.BANDWIDTH)))
]
_BAND = "[lowest, highest] frequency, such as [0 Hz, 2 Hz]; sampled, below half the sampling rate"
_ORDERED = Row[SpecModel](
    "band",
    lambda s: not is_less(*s.band) and tuple(end.text for end in s.band[::-1]),  # type: ignore[attr-defined]
    "the band ends at {0!r}, not above its start {1!r}",
    _FORM,
)


class TransparencySpec(SpecModel):
    """How little the surgeon shall feel of the robot, in free motion."""

    max_impedance: Impedance = required(
        "largest force of the hand over the velocity of the tool, N*m*s/rad"
    )
    band: Band = required(_BAND)
    environment: ClassVar[str | None] = None  # Nothing is touched

    checks = (_ORDERED,)

    @property
    def limit(self) -> Fraction:
        """The largest impedance in N m s/rad."""
        return self.max_impedance.exact

    @property
    def limit_text(self) -> str:
        """The largest impedance as it is written."""
        return self.max_impedance.text


class AccuracySpec(SpecModel):
    """How well the tool shall follow the commanded velocity."""

    max_error: UnitFraction = required(
        "largest |1 - V/Vcmd|, a share of the commanded velocity, between 0 and 1"
    )
    band: Band = required(_BAND)
    environment: Label | None = optional(
        "what is touched meanwhile, elastic or Kelvin-Voigt; default: nothing"
    )

    checks = (_ORDERED,)

    @property
    def limit(self) -> Fraction:
        """The largest share."""
        return self.max_error

    @property
    def limit_text(self) -> str:
        """The largest share as a number."""
        return exact_text(self.max_error)
