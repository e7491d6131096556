"""The rules of switching: which signals there are, and what a switch does to the state."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product

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
    unit: str = ""  # Of its ends
    inverse: bool = False  # Modes are affine in one over it; it is positive then
    enclosed: bool = False  # Corners enclose what modes are at its values: none need be attained


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
    # Where parameters are unknown but do not change: for each mode its copies at the corners of
    # these parameters, all sets in one order of corners. The mode in force is ``sum_v w_v A_v``
    # with one set of weights, not negative and with sum one, for all modes and all times. Every
    # mode is in one set, there perhaps several times: then it is the same at these corners.
    # Transitions take no notice of it: they lead from any corner to any corner, as if parameters
    # moved. What holds for all these signals holds for the fewer ones of constant parameters; a
    # signal that grows must keep to one value.
    fixed_ends: tuple[tuple[str, ...], ...] = ()
    # What these parameters are, if known. Weights are products of shares, one for each of them and
    # all of them attained, if the corners of a set are two to the power of their number: then the
    # corners are their ends, low before high, the last parameter turning fastest. Otherwise the
    # corners enclose values, and none of them need be attained. Without names all weights are.
    fixed_parameters: tuple[FixedParameter, ...] = ()
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

    def corners_of(self) -> dict[str, frozenset[int]]:
        """Return at which corners of the constant parameters each mode is; none if there are none.

        A mode that is the same at several corners is at all of them.
        """
        return {
            name: frozenset(k for k, other in enumerate(corners) if other == name)
            for corners in self.fixed_ends
            for name in corners
        }

    def share_a_corner(self, names: Iterable[str]) -> bool:
        """Tell whether constant parameters may be at one corner while these modes are in force."""
        corners = self.corners_of()
        if not corners:
            return True
        found = [corners.get(name, frozenset()) for name in names]
        return bool(frozenset.intersection(*found))

    @property
    def is_arbitrary(self) -> bool:
        """Whether every signal is possible and the state is continuous."""
        return self == ARBITRARY


ARBITRARY = Switching()


# Where a mode leads that may not be in force.
NOWHERE = -1


@dataclass(frozen=True, slots=True)
class Clock:
    """Modes of a few kinds, of which an automaton says which may be in force at a step.

    In a round, the modes of the first kind are in force at its first step, the others at all
    others. Where deadlines are missed, both kinds may be in force in most states of the automaton:
    the first kind where a deadline is kept, the others where it is missed. Where controllers have
    dwell times, the modes of each are a kind, and the automaton counts the steps of a stay.
    """

    # Steps of a round, or states of the automaton, at least two. Time zero may be any of them.
    length: int
    first: tuple[str, ...]  # Names of the modes of the first kind, in contact and free
    # For each state, where a mode of each kind leads; -1 where it may not be in force. Empty for a
    # round.
    ahead: tuple[tuple[int, ...], ...] = ()
    # Names of the modes of the kinds after the first; those that are not named are the last kind.
    more: tuple[tuple[str, ...], ...] = ()

    @property
    def is_round(self) -> bool:
        """Whether it is a round, without an automaton."""
        return not self.ahead

    @property
    def counts_stays(self) -> bool:
        """Whether every kind of modes may stay in force, as it may after a dwell time."""
        states = range(self.length)
        return all(any(self.after(k, kind) == k for k in states) for kind in self.kinds)

    @property
    def kinds(self) -> range:
        """The kinds of modes, by their numbers."""
        return range(len(self.more) + 2)

    def kind_of(self, names: Iterable[str]) -> list[int]:
        """Return the kind of each mode, by its name."""
        numbers = {name: k for k, group in enumerate((self.first, *self.more)) for name in group}
        return [numbers.get(name, self.kinds[-1]) for name in names]

    def after(self, state: int, kind: int) -> int | None:
        """Return where a mode of a kind leads from a state; None where it may not be in force."""
        if self.ahead:
            target = self.ahead[state][kind]
            return None if target == NOWHERE else target
        return (state + 1) % self.length if (kind == 0) == (state == 0) else None

    def turns(self) -> Iterator[tuple[int, int, int]]:
        """Yield every state, each kind of modes that may be in force, and where these lead."""
        for state, kind in product(range(self.length), self.kinds):
            target = self.after(state, kind)
            if target is not None:
                yield state, kind, target


def constants_words(switching: Switching) -> str:
    """Name the constant parameters, such as ``k and m in their ranges``."""
    names = [parameter.name for parameter in switching.fixed_parameters]
    if not names:
        return "the constant parameters in their ranges"
    *first, last = names
    text = f"{', '.join(first)} and {last}" if first else last
    return f"{text} in {'their ranges' if first else 'its range'}"
