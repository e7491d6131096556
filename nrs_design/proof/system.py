"""The switched system that a certificate speaks about."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.proof.matrix import RationalMatrix, exact_fraction
from nrs_design.proof.noun import dataclass

if TYPE_CHECKING:
    from nrs_design.proof.saturation import Saturation


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

    Several resets may lead from one mode to another: each is a switch of its own.

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
class Edge:
    """One way from a mode to the next.

    Parameters
    ----------
    source, target : Mode
        The modes before and after.
    map : RationalMatrix or None, shape (n of target, n of source)
        What becomes of the state; None leaves it as it is.
    """

    source: Mode
    target: Mode
    map: RationalMatrix | None


@dataclass(frozen=True, slots=True)
class Stay:
    """How long a mode stays active, in s (discrete time: steps).

    Parameters
    ----------
    shortest : Fraction
        The dwell time: no switch comes earlier.
    longest : Fraction or None
        The mode is left by then; None lets it stay forever.
    """

    shortest: Fraction = Fraction(0)
    longest: Fraction | None = None


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
        Zero in continuous time leaves it free. For all modes that `stays` does not name.
    transitions : tuple of (str, str) or None
        Allowed switches from one mode to another; None allows all.
    resets : tuple of Reset
        For some transitions; the others leave the state as it is. Where several lead from one mode
        to another, a switch takes any one of them, and never leaves the state as it is.
    fixed_ends : tuple of (str, str)
        Pairs of modes that are the two ends of a parameter that is unknown but does not change:
        the mode in force is ``(1 - p) low + p high`` with one p for all pairs and all times. Every
        mode is in one pair, or there are none. Transitions take no notice of it: they lead from
        any end to any end, as if the parameter moved. What holds for all these signals holds for
        the fewer ones of a constant parameter; a signal that grows must keep to one value.
    fixed_parameter : FixedParameter or None
        What that parameter is, if known; for words only.
    stays : tuple of (str, Stay)
        Modes with a dwell time of their own, or with a longest one.
    """

    dwell_time: Fraction = Fraction(0)
    transitions: tuple[tuple[str, str], ...] | None = None
    resets: tuple[Reset, ...] = ()
    fixed_ends: tuple[tuple[str, str], ...] = ()
    fixed_parameter: FixedParameter | None = None
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
class Contact:
    """Contact that is lost and made again at any time.

    The last state is the deflection delta, the others are y. While delta is positive, the modes of
    the system are in force; while it is not, nothing pushes, and one of the free modes is.

    Parameters
    ----------
    free : tuple of Mode
        The motion without force, each of shape (n, n), with any switching among them. In its last
        column, what the deflection does to the other states, there are zeros; in its last row, what
        the motion does to the deflection.
    pulls : tuple of RationalMatrix, each of shape (1, n)
        For an environment that could pull: forces ``q x`` at the corners of its ranges. While
        delta is positive and a force within these ranges is not, there is no force, and one of the
        free modes is in force. Empty for springs, whose force has the sign of the deflection.
    required : bool
        Stability must be shown through any loss of contact; otherwise a proof may take for granted
        that contact is kept, and its claim says so.
    pushed : bool
        A constant force may push into contact: the deflection at which its force is that one is
        the same in all modes that follow each other, and a statement may be about it.
    """

    free: tuple[Mode, ...]
    pulls: tuple[RationalMatrix, ...] = ()
    required: bool = False
    pushed: bool = False


@dataclass(frozen=True, slots=True)
class Channel:
    """A disturbance d that acts on the state: ``x' = A x + B d``, or ``x+ = A x + B d``.

    Parameters
    ----------
    name, unit : str
        What it is, such as ``velocity command`` in ``rad/s``.
    bound : Fraction
        Its size is at most this, at every time; in discrete time, at every step.
    columns : tuple of RationalMatrix, each of shape (n, 1)
        The B of every mode, and after them those of the free modes.
    """

    name: str
    unit: str
    bound: Fraction
    columns: tuple[RationalMatrix, ...]


@dataclass(frozen=True, slots=True)
class Rounding:
    """An error r of one operation of the law: ``x+ = A x + B d + C r`` with ``|r| <= |q (x, d)|``.

    Parameters
    ----------
    name : str
        What is rounded, such as ``Kp e``.
    columns : tuple of RationalMatrix, each of shape (n, 1)
        The C of every mode, and after them those of the free modes.
    rows : tuple of RationalMatrix, each of shape (1, n + number of channels)
        The q of every mode, and after them those of the free modes, over the state and all
        disturbances of the system; in free motion nothing in them stands for the deflection.
    """

    name: str
    columns: tuple[RationalMatrix, ...]
    rows: tuple[RationalMatrix, ...]


@dataclass(frozen=True, slots=True)
class Coupling:
    """What the axes of a robot do to each other: ``x_i' = A_i x_i + B_i w_i`` for the axis i.

    Of any number of axes each is in a mode of its own, and ``sum |w_i|^2 <= sum |q_i z_i|^2`` over
    all of them, with the B_i and q_i of their modes, where z_i is x_i and, after it, what disturbs
    the axis and what its arithmetic rounds. In discrete time, that is said of every step.

    Parameters
    ----------
    name : str
        What acts, such as ``inertia of the links``.
    columns : tuple of RationalMatrix, each of shape (n, 1)
        The B of every mode, and after them those of the free modes.
    rows : tuple of RationalMatrix, each of shape (1, n + disturbances + roundings)
        The q in the same order, over the state, all disturbances and all roundings of the system;
        in free motion nothing in them stands for the deflection.
    """

    name: str
    columns: tuple[RationalMatrix, ...]
    rows: tuple[RationalMatrix, ...]


@dataclass(frozen=True, slots=True)
class Clock:
    """Modes that take turns: some at the first step of every round, all others at its other steps.

    Parameters
    ----------
    length : int
        Steps of a round, at least two. Time zero may be any of them.
    first : tuple of str
        Names of the modes, in contact and free, that are in force at the first steps.
    """

    length: int
    first: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Output:
    """A quantity that is one of some rows times the state, and within a range any mixture of them.

    Parameters
    ----------
    name, unit : str
        What it is, such as ``force`` in ``N*m``.
    rows : tuple of RationalMatrix, each of shape (1, n)
        At the corners of its ranges. In free motion the deflection counts as zero.
    limit : Fraction or None
        What its size is meant to keep; for words only.
    """

    name: str
    unit: str
    rows: tuple[RationalMatrix, ...]
    limit: Fraction | None = None


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
    contact : Contact or None
        How contact is lost; None where it is kept, or where there is none to lose.
    sample_time : Fraction or None
        Time from one step to the next in s, in discrete time, if there is such a time.
    channels : tuple of Channel
        Disturbances; statements about stability are about none of them.
    outputs : tuple of Output
        What bounds can be stated for.
    roundings : tuple of Rounding
        Errors of the arithmetic, in discrete time; a statement says whether it covers them.
    couplings : tuple of Coupling
        What axes like this one do to each other. Without any, every statement is about one axis;
        with them, statements of stability and of bounds are about all axes at once.
    axes : int or None
        How many of them there are at most, where a statement depends on it, as bounds do.
    clock : Clock or None
        Which modes take turns, in discrete time; None lets all of them be in force at every step.
    saturation : Saturation or None
        Signals that are cut off at limits; only statements that say so are about that.
    """

    name: str
    time: Time
    states: tuple[str, ...]
    modes: tuple[Mode, ...]
    assumptions: tuple[str, ...]
    switching: Switching = ARBITRARY
    contact: Contact | None = None
    sample_time: Fraction | None = None
    channels: tuple[Channel, ...] = ()
    outputs: tuple[Output, ...] = ()
    roundings: tuple[Rounding, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    clock: Clock | None = None
    axes: int | None = None
    saturation: Saturation | None = None

    def with_modes(
        self, modes: tuple[Mode, ...], states: tuple[str, ...], switching: Switching
    ) -> SwitchedSystem:
        """Return other modes for the same signals; what acts on these ones is left behind.

        Parameters
        ----------
        modes : tuple of Mode
            In the place of these.
        states : tuple of str
            Their states.
        switching : Switching
            Their rules.
        """
        return SwitchedSystem(self.name, self.time, states, modes, self.assumptions, switching)

    @property
    def order(self) -> int:
        """Number of states n (of the largest mode)."""
        return len(self.states)

    @property
    def is_uniform(self) -> bool:
        """Whether all modes have the same number of states."""
        order = self.order
        return all(len(mode.A.numerators) == order for mode in self.modes)

    def edges(self) -> list[Edge]:
        """Return the allowed switches from one mode to another, one for each way to switch."""
        transitions = self.switching.transitions
        allowed = None if transitions is None else frozenset(transitions)
        maps = self.switching.maps()
        return [
            Edge(source, target, map_)
            for source in self.modes
            for target in self.modes
            if source.name != target.name
            and (allowed is None or (source.name, target.name) in allowed)
            for map_ in maps.get((source.name, target.name), [None])
        ]

    def stays(self) -> dict[str, Stay]:
        """Return how long each mode stays active; in discrete time at least one step."""
        own = {name: self._at_least_a_step(stay) for name, stay in self.switching.stays}
        common = self._at_least_a_step(Stay(self.switching.dwell_time))
        return {mode.name: own.get(mode.name, common) for mode in self.modes}

    def _at_least_a_step(self, stay: Stay) -> Stay:
        if self.time is Time.CONTINUOUS or stay.shortest >= 1:
            return stay
        return replace(stay, shortest=Fraction(1))

    def lasting_modes(self) -> tuple[Mode, ...]:
        """Return the modes that need never be left; none where modes take turns."""
        if self.clock is not None:
            return ()
        left = {name for name, stay in self.switching.stays if stay.longest is not None}
        return tuple(mode for mode in self.modes if mode.name not in left)

    def find_contradiction(self) -> str | None:
        """TRUSTED: say why the rules of switching make no sense for these modes, or None."""
        names = {mode.name for mode in self.modes}
        return (
            self._find_odd_stay(names)
            or self._find_odd_switch(names)
            or self._find_odd_ends(names)
            or self._find_odd_contact(names)
            or self._find_odd_sample_time()
            or self._find_odd_channel()
            or self._find_odd_rounding()
            or self._find_odd_coupling()
            or self._find_odd_clock()
            or self._find_odd_saturation()
        )

    def _find_odd_stay(self, names: set[str]) -> str | None:
        own = self.switching.stays
        if len(dict(own)) < len(own) or not dict(own).keys() <= names:
            return "the dwell times are not those of modes"
        for name, stay in own:
            shortest, longest = self._at_least_a_step(stay).shortest, stay.longest
            if longest is not None and longest < shortest:
                return f"mode {name} must be left before it may be"
        if min((self.switching.dwell_time, *(stay.shortest for _, stay in own))) < 0:
            return "a dwell time is negative"
        return None

    def _find_odd_switch(self, names: set[str]) -> str | None:
        for source, target in self.switching.transitions or ():
            if source == target or not {source, target} <= names:
                return "a transition does not lead from one mode to another"
        for reset in self.switching.resets:
            if reset.source == reset.target or not {reset.source, reset.target} <= names:
                return "a reset does not lead from one mode to another"
            if not reset.map.is_well_formed:
                return "a reset is not a matrix over a positive denominator"
        return None

    def _find_odd_ends(self, names: set[str]) -> str | None:
        ends = [name for pair in self.switching.fixed_ends for name in pair]
        if ends and sorted(ends) != sorted(names):
            return "the modes are not the ends of one constant parameter"
        return None

    def _find_odd_contact(self, names: set[str]) -> str | None:
        if self.contact is None:
            return None
        n, free = self.order, self.contact.free
        if n < 2 or not self.is_uniform:
            return "contact is lost, but the modes do not share a deflection beside other states"
        if not free or len({mode.name for mode in free} - names) < len(free):
            return "contact is lost, but there is no free mode, or two modes have one name"
        if not all(_is_motion(mode.A, n, self.time) for mode in free):
            return "the deflection acts on the other states in a free mode"
        if not all(q.is_well_formed and q.shape == (1, n) for q in self.contact.pulls):
            return "a force is not one row over a positive denominator"
        return None

    def _find_odd_sample_time(self) -> str | None:
        if self.sample_time is None:
            return None
        if self.time is Time.CONTINUOUS or self.sample_time <= 0:
            return "the time of a step is not positive, or there are no steps"
        return None

    def _find_odd_channel(self) -> str | None:
        n, free = self.order, () if self.contact is None else self.contact.free
        sized = [(c.name, M, (n, 1)) for c in self.channels for M in c.columns]
        sized += [(o.name, M, (1, n)) for o in self.outputs for M in o.rows]
        for name, M, shape in sized:
            if not M.is_well_formed or M.shape != shape:
                return f"{name} does not have the size of the state"
        for channel in self.channels:
            if channel.bound <= 0 or len(channel.columns) != len(self.modes) + len(free):
                return f"{channel.name} has no positive bound, or not one column for every mode"
        if not all(output.rows for output in self.outputs):
            return "an output has no rows"
        if any(output.limit is not None and output.limit <= 0 for output in self.outputs):
            return "the limit of an output is not positive"
        names = [*(c.name for c in self.channels), *(o.name for o in self.outputs)]
        return "two disturbances or outputs have one name" if len(set(names)) < len(names) else None

    def _find_odd_rounding(self) -> str | None:
        if self.roundings and self.time is Time.CONTINUOUS:
            return "the arithmetic rounds, but there are no steps"
        if self.roundings and not self.is_uniform:
            return "the arithmetic rounds, but the modes are not of one size"
        width = self.order + len(self.channels)
        for item in self.roundings:
            if (odd := self._find_odd_parts(item, width)) is not None:
                return f"the rounding of {item.name} {odd}"
        names = [item.name for item in self.roundings]
        return "two roundings have one name" if len(set(names)) < len(names) else None

    def _find_odd_coupling(self) -> str | None:
        if self.axes is not None and (self.axes < 1 or not self.couplings):
            return "there is no axis, or axes are counted that do not act on each other"
        if self.couplings and not self.is_uniform:
            return "axes act on each other, but their modes are not of one size"
        width = self.order + len(self.channels) + len(self.roundings)
        for item in self.couplings:
            if (odd := self._find_odd_parts(item, width)) is not None:
                return f"the coupling by {item.name} {odd}"
        names = [item.name for item in self.couplings]
        return "two couplings have one name" if len(set(names)) < len(names) else None

    def _find_odd_clock(self) -> str | None:
        if self.clock is None:
            return None
        if self.time is Time.CONTINUOUS or self.clock.length < 2 or not self.is_uniform:
            return "modes take turns without steps, in rounds of less than two, or of unlike size"
        if not self.switching.is_arbitrary:
            return "modes take turns, and have rules of switching besides"
        first, free = set(self.clock.first), () if self.contact is None else self.contact.free
        groups = [{mode.name for mode in part} for part in (self.modes, free) if part]
        if not first <= set().union(*groups):
            return "a mode that does not exist is to take its turn"
        if not all(first & group and group - first for group in groups):
            return "a step of a round has no mode, in contact or free"
        return None

    def _find_odd_saturation(self) -> str | None:
        if self.saturation is None:
            return None
        if not self.is_uniform:
            return "signals saturate, but the modes are not of one size"
        free = () if self.contact is None else self.contact.free
        return self.saturation.find_oddity(self.order, len(self.modes), len(free))

    def _find_odd_parts(self, item: Rounding | Coupling, width: int) -> str | None:
        """Say why columns and rows are not those of every mode and free mode, or None."""
        n, free = self.order, () if self.contact is None else self.contact.free
        sized = [*((M, (n, 1)) for M in item.columns), *((M, (1, width)) for M in item.rows)]
        if not all(M.is_well_formed and M.shape == shape for M, shape in sized):
            return "does not have the size of the state"
        if not len(item.columns) == len(item.rows) == len(self.modes) + len(free):
            return "has not one column and row for every mode"
        if any(row.numerators[0][n - 1] for row in item.rows[len(self.modes) :]):
            return "depends on the deflection in free motion"
        return None


def _is_motion(A: RationalMatrix, order: int, time: Time) -> bool:
    """Tell whether a free mode has its shape, and the deflection only moves on from where it is."""
    if not A.is_well_formed or A.shape != (order, order):
        return False
    *others, last = (row[-1] for row in A.numerators)
    return not any(others) and last == (0 if time is Time.CONTINUOUS else A.denominator)
