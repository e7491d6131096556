"""Calendar of a sampling period: the computed tasks, and the times of commands."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from math import ceil, floor

from nrs_design.models.interval import Interval
from nrs_design.spec.sampling import SamplingSpec

ZERO = Fraction(0)


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
class CommandTiming:
    """Delays of commands; the newest command that has arrived is in force.

    The command of the sample at time t takes effect between ``t + earliest`` and ``t + latest``,
    each at a time of its own. A command of age 0 is computed at the begin of the period.
    """

    period: Fraction  # From sample to sample in s
    # earliest, latest: from a sample to its command, in s.
    earliest: Fraction = ZERO
    latest: Fraction = ZERO
    jitter: Fraction = ZERO  # Largest deviation of a period from its nominal length, in s
    # The time from every sample to its command in s, of all that may be, and periods do not differ.
    delay: Fraction | None = None

    @property
    def lengths(self) -> Interval:
        """How long a period is, in s."""
        return Interval(self.period, self.period - self.jitter, self.period + self.jitter)

    @property
    def steps(self) -> Interval:
        """Lengths of the periods in s; one length if the delay is the same at every sample."""
        return self.lengths if self.delay is None else Interval.point(self.period)

    @property
    def oldest(self) -> int:
        """Age of the command that is in force when a period begins; a newer one may be already."""
        return ceil(self.latest / self.lengths.low)

    @property
    def newest(self) -> int:
        """Age of the newest command that may take effect before a period ends."""
        return min(floor(self.earliest / self.lengths.high), self.oldest)

    @property
    def varies(self) -> bool:
        """Whether periods differ, or times from a sample to its command."""
        return self.earliest < self.latest or self.jitter > 0

    @property
    def new_ages(self) -> range:
        """Ages of the commands that may take effect within a period, the oldest first."""
        return range(self.oldest - 1, self.newest - 1, -1)

    def points(self) -> Iterator[tuple[tuple[str, ...], CommandTiming]]:
        """Yield times that are attained at every sample, with the label of each."""
        if not self.varies:
            yield (), self
        elif len(self.new_ages) == 1 and not self.jitter:
            (age,) = self.new_ages
            yield (f"h{age}-max",), replace(self, delay=self.earliest)
            yield (f"h{age}-min",), replace(self, delay=self.latest)
        else:
            yield (), replace(self, delay=self.latest)

    def time_left(self, age: int) -> Interval:
        """Return the time in s, from 0 to a period, left of it with commands of an age or newer."""
        if self.delay is not None:
            begin = min(max(self.delay - age * self.period, ZERO), self.period)
            return Interval.point(self.period - begin)
        shortest, longest = self.lengths.low, self.lengths.high
        bounds = self.earliest - age * longest, self.latest - age * shortest
        low = shortest - min(max(bounds[1], ZERO), shortest)
        high = longest - min(max(bounds[0], ZERO), longest)
        return Interval(high, low, high)


@dataclass(frozen=True, slots=True)
class Calendar:
    """The events of a period: samples, and commands that take effect."""

    timing: CommandTiming
    ages: tuple[int, int] = (0, 0)  # Smallest and largest age of force samples
    turns: tuple[Turn, ...] = (Turn.BOTH,)  # The tasks of a round

    @property
    def pending(self) -> tuple[str, ...]:
        """The commands of samples before that are still on their way, the newest first."""
        return tuple(f"u {age} before" for age in range(1, self.timing.oldest + 1))

    @property
    def samples(self) -> tuple[str, ...]:
        """The force samples that are on their way, the newest first."""
        return tuple(f"F {age} before [N*m]" for age in range(1, self.ages[1] + 1))

    @property
    def holds(self) -> bool:
        """Whether a command outlasts a sample, and is not on its way anyway."""
        return not self.pending and not {Turn.ADMITTANCE, Turn.HELD}.isdisjoint(self.turns)


def turns_of(sampling: SamplingSpec) -> tuple[Turn, ...]:
    """Return the tasks of the samples in a round, or of samples in time and missed."""
    if sampling.misses is not None:
        return Turn.BOTH, Turn.HELD if sampling.misses.command == "hold" else Turn.ZEROED
    if sampling.round == 1:
        return (Turn.BOTH,)
    faster = sampling.outer < sampling.period.exact
    return Turn.BOTH, Turn.ADMITTANCE if faster else Turn.MOTION
