"""The rules of switching: which signals there are, and what a switch does to the state."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from nrs_design.proof.matrix import RationalMatrix, exact_fraction
from nrs_design.proof.mode import Mode


@dataclass(frozen=True, slots=True)
class Reset:
    """What happens to the state at a switch: ``x+ = map x`` (thesis 5.9).

    Several resets may lead from one mode to another: each is a switch of its own.
    """

    # source, target: names of the modes before and after.
    source: str
    target: str
    map: RationalMatrix  # Shape (n of target, n of source). The linear map.


@dataclass(frozen=True, slots=True)
class Edge:
    """One way from a mode to the next."""

    # source, target: the modes before and after.
    source: Mode
    target: Mode
    # Shape (n of target, n of source). What becomes of the state; None leaves it as it is.
    map: RationalMatrix | None


@dataclass(frozen=True, slots=True)
class Stay:
    """How long a mode stays active, in s (discrete time: steps)."""

    shortest: Fraction = Fraction(0)  # The dwell time: no switch comes earlier
    longest: Fraction | None = None  # The mode is left by then; None lets it stay forever


@dataclass(frozen=True, slots=True)
class FixedParameter:
    """A parameter that is unknown but constant: its name and the ends of its range."""

    name: str
    low: Fraction = field(metadata={"signed": True})
    high: Fraction = field(metadata={"signed": True})


@dataclass(frozen=True, slots=True)
class Switching:
    """Which switching signals there are."""

    # Shortest time in a mode, in s; in discrete time the smallest number of steps, at least one.
    # Zero in continuous time leaves it free. For all modes that `stays` does not name.
    dwell_time: Fraction = Fraction(0)
    # Allowed switches from one mode to another; None allows all.
    transitions: tuple[tuple[str, str], ...] | None = None
    # For some transitions; the others leave the state as it is. Where several lead from one mode to
    # another, a switch takes any one of them, and never leaves the state as it is.
    resets: tuple[Reset, ...] = ()
    # Pairs of modes that are the two ends of a parameter that is unknown but does not change: the
    # mode in force is ``(1 - p) low + p high`` with one p for all pairs and all times. Every mode
    # is in one pair, or there are none. Transitions take no notice of it: they lead from any end to
    # any end, as if the parameter moved. What holds for all these signals holds for the fewer ones
    # of a constant parameter; a signal that grows must keep to one value.
    fixed_ends: tuple[tuple[str, str], ...] = ()
    # What that parameter is, if known; for words only.
    fixed_parameter: FixedParameter | None = None
    # Modes with a dwell time of their own, or with a longest one.
    stays: tuple[tuple[str, Stay], ...] = ()

    def stay(self, mode: str) -> Stay:
        """Return how long a mode stays active."""
        return dict(self.stays).get(mode, Stay(self.dwell_time))

    def maps(self) -> dict[tuple[str, str], list[RationalMatrix]]:
        """Return the maps of the resets, in order, by the switch that they belong to."""
        maps: dict[tuple[str, str], list[RationalMatrix]] = {}
        for reset in self.resets:
            maps.setdefault((reset.source, reset.target), []).append(reset.map)
        return maps

    def __post_init__(self) -> None:
        """Take a dwell time of any exact kind as a fraction of Python integers."""
        object.__setattr__(self, "dwell_time", exact_fraction(self.dwell_time))

    @property
    def is_arbitrary(self) -> bool:
        """Whether every signal is possible and the state is continuous."""
        return self == ARBITRARY


ARBITRARY = Switching()


@dataclass(frozen=True, slots=True)
class Clock:
    """Modes that take turns: some at the first step of a round, the others at its other steps."""

    length: int  # Steps of a round, at least two. Time zero may be any of them.
    # Names of the modes, in contact and free, that are in force at the first steps.
    first: tuple[str, ...]
