"""The arm of a URDF or MJCF file, where its tip is, and in which joint positions it is used."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nrs_design.spec import kinds
from nrs_design.spec.check import Row
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import Title
from nrs_design.spec.model import ReadBy, SpecModel
from nrs_design.spec.quantity import Quantity, is_less
from nrs_design.spec.quantity_fields import quantity_schema, read_quantity

# A joint position and itself, or the lowest and the highest.
Positions = tuple[Quantity, Quantity]


def _read_positions(value: object) -> Positions:
    """Read where a joint is held, or from where to where it goes."""
    parts = value if isinstance(value, tuple) else (value, value)
    if len(parts) != 2:
        raise fault(
            f"{len(parts)} joint positions", "write one position, or [lowest, highest] of a joint"
        )
    at = ((0,), (1,)) if isinstance(value, tuple) else ((), ())
    low, high = (
        read_quantity(part, kinds.JOINT_POSITION, *place, positive=False, signed=True)
        for part, place in zip(parts, at, strict=True)
    )
    return low, high


_ONE = quantity_schema(kinds.JOINT_POSITION)
_POSITIONS = ReadBy(
    _read_positions,
    {"anyOf": [_ONE, {"type": "array", "items": _ONE, "minItems": 2, "maxItems": 2}]},
)


class ArmSpec(SpecModel):
    """The arm whose mobility a spec relies on; `nrs-design robot mobility` computes it."""

    model: Title = Field(description="URDF or MJCF file, relative to this file")
    tip: Title = Field(
        description="its link on which forces act: axes are those of its frame, and what an axis "
        "is called, x, y, z, rx, ry or rz, says along or about which of them"
    )
    joints: Annotated[dict[Title, Annotated[Positions, _POSITIONS]], Field(min_length=1)] = Field(
        description="by the name of every joint that moves its [lowest, highest] position that is "
        "used, or the one where it is held; in deg, rad or m"
    )

    def _reversed(self) -> tuple[str, str, str] | None:
        """Return a joint and the ends of its range, if the highest is below the lowest."""
        return next(
            (
                (name, high.text, low.text)
                for name, (low, high) in self.joints.items()
                if low.dimension == high.dimension and is_less(high, low)
            ),
            None,
        )

    def _mixed(self) -> str | None:
        """Return a joint of which one end is an angle and one a length."""
        each = self.joints.items()
        return next((name for name, (a, b) in each if a.dimension != b.dimension), None)

    checks = (
        Row(
            "joints.{0}",
            _reversed,
            "the range of {0} ends at {1!r}, below its start {2!r}",
            "write [lowest, highest]",
        ),
        Row(
            "joints.{0}",
            _mixed,
            "one end of the range of {0} is an angle, the other a length",
            "write both in deg, or both in m",
        ),
    )
