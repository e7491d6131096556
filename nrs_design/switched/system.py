"""The switched system that a certificate speaks about."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from nrs_design.switched.matrix import RationalMatrix


class Time(StrEnum):
    """Continuous (``x' = A x``) or discrete (``x+ = A x``) time."""

    CONTINUOUS = "continuous"
    DISCRETE = "discrete"


@dataclass(frozen=True, slots=True)
class Mode:
    """One linear mode: its name and its exact state matrix, shape (n, n)."""

    name: str
    A: RationalMatrix


@dataclass(frozen=True, slots=True)
class SwitchedSystem:
    """A linear switched system under arbitrary switching.

    Parameters
    ----------
    name : str
        Name of the spec that it comes from.
    time : Time
        Continuous or discrete.
    states : tuple of str
        Name and unit of each state.
    modes : tuple of Mode
        At least one; all of the same size.
    assumptions : tuple of str
        What a statement about these matrices takes for granted about the robot.
    """

    name: str
    time: Time
    states: tuple[str, ...]
    modes: tuple[Mode, ...]
    assumptions: tuple[str, ...]

    @property
    def order(self) -> int:
        """Number of states n."""
        return len(self.states)
