"""A goal that what is proved decides."""

from __future__ import annotations

from dataclasses import dataclass

from nrs_design.spec.faults import Location


@dataclass(frozen=True, slots=True)
class CertifiedGoal:
    """One goal of a spec that a certificate must show."""

    key: str  # Of the goal in the spec, such as ``decay_rate``
    said: str  # What is proved; numbers are rounded to their safe side
    wanted: str  # As the spec writes it; ``largest`` wants no number
    # Whether what is proved is enough. Where it is not, nothing is known: more may be true.
    met: bool

    @property
    def place(self) -> Location:
        """Keys that lead to it in the spec."""
        return "goals", self.key
