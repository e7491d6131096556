"""Gains that stay as they are given, and that a choice under proof may change within bounds."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.spec.check import Row
from nrs_design.spec.fields import Positive
from nrs_design.spec.model import SpecModel, optional, required


class FactorBounds(SpecModel, stronger="beside"):
    """Bounds of a gain, as factors on the one that the spec gives."""

    min: Positive = required("smallest factor on the given gain, no unit")
    max: Positive = required("largest factor on the given gain, no unit")

    checks = (
        Row(
            "",
            lambda s: not s.min <= 1 <= s.max,
            "the given gain itself is not within these factors",
            "let min be at most 1, and max at least 1",
        ),
    )


class FreeGainsSpec(SpecModel, stronger="beside"):
    """Which gains of one controller are free, and how far."""

    Kp: FactorBounds | None = optional("of the motion loop, or of the force")
    Kd: FactorBounds | None = optional("of the motion loop")
    Ki: FactorBounds | None = optional("of the force")
    Kt: FactorBounds | None = optional("spring of an impedance controller")

    checks = (
        Row(
            "",
            lambda s: not dict(s.given()),
            "no gain is named",
            "name one, such as `Kp: {{min: 0.6, max: 1.6}}`",
        ),
    )

    def given(self) -> Iterator[tuple[str, FactorBounds]]:
        """Yield the gains that are free, with their bounds."""
        return ((gain, bounds) for gain, bounds in self if bounds is not None)
