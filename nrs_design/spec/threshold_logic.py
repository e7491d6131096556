"""Switching by thresholds on command and torque, and the least time between switches.

A switch is made when all of its conditions hold. A signal that is known up to a noise N, as old as
an age D, and no faster than a rate R needs a time to get from one threshold to another: at least
``(band - 2 N)/R - D``. So no switch follows another one sooner, where the two ask for opposite
sides of such a band.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import Field

from nrs_design.proof.bounds import lower, lower_float, upper_float
from nrs_design.proof.text import exact_text
from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Reference, Row, each, refuse
from nrs_design.spec.faults import Location
from nrs_design.spec.fields import Label
from nrs_design.spec.model import ParsedBy, SpecModel, at_most, optional, required
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.switching import (
    DWELL_SCHEMA,
    DwellTime,
    DwellTimes,
    SwitchingSpec,
    read_dwell_times,
)

MAX_SWITCHES = 64
DIGITS = 4

_NOISE = "largest error of the value that the logic sees, either way, in {unit}"
_AGE = (
    "largest age in s of the value that the logic acts on, at any time: sampling period, filter, "
    "bus and computation together"
)
_RATE = "how fast the true value changes at most, in {unit}"
_ABOVE = "the value that the logic sees is at least this, in {unit}"
_BELOW = "the value that the logic sees is at most this, in {unit}"


class CommandSignalSpec(SpecModel, stronger="larger"):
    """The velocity command of the surgeon, positive towards the tissue."""

    noise: field.AngularVelocity = required(_NOISE.format(unit="rad/s"))
    age: field.Duration = required(_AGE)
    largest_rate: field.AngularAcceleration = required(_RATE.format(unit="rad/s^2"))


class TorqueSignalSpec(SpecModel, stronger="larger"):
    """The torque of the tissue on the robot, positive where it is pushed."""

    noise: field.Torque = required(_NOISE.format(unit="N*m"))
    age: field.Duration = required(_AGE)
    largest_rate: field.TorqueRate = required(_RATE.format(unit="N*m/s"))


SignalSpec = CommandSignalSpec | TorqueSignalSpec


class LogicSignalsSpec(SpecModel, stronger="unknown", unsaid="most"):
    """What the logic sees."""

    command: CommandSignalSpec | None = optional("velocity command, positive towards the tissue")
    torque: TorqueSignalSpec | None = optional("torque of the tissue, positive where it is pushed")


_ONE_SIDE = Row[Any](
    "",
    lambda s: (s.above is None) == (s.below is None),
    "a condition has one threshold",
    "write {{above: ...}} or {{below: ...}}",
)


class CommandCondition(SpecModel, stronger="unknown", unsaid="most"):
    """One side of a threshold on the command."""

    above: field.SignedAngularVelocity | None = optional(_ABOVE.format(unit="rad/s"))
    below: field.SignedAngularVelocity | None = optional(_BELOW.format(unit="rad/s"))

    checks = (_ONE_SIDE,)


class TorqueCondition(SpecModel, stronger="unknown", unsaid="most"):
    """One side of a threshold on the torque."""

    above: field.SignedTorque | None = optional(_ABOVE.format(unit="N*m"))
    below: field.SignedTorque | None = optional(_BELOW.format(unit="N*m"))

    checks = (_ONE_SIDE,)


Condition = CommandCondition | TorqueCondition


class LogicSwitchSpec(SpecModel, stronger="unknown", unsaid="most"):
    """A switch, and what must hold when it is made."""

    source: Label = Field(alias="from", description="controller that is left")
    target: Label = Field(alias="to", description="controller that takes over")
    command: CommandCondition | None = optional("{above: ...} or {below: ...}, in rad/s")
    torque: TorqueCondition | None = optional("{above: ...} or {below: ...}, in N*m")

    @property
    def conditions(self) -> dict[str, Condition]:
        """The conditions by signal."""
        written = (("command", self.command), ("torque", self.torque))
        return {name: condition for name, condition in written if condition is not None}

    checks = (
        Row(
            "to",
            lambda s: s.source == s.target,
            "a switch leads to another controller",
            "remove it",
        ),
        Row(
            "",
            lambda s: not s.conditions,
            "nothing says when this switch is made",
            "add command or torque",
        ),
    )


@dataclass(frozen=True, slots=True)
class SwitchSeparation:
    """How far apart two switches lie that follow each other."""

    # entering, leaving: indices of the two switches.
    entering: int
    leaving: int
    signal: str | None  # That has to move in between; None if none has
    seconds: Fraction  # Least time between the switches, not rounded; zero if there is none


class ThresholdLogicSpec(SpecModel, stronger="unknown"):
    """Controllers that follow each other by thresholds on command and torque."""

    type: Literal["thresholds"] = required("thresholds: switches by command and torque")
    start: Label = required("controller that is active at first")
    signals: LogicSignalsSpec = required("what the logic sees, and how well")
    switches: Annotated[
        tuple[LogicSwitchSpec, ...], Field(min_length=1, max_length=MAX_SWITCHES)
    ] = required("switches between controllers; the first that may be made is")
    hold: Annotated[DwellTimes | None, ParsedBy(read_dwell_times, DWELL_SCHEMA)] = at_most(
        "shortest time in s for each controller; one for all, or by name. Default: thresholds, "
        "noise and age",
        unsaid="most",
    )

    def _unsaid(self) -> Iterator[tuple[Location, str]]:
        """Yield the conditions of switches on an undeclared signal."""
        for index, switch in enumerate(self.switches):
            for name in switch.conditions:
                if getattr(self.signals, name) is None:
                    yield ("switches", index, name), name

    def _holds(self) -> dict[str, DwellTime]:
        """Return how long controllers are held, by name; "" for all."""
        if self.hold is None:
            return {}
        return self.hold if isinstance(self.hold, dict) else {"": self.hold}

    def _held(self) -> Iterator[tuple[Location, Reference]]:
        """Yield the names of controllers that are held."""
        for name in filter(None, self._holds()):
            yield ("hold", name), Reference("controller", name, self.controllers)

    def _untimed(self) -> Iterator[tuple[Location, str]]:
        for name, time in self._holds().items():
            if time.unit != "s":
                yield ("hold", *filter(None, [name])), time.text

    def _chattering(self) -> Iterator[tuple[Location, tuple[str, int, int]]]:
        """Yield controllers that may be left as soon as they are entered, with the switches."""
        # Nothing can be computed of an undeclared signal.
        for name in () if any(self._unsaid()) else self.controllers:
            apart = self.tightest(name)
            if apart is not None and self.stay(name) is None:
                yield ("switches", apart.leaving), (name, apart.entering + 1, apart.leaving + 1)

    checks = (
        refuse(
            _unsaid,
            "nothing is said of the signal {0}",
            "add `{0}: {{noise: ..., age: ..., largest_rate: ...}}` to signals",
        ),
        *each(
            _held, Row[Reference]("", Reference.is_lost, "no switch leads to or from {0}", "{1}")
        ),
        refuse(_untimed, "{0!r} is not a time", "write seconds, as in '50 ms'"),
        refuse(
            _chattering,
            "{0!r} may be left as soon as it is entered, so the controllers may chatter: no signal "
            "has to move between switch {1} and switch {2} of the list",
            "let one of them ask for a signal above, the other for the same signal below, further "
            "apart than twice its noise and what it moves in its age; or add "
            "`hold: {{{0}: 50 ms}}`",
        ),
    )

    @property
    def controllers(self) -> tuple[str, ...]:
        """Names of the controllers in the order in which they are named."""
        ends = (name for switch in self.switches for name in (switch.source, switch.target))
        return tuple(dict.fromkeys((self.start, *ends)))

    def pairs(self, controller: str) -> Iterator[SwitchSeparation]:
        """Yield the distance between every switch to a controller and every switch from it."""
        for i, entering in enumerate(self.switches):
            for j, leaving in enumerate(self.switches):
                if entering.target == controller == leaving.source:
                    yield self._apart(i, j)

    def tightest(self, controller: str) -> SwitchSeparation | None:
        """Return the two switches with the least time between; None if no such two are there."""
        return min(self.pairs(controller), key=lambda apart: apart.seconds, default=None)

    def derived(self, controller: str) -> DwellTime | None:
        """Return the least time by thresholds, noise and age, rounded down; None without one."""
        apart = self.tightest(controller)
        return None if apart is None or apart.seconds <= 0 else shown_time(apart.seconds)

    def stay(self, controller: str) -> DwellTime | None:
        """Return for how long the timer holds a controller."""
        held = self.hold.get(controller) if isinstance(self.hold, dict) else self.hold
        times = [time for time in (held, self.derived(controller)) if time is not None]
        return max(times, key=lambda time: time.value, default=None)

    def held_back(self, controller: str) -> Fraction:
        """Return for how long the timer may keep a switch from being made, in s."""
        stay, derived = self.stay(controller), self.derived(controller)
        if stay is None:
            return Fraction(0)
        return stay.value - (Fraction(0) if derived is None else derived.value)

    def rules(self) -> SwitchingSpec:
        """Return the switching signals that the logic can give."""
        stays = {name: stay for name in self.controllers if (stay := self.stay(name)) is not None}
        pairs = dict.fromkeys((switch.source, switch.target) for switch in self.switches)
        return SwitchingSpec(dwell_time=stays or None, transitions=tuple(pairs))

    def _apart(self, i: int, j: int) -> SwitchSeparation:
        entering, leaving = self.switches[i].conditions, self.switches[j].conditions
        best = SwitchSeparation(i, j, None, Fraction(0))
        for name in entering.keys() & leaving.keys():
            if ends := _opposed(entering[name], leaving[name]):
                seconds = _least_time(*ends, getattr(self.signals, name))
                best = max(best, SwitchSeparation(i, j, name, seconds), key=lambda b: b.seconds)
        return best


def _opposed(entering: Condition, leaving: Condition) -> tuple[Quantity, Quantity] | None:
    """Return the upper and the lower threshold of two conditions on opposite sides."""
    if entering.above is not None and leaving.below is not None:
        return entering.above, leaving.below
    if entering.below is not None and leaving.above is not None:
        return leaving.above, entering.below
    return None


def _least_time(high: Quantity, low: Quantity, signal: SignalSpec) -> Fraction:
    """Return ``(high - low - 2 N)/R - D``, or less where powers of pi do not cancel."""
    noise, rate = signal.noise, signal.largest_rate
    if len({q.pi_power for q in (high, low, noise, rate) if q.value}) <= 1:
        band = high.rational_part - low.rational_part - 2 * noise.rational_part
        return band / rate.rational_part - signal.age.exact
    band = max(Fraction(0), high.not_above - low.not_below - 2 * noise.not_below)
    return band / rate.not_below - signal.age.exact


def shown_time(seconds: Fraction) -> DwellTime:
    """Return a time in a few digits that is not longer."""
    value = Fraction(lower(seconds, DIGITS))
    return DwellTime(f"{exact_text(value)} s", value, "s")


def values_at_switch(logic: ThresholdLogicSpec, switch: LogicSwitchSpec) -> Mapping[str, float]:
    """Return the largest change of the true value of each signal until a switch is made.

    That is where its condition is the last one to come true: the threshold, the noise, and what the
    signal moves in its age and while the timer holds the switch back.
    """
    found = {}
    for name, condition in switch.conditions.items():
        signal: SignalSpec = getattr(logic.signals, name)
        late = signal.age.exact + logic.held_back(switch.source)
        beyond = signal.noise.not_below + signal.largest_rate.not_below * late
        if condition.above is not None:
            found[name] = upper_float(condition.above.not_below + beyond)
        elif condition.below is not None:
            found[name] = lower_float(condition.below.not_above - beyond)
    return found
