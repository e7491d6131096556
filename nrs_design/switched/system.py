"""The switched system that a certificate speaks about."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction

from nrs_design.switched.matrix import RationalMatrix, exact_fraction


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
class Reset:
    """What happens to the state at a switch: ``x+ = map x`` (thesis 5.9).

    Parameters
    ----------
    source, target : str
        Names of the modes before and after.
    map : RationalMatrix, shape (n of target, n of source)
        The linear map.
    """

    source: str
    target: str
    map: RationalMatrix


@dataclass(frozen=True, slots=True)
class FixedParameter:
    """A parameter that is unknown but constant: its name and the ends of its range."""

    name: str
    low: Fraction
    high: Fraction


@dataclass(frozen=True, slots=True)
class Switching:
    """Which switching signals there are.

    Parameters
    ----------
    dwell_time : Fraction
        Shortest time in a mode, in s; in discrete time the smallest number of steps, at least one.
        Zero in continuous time leaves it free.
    transitions : tuple of (str, str) or None
        Allowed switches from one mode to another; None allows all.
    resets : tuple of Reset
        For some transitions; the others leave the state as it is.
    fixed_ends : tuple of (str, str)
        Pairs of modes that are the two ends of a parameter that is unknown but does not change:
        the mode in force is ``(1 - p) low + p high`` with one p for all pairs and all times. Every
        mode is in one pair, or there are none. Transitions take no notice of it: they lead from
        any end to any end, as if the parameter moved. What holds for all these signals holds for
        the fewer ones of a constant parameter; a signal that grows must keep to one value.
    fixed_parameter : FixedParameter or None
        What that parameter is, if known; for words only.
    """

    dwell_time: Fraction = Fraction(0)
    transitions: tuple[tuple[str, str], ...] | None = None
    resets: tuple[Reset, ...] = ()
    fixed_ends: tuple[tuple[str, str], ...] = ()
    fixed_parameter: FixedParameter | None = None

    def __post_init__(self) -> None:
        """Take a dwell time of any exact kind as a fraction of Python integers."""
        object.__setattr__(self, "dwell_time", exact_fraction(self.dwell_time))

    @property
    def is_arbitrary(self) -> bool:
        """Whether every signal is possible and the state is continuous."""
        return self == ARBITRARY


ARBITRARY = Switching()


@dataclass(frozen=True, slots=True)
class SwitchedSystem:
    """A linear switched system.

    Parameters
    ----------
    name : str
        Name of the spec that it comes from.
    time : Time
        Continuous or discrete.
    states : tuple of str
        Name and unit of each state.
    modes : tuple of Mode
        At least one; all of the same size, unless resets link states of different sizes.
    assumptions : tuple of str
        What a statement about these matrices takes for granted about the robot.
    switching : Switching
        The signals that are possible.
    """

    name: str
    time: Time
    states: tuple[str, ...]
    modes: tuple[Mode, ...]
    assumptions: tuple[str, ...]
    switching: Switching = ARBITRARY

    @property
    def order(self) -> int:
        """Number of states n (of the largest mode)."""
        return len(self.states)

    @property
    def is_uniform(self) -> bool:
        """Whether all modes have the same number of states."""
        order = self.order
        return all(len(mode.A.numerators) == order for mode in self.modes)

    def transitions(self) -> list[tuple[Mode, Mode]]:
        """Return the allowed switches from one mode to another."""
        transitions = self.switching.transitions
        allowed = None if transitions is None else frozenset(transitions)
        return [
            (source, target)
            for source in self.modes
            for target in self.modes
            if source.name != target.name
            and (allowed is None or (source.name, target.name) in allowed)
        ]

    def reset_map(self, source: Mode, target: Mode) -> RationalMatrix | None:
        """Return the reset at a switch, or None if the state is left as it is."""
        for reset in self.switching.resets:
            if (reset.source, reset.target) == (source.name, target.name):
                return reset.map
        return None
