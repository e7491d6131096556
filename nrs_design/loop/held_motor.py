"""What a motor does over a period under commands that are held, each for a part of it.

With ``tau omega' = Km u - omega`` and the command u changing from ``u0`` by ``c_j`` when a time h_j
is left of a period of length T,

    omega+ = omega - g s(T) omega + Km g (s(T) u0 + sum_j s(h_j) c_j),
    delta+ = delta + s(T) omega + Km ((T - s(T)) u0 + sum_j (h_j - s(h_j)) c_j),

where ``g = 1/tau`` and ``s(h) = (1 - exp(-g h)) / g``. This is affine in Km, in g, and in each h_j
and s(h_j), one after the other (docs/certificates/time-inside-the-period.md).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from math import ceil

from nrs_design.loop.command_timing import CommandTiming
from nrs_design.loop.parameter_box import Box
from nrs_design.loop.sampled_motor import motor_box, way_between, way_unit
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.drive import OMEGA, Drive
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.proof.taylor import exponential_between

ONE, ZERO = Fraction(1), Fraction(0)
# Symbols of a motor at the ends of its ranges.
GAIN, TIME_CONSTANT = "Km", "tau"
# A result beside the states: how far the joint goes in a period.
WAY = "way"


@dataclass(frozen=True, slots=True)
class Commands:
    """What acts on a motor over a period, as linear forms; each object is made once."""

    __eq__, __hash__ = object.__eq__, object.__hash__

    # states, place: its states when the period begins, the speed first, and its deflection then.
    states: tuple[LinearForm, ...]
    place: LinearForm
    first: LinearForm  # The command that is then in force, less friction
    # By how much the command changes within the period, the oldest command first.
    changes: tuple[LinearForm, ...] = ()

    @property
    def omega(self) -> LinearForm:
        """Its speed."""
        return self.states[0]


@dataclass(frozen=True, slots=True)
class HeldMotor(ABC):
    """A motor over a period, and where its numbers lie."""

    __eq__, __hash__ = object.__eq__, object.__hash__

    box: Box

    @property
    def drive(self) -> Drive | None:
        """What it is, if that is no motor."""
        return None

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units of its states, the speed first and the deflection left out."""
        return (OMEGA,)

    @property
    def attained(self) -> frozenset[str]:
        """The symbols whose ends, together, are those of some motor; the others only enclose it."""
        return frozenset({"Km"})

    @abstractmethod
    def points(self) -> Iterator[tuple[tuple[str, ...], HeldMotor]]:
        """Yield motors that there are, at the ends of the ranges, with the labels of each."""

    @abstractmethod
    def result(self, name: str, given: Commands, values: Mapping[str, Fraction]) -> LinearForm:
        """Return a state after the period, or how far the joint goes in it (`WAY`)."""

    def touching(self, touched: Mapping[str, Interval], *, forced: bool) -> HeldMotor:
        """Return the motor while it touches something: by default, that does not act on it."""
        return self


@dataclass(frozen=True, slots=True, eq=False)
class MotorAtOnce(HeldMotor):
    """Under one command, by ``E = exp(-T/tau)`` and ``s = tau (1 - E)``."""

    ranges: ActuatorRanges
    period: Fraction  # The T in s
    time_constant: Fraction | None  # The tau in s, if it is known: s is then left out

    @classmethod
    def of(cls, ranges: ActuatorRanges, period: Fraction) -> MotorAtOnce:
        """Return the motors of some ranges, which last for a period."""
        tau = ranges.time_constant
        known = tau.nominal if tau.low == tau.high else None
        return cls(motor_box(ranges, period), ranges, period, known)

    def points(self) -> Iterator[tuple[tuple[str, ...], HeldMotor]]:
        """Yield motors that there are, at the ends of the ranges, with the labels of each."""
        for labels, at in _ends_of(self.ranges):
            yield labels, MotorAtOnce.of(at, self.period)

    def result(self, name: str, given: Commands, values: Mapping[str, Fraction]) -> LinearForm:
        """Return the speed after the period, or how far the joint turns in it."""
        return self._way(given, values) if name == WAY else self._speed(given, values)

    def _speed(self, given: Commands, values: Mapping[str, Fraction]) -> LinearForm:
        E = values["E"]
        return combine((E, given.omega), (values["Km"] * (1 - E), given.first))

    def _way(self, given: Commands, values: Mapping[str, Fraction]) -> LinearForm:
        tau = self.time_constant
        s = values["s"] if tau is None else tau * (1 - values["E"])
        return combine((s, given.omega), (values["Km"] * (self.period - s), given.first))


@dataclass(frozen=True, slots=True, eq=False)
class MotorInTime(HeldMotor):
    """Under commands that take effect within the period, or for periods of several lengths."""

    ranges: ActuatorRanges
    timing: CommandTiming
    spans: tuple[RestOfPeriod, ...]  # The period, and what is left of it from each change on

    @classmethod
    def of(cls, ranges: ActuatorRanges, timing: CommandTiming) -> MotorInTime:
        """Return the motors of some ranges, which last for a period."""
        tau = ranges.time_constant
        g = Interval(1 / tau.nominal, 1 / tau.high, 1 / tau.low)
        later = (RestOfPeriod.of(timing.left(age), g, str(age)) for age in timing.within)
        spans = (RestOfPeriod.of(timing.steps, g), *later)
        ranged = {name: ends for span in spans for name, ends in span.ranges.items()}
        return cls(Box({"Km": ranges.gain, "g": g, **ranged}), ranges, timing, spans)

    def points(self) -> Iterator[tuple[tuple[str, ...], HeldMotor]]:
        """Yield motors that there are, at the ends of the ranges, with the labels of each."""
        for labels, at in _ends_of(self.ranges):
            for times, timing in self.timing.points():
                yield (*labels, *times), MotorInTime.of(at, timing)

    def result(self, name: str, given: Commands, values: Mapping[str, Fraction]) -> LinearForm:
        """Return the speed after the period, or how far the joint turns in it."""
        return self._way(given, values) if name == WAY else self._speed(given, values)

    def _speed(self, given: Commands, values: Mapping[str, Fraction]) -> LinearForm:
        whole, *ways = (span.at(values)[1] for span in self.spans)
        Km, g = values["Km"], values["g"]
        changes = zip(ways, given.changes, strict=True)
        return combine(
            (1 - g * whole, given.omega),
            (Km * g * whole, given.first),
            *((Km * g * s, change) for s, change in changes),
        )

    def _way(self, given: Commands, values: Mapping[str, Fraction]) -> LinearForm:
        (T, whole), *later = (span.at(values) for span in self.spans)
        Km, changes = values["Km"], zip(later, given.changes, strict=True)
        return combine(
            (whole, given.omega),
            (Km * (T - whole), given.first),
            *((Km * (h - s), change) for (h, s), change in changes),
        )


@dataclass(frozen=True, slots=True)
class RestOfPeriod:
    """A time h until the end of a period, and ``s(h)`` for all motors.

    Where the time has a range, ``s(h) = low + slope (h - shortest) + r`` with r in a range: s is
    concave in h, so it is above the chord of the fastest motor, and below tangents of the slowest.
    """

    # Symbols of the time, and of the way or what the way is above the chord.
    symbols: tuple[str, str]
    time: Interval  # The h in s
    rest: Interval  # Range of s(h) in s for a time that is known; else of the r
    low: Fraction = ZERO
    slope: Fraction = ZERO

    @classmethod
    def of(cls, time: Interval, rate: Interval, age: str = "") -> RestOfPeriod:
        """Enclose the ways of motors, for a time h in s and rates g in 1/s.

        `age` is that of the command that is in force for so long; empty for the whole period.
        """
        first, above = way_between(time.low, rate)
        last, beyond = way_between(time.high, rate)
        length, name = time.high - time.low, f"h{age}" if age else "T"
        if not length:
            return cls((name, f"s{age}"), time, Interval(first, first, above))
        slope = (last - first) / length
        _, steep = exponential_between(-time.low * rate.low)
        flat, _ = exponential_between(-time.high * rate.low)
        # Two lines that are not below s, as far as they are above the chord at both ends.
        rising = above - first, above - first + (steep - slope) * length
        falling = beyond - last + (slope - flat) * length, beyond - last
        unit = way_unit(time.high, rate)
        highest = ceil(_highest(rising, falling) / unit) * unit
        return cls((name, f"r{age}"), time, Interval(ZERO, ZERO, highest), first, slope)

    @property
    def ranges(self) -> dict[str, Interval]:
        """Where its numbers lie, by their symbols."""
        return {
            symbol: interval
            for symbol, interval in zip(self.symbols, (self.time, self.rest), strict=True)
            if interval.low < interval.high
        }

    def at(self, values: Mapping[str, Fraction]) -> tuple[Fraction, Fraction]:
        """Return the time and the way."""
        name, rest = self.symbols
        time = values.get(name, self.time.nominal)
        return time, self.low + self.slope * (time - self.time.low) + values.get(
            rest, self.rest.nominal
        )


def _highest(rising: tuple[Fraction, Fraction], falling: tuple[Fraction, Fraction]) -> Fraction:
    """Return the most of the lesser of two lines over a stretch, given at its ends."""
    highest = max(map(min, zip(rising, falling, strict=True)))
    ends = (rising[0] - falling[0], rising[1] - falling[1])
    if ends[0] >= 0 or ends[1] <= 0:
        return highest
    # Where they cross is the top only if one of them rises and the other falls.
    crossing = rising[0] + (rising[1] - rising[0]) * ends[0] / (ends[0] - ends[1])
    return max(highest, crossing)


def _ends_of(ranges: ActuatorRanges) -> Iterator[tuple[tuple[str, ...], ActuatorRanges]]:
    """Yield the motors at the ends of ranges, with the labels of those that are not known."""
    for (first, gain), (last, tau) in product(ranges.gain.ends, ranges.time_constant.ends):
        named = ((GAIN, first), (TIME_CONSTANT, last))
        labels = tuple(f"{symbol}-{end}" for symbol, end in named if end)
        yield labels, replace(ranges, gain=Interval.point(gain), time_constant=Interval.point(tau))


def hold(ranges: ActuatorRanges, timing: CommandTiming) -> HeldMotor:
    """Return the motors of some ranges, which last for a period, under commands that are held."""
    if not timing.within and not timing.jitter:
        return MotorAtOnce.of(ranges, timing.period)
    return MotorInTime.of(ranges, timing)
