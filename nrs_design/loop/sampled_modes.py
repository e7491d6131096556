"""The modes of a sampled loop: one for each controller, contact, age and end of every range."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

from nrs_design.controllers.controller_design import Controller
from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.loop.calendar import Turn
from nrs_design.loop.flow import HELD_LOAD, HeldDrive
from nrs_design.loop.free_motion import Loss
from nrs_design.loop.located import ConstantParameter, LocatedMode, Spot, labelled_ends, spot_of
from nrs_design.loop.sampled import Contact, Rows, SampledLoop
from nrs_design.models.contact.environment import Environment
from nrs_design.models.drive import GAIN, LOAD
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import ZERO
from nrs_design.spec.interaction_parts import FREE
from nrs_design.spec.misses import MISS

NOWHERE = Spot()


# The place of drive and load, at corners; force samples there; and flows.
ContactFlows = tuple[Spot, Sequence[tuple[Spot, Contact]], Sequence[tuple[Spot, Rows]]]


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """Common data of the modes of a loop."""

    loop: SampledLoop
    held_drive: HeldDrive
    environments: tuple[Environment, ...]
    constants: tuple[ConstantParameter, ...]
    loses: bool  # Whether contact may come and go within a period
    # Drives at the corners of their ranges, with labels, in place of an enclosure.
    drives: tuple[tuple[tuple[str, ...], HeldDrive], ...]
    _cache: dict[object, tuple[tuple[Spot, Rows], ...]] = field(default_factory=dict)

    @property
    def _loaded(self) -> bool:
        """Whether the contact force acts on the motor."""
        return self.held_drive.drive.loaded

    def list_modes(
        self, controllers: Sequence[Controller], laws: Mapping[str, DiscreteLaw], loss: Loss
    ) -> tuple[list[LocatedMode], list[LocatedMode]]:
        """Return the modes of all controllers, and separate modes of free motion at the surface.

        Where contact is lost anywhere, a controller moves freely as it does in one more contact.
        """
        modes: list[LocatedMode] = []
        free: list[LocatedMode] = []
        target = modes if loss.anywhere else free if loss is Loss.SURFACE else None
        for c in controllers:
            law = laws[c.name]
            modes += self._list_controller(c, law)
            if c.contacts and target is not None:
                target += self._combine(c.name, (c.name, FREE), law, medium=FREE)
        law, turns = next(iter(laws.values())), self.loop.calendar.turns
        if turns[-1].is_miss:
            modes += self._list_idle(turns[-1], law, self.environments, FREE)
            if target is not None:
                target += self._list_idle(turns[-1], law, (), FREE)
        if Turn.MOTION in turns:
            # No force sample reaches them.
            contacts = self.environments if self._loaded else ()
            modes += self._list_idle(Turn.MOTION, law, contacts)
            free += self._list_idle(Turn.MOTION, law, contacts, FREE) if free else ()
        return modes, free

    def _list_controller(self, c: Controller, law: DiscreteLaw) -> Iterator[LocatedMode]:
        """Yield the modes of a controller in each of its contacts, or in all if it names none."""
        contacts = tuple(e for name in c.contacts for e in self.environments if e.name == name)
        if not contacts:
            # Free motion is a mode of its own only if a later sample or the motor feels the force.
            medium = FREE if self.loop.shown_later or self._loaded else ""
            yield from self._combine(c.name, (c.name,), law, medium=medium)
            contacts = self.environments if medium else ()
        for e in contacts:
            yield from self._combine(c.name, (c.name, e.name), law, e, contacts)

    def _list_idle(
        self, turn: Turn, law: DiscreteLaw, contacts: Sequence[Environment], *suffix: str
    ) -> Iterator[LocatedMode]:
        """Yield the modes of a sample at which no law is computed, in some contacts or in none."""
        name, medium = (MISS, FREE) if turn.is_miss else (str(turn), "")
        for e in contacts:
            yield from self._combine(f"/{name}", (name, e.name), law, e, contacts, (turn,))
        if not contacts:
            yield from self._combine(f"/{name}", (name, *suffix), law, turns=(turn,), medium=medium)

    def _combine(
        self,
        group: str,
        names: tuple[str, ...],
        law: DiscreteLaw,
        e: Environment | None = None,
        contacts: Sequence[Environment] = (),
        turns: Sequence[Turn] = (),
        medium: str = "",
    ) -> Iterator[LocatedMode]:
        """Yield the modes of a law in a contact or in none, or of turns without a law."""
        turns = turns or tuple(turn for turn in self.loop.calendar.turns if turn.has_law)
        head = Spot.from_names(*names)
        # A force sample matters to a law without force feedback only if it is delayed.
        sampled = turns[0].has_law or (turns[0].is_miss and self.loop.calendar.ages[1] > 0)
        for spot, samples, flows in self._touching(e, contacts, sampled=sampled):
            for turn, age, label in self._samples(law, turns, samples[0][1]):
                for place, contact in samples:
                    sample = self.loop.sample(law, age, contact, turn)
                    for flow, rows in flows:
                        yield LocatedMode(
                            group,
                            head + spot + label + place + flow,
                            medium if e is None else e.name,
                            self.loop.period(sample, rows),
                            starts_round=turn is Turn.BOTH,
                        )

    def _samples(
        self, law: DiscreteLaw, turns: Sequence[Turn], contact: Contact
    ) -> Iterator[tuple[Turn, int, Spot]]:
        """Yield tasks, with the age of their force sample and its label."""
        first, last = self.loop.calendar.ages
        if not turns[0].has_law:
            yield from ((turn, 0, NOWHERE) for turn in turns)
            return
        # A law that takes no force does the same at every age of its sample.
        if self.loop.sample(law, first, contact).does(self.loop.sample(law, last, contact)):
            last = first
        for turn, age in product(turns, range(first, last + 1)):
            labels = [f"delay-{age}"] if last > first else []
            labels += [str(turn)] if turn is Turn.ADMITTANCE else []
            yield turn, age, Spot.from_names(*labels)

    def _touching(
        self, e: Environment | None, contacts: Sequence[Environment], *, sampled: bool
    ) -> Iterator[ContactFlows]:
        """Yield samples and flows in a contact, for every drive."""
        loaded, forced = self._loaded, self.loop.takes_force
        constants = [c for c in self.constants if c.contact in (None, e and e.name)]
        real = () if loaded or (e is not None and e.depends) else LOAD
        for labels, drive in self.drives or (((), self.held_drive),):
            for load, ranges in self._loads(e, contacts):
                texts = (*load, *labels)
                # With a load, a force sample has its own ends only if a law takes the force.
                ends = labelled_ends(ranges if sampled and (forced or not loaded) else {})
                samples = [
                    (spot_of(tags, real, constants), (values.get("k", ZERO), values.get("b", ZERO)))
                    for tags, values in ends
                ]
                # The contact is no key: a flow names constants of a contact only if it is alone.
                key = drive, tuple(ranges.items()) if loaded else ()
                if key not in self._cache:
                    self._cache[key] = tuple(
                        (spot_of(point.labels, {GAIN}, constants, point.curve), point.rows)
                        for point in drive.flow(ranges, HELD_LOAD if forced else LOAD)
                    )
                ends_of = [text.rpartition("-")[0] for text in texts]
                yield spot_of(texts, ends_of, constants), samples, self._cache[key]

    def _loads(
        self, e: Environment | None, contacts: Sequence[Environment]
    ) -> Iterator[tuple[tuple[str, ...], Mapping[str, Interval]]]:
        """Yield labels of a load, and where its stiffness and damping are."""
        ranges = {} if e is None else dict(zip(LOAD, e.load, strict=True))
        if e is None or not self._loaded or (self.drives and e.depends):
            yield (), ranges
        elif not self.drives:
            # Within a period, the contact may change or be lost.
            yield (), anything_of(contacts, losable=self.loses)
        else:
            for labels, values in labelled_ends(ranges):
                yield labels, {symbol: Interval.point(value) for symbol, value in values.items()}


def anything_of(environments: Iterable[Environment], *, losable: bool) -> dict[str, Interval]:
    """Return ranges of stiffness and damping that hold all environments, or free motion.

    With `losable`, contact may be lost. A constant stays constant only in a single contact.
    """
    loads = [e.load for e in environments]
    return {
        symbol: Interval(
            ranges[0].nominal,
            ZERO if losable else min(r.low for r in ranges),
            max(r.high for r in ranges),
            losable or len(ranges) > 1 or ranges[0].varies,
        )
        for symbol, ranges in zip(LOAD, zip(*loads, strict=True), strict=True)
    }
