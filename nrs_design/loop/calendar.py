"""Calendar of a sampling period: the computed tasks, and the times of commands."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from nrs_design.loop.command_timing import CommandTiming
from nrs_design.spec.sampling import SamplingSpec


class Turn(StrEnum):
    """What is computed at a sample."""

    BOTH = "both"
    MOTION = "motion"
    ADMITTANCE = "admittance"
    # A missed deadline: the processor computes nothing, and holds or zeroes the command.
    HELD = "miss, held"
    ZEROED = "miss, zeroed"

    @property
    def is_miss(self) -> bool:
        """Whether a deadline is missed."""
        return self in (Turn.HELD, Turn.ZEROED)

    @property
    def has_law(self) -> bool:
        """Whether a law takes a force sample."""
        return self in (Turn.BOTH, Turn.ADMITTANCE)


@dataclass(frozen=True, slots=True)
class Calendar:
    """The events of a period: samples, and commands that take effect."""

    timing: CommandTiming
    ages: tuple[int, int] = (0, 0)  # Smallest and largest age of force samples
    turns: tuple[Turn, ...] = (Turn.BOTH,)  # Of a round

    @property
    def sent(self) -> tuple[str, ...]:
        """The commands of samples before that are still on their way, the newest first."""
        return tuple(f"u {age} before" for age in range(1, self.timing.oldest + 1))

    @property
    def samples(self) -> tuple[str, ...]:
        """The force samples that are on their way, the newest first."""
        return tuple(f"F {age} before [N*m]" for age in range(1, self.ages[1] + 1))

    @property
    def holds(self) -> bool:
        """Whether a command outlasts a sample, and is not on its way anyway."""
        return not self.sent and not {Turn.ADMITTANCE, Turn.HELD}.isdisjoint(self.turns)


def turns_of(sampling: SamplingSpec) -> tuple[Turn, ...]:
    """Return the tasks of the samples in a round, or of samples in time and missed."""
    if sampling.misses is not None:
        return Turn.BOTH, Turn.HELD if sampling.misses.command == "hold" else Turn.ZEROED
    if sampling.round == 1:
        return (Turn.BOTH,)
    faster = sampling.outer < sampling.period.exact
    return Turn.BOTH, Turn.ADMITTANCE if faster else Turn.MOTION
