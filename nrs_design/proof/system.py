"""The switched system that a certificate speaks about."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import compress

from nrs_design.proof.assumption import Assumption
from nrs_design.proof.channels import Channel, Output, Rounding
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.matrix import RationalMatrix, leading
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.saturation import Saturation
from nrs_design.proof.switching import ARBITRARY, Clock, Edge, Stay, Switching


@dataclass(frozen=True, slots=True, kw_only=True)
class SwitchedSystem:
    """A linear switched system."""

    name: str  # Name of the spec that it comes from
    time: Time  # Continuous or discrete
    states: tuple[str, ...]  # Name and unit of each state
    # At least one; all of the same size, unless resets link states of different sizes.
    modes: tuple[Mode, ...]
    # What a statement about these matrices takes for granted about the robot.
    assumptions: tuple[Assumption, ...]
    switching: Switching = ARBITRARY  # The signals that are possible
    # How contact is lost; None where it is kept, where there is none to lose, or where free motion
    # is among the modes.
    contact: Contact | None = None
    # Time from one step to the next in s, in discrete time, if there is such a time.
    sample_time: Fraction | None = None
    # Disturbances; statements about stability are about none of them.
    channels: tuple[Channel, ...] = ()
    outputs: tuple[Output, ...] = ()  # Quantities for which bounds can be stated
    # Errors of the arithmetic, in discrete time; a statement says whether it covers them.
    roundings: tuple[Rounding, ...] = ()
    # Which modes take turns, in discrete time; None lets all of them be in force at every step.
    clock: Clock | None = None
    # Signals that are cut off at limits; only statements that say so are about that.
    saturation: Saturation | None = None
    # Which modes are free motion, where it is among them and its loss must be covered.
    flights: Flights | None = None
    # Sets of modes, in contact or free, none of which need be attained: wherever one of a set may
    # be in force, some combination of them may, with weights that are not negative and have the sum
    # one. Sets that are one at the corners of constant parameters have the same weights, in their
    # order. A mode that is in no set is attained itself.
    enclosures: tuple[tuple[str, ...], ...] = ()

    def __post_init__(self) -> None:
        """Take the word for a time as that time, so that no check takes it for another."""
        object.__setattr__(self, "time", Time(self.time))

    def with_modes(
        self,
        modes: tuple[Mode, ...],
        states: tuple[str, ...],
        switching: Switching,
        enclosures: tuple[tuple[str, ...], ...] | None = None,
    ) -> SwitchedSystem:
        """Return other modes for the same signals; what acts on these ones is left behind."""
        return SwitchedSystem(
            name=self.name,
            time=self.time,
            states=states,
            modes=modes,
            assumptions=self.assumptions,
            switching=switching,
            enclosures=self.enclosures if enclosures is None else enclosures,
        )

    def only(self, names: Collection[str]) -> SwitchedSystem:
        """TRUSTED: return the system with some of its modes, in contact and free, without turns.

        What disturbs it stays: the rows of roundings are over the states and all disturbances.
        """
        mask = [mode.name in names for mode in self.every_mode]
        flying = mask[len(self.modes) :]
        contact = self.contact
        if contact is not None:
            contact = replace(contact, free=tuple(compress(contact.free, flying)))
        roundings = (
            replace(
                item,
                columns=tuple(compress(item.columns, mask)),
                rows=tuple(compress(item.rows, mask)),
            )
            for item in self.roundings
        )
        channels = (
            replace(item, columns=tuple(compress(item.columns, mask))) for item in self.channels
        )
        return replace(
            self,
            modes=tuple(compress(self.modes, mask)),
            contact=contact,
            clock=None,
            roundings=tuple(roundings),
            channels=tuple(channels),
            saturation=None,
            enclosures=tuple(item for item in self.enclosures if item[0] in names),
        )

    @property
    def is_losable(self) -> bool:
        """Whether a statement must cover the loss of contact."""
        return self.flights is not None or (self.contact is not None and self.contact.required)

    @property
    def free(self) -> tuple[Mode, ...]:
        """Modes of free motion beside the modes."""
        return () if self.contact is None else self.contact.free

    @property
    def every_mode(self) -> tuple[Mode, ...]:
        """Modes in contact and free."""
        return (*self.modes, *self.free)

    def free_motions(self) -> tuple[Mode, ...]:
        """TRUSTED: return the modes of free motion without the deflection, where they count.

        That is where the loss of contact must be covered; where modes take turns, none of them is
        in force for long.
        """
        if self.contact is None or not self.contact.required or self.clock is not None:
            return ()
        return tuple(
            Mode(mode.name, RationalMatrix(tuple(leading(mode.A.numerators)), mode.A.denominator))
            for mode in self.free
        )

    @property
    def has_constants(self) -> bool:
        """Whether parameters are unknown but constant."""
        return bool(self.switching.fixed_ends)

    def enclosure_of(self, mode: str) -> tuple[str, ...]:
        """TRUSTED: return the modes between which what is attained is; a mode that is, alone."""
        return next((names for names in self.enclosures if mode in names), (mode,))

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
        pairs = None if transitions is None else frozenset(transitions)
        maps = self.switching.maps()
        return [
            Edge(source, target, map_)
            for source in self.modes
            for target in self.modes
            if source.name != target.name and (pairs is None or (source.name, target.name) in pairs)
            for map_ in maps.get((source.name, target.name), [None])
        ]

    def stays(self) -> dict[str, Stay]:
        """Return how long each mode stays active; in discrete time at least one step."""
        limits = {name: self._at_least_a_step(stay) for name, stay in self.switching.stays}
        common = self._at_least_a_step(Stay(self.switching.dwell_time))
        return {mode.name: limits.get(mode.name, common) for mode in self.modes}

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
