"""What all evidence of a bound has in common: a level that an output does not exceed."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.system import Channel, SwitchedSystem


class AbstractBound(AbstractEvidence):
    """While the disturbances named in `channels` act, `output` stays below `level`."""

    channels: tuple[str, ...]
    output: str
    level: Fraction
    # How fast each disturbance may fill the set that is not left: in 1/s, or per step.
    shares: tuple[Fraction, ...]

    @property
    def shows(self) -> Shows:
        """A bound."""
        return Shows.BOUND

    def acting(self, system: SwitchedSystem) -> tuple[Channel, ...]:
        """Return the disturbances that it is about, in its own order."""
        by_name = {channel.name: channel for channel in system.channels}
        return tuple(by_name[name] for name in self.channels)
