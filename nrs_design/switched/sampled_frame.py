"""What one period does to the state of a sampled loop, exactly.

The actuator holds the command between samples and is not loaded by the tissue, so the stiffness
enters through the force sample alone: every entry is affine in it, and a stiffness that moves at
will is covered by its ends. State: ``[e, omega, e_before, vm, w, F_1, ..., F_d, delta]`` with the
error e of the motion loop, its value a period ago, the velocity vm of the admittance (absent
without inertia), the integral w of a PI force controller (absent without one), the lags of a
filter, the force samples on their way, and the deflection. Beside position and force controllers,
the reference of the impedance controllers stands in the place of e; without impedance controllers,
there is neither it nor vm. Where the admittance runs more often than the motion loop, the command u
that is held stands after e_before.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from functools import lru_cache
from itertools import chain, takewhile
from typing import TypeVar

from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.controllers.parts import StepPart
from nrs_design.controllers.step_analysis import rounding_share
from nrs_design.controllers.step_law import StepFrame, numbers_in_force, step_parts
from nrs_design.models.drive import OMEGA, Takes
from nrs_design.models.linear_form import ZERO, LinearForm, combine, coordinates, zero
from nrs_design.switched.command_timing import CommandTiming
from nrs_design.switched.held_motor import WAY, Commands, HeldMotor
from nrs_design.switched.sampled_law import (
    ERROR,
    IDLE_REFERENCE,
    IDLE_VELOCITY,
    KD,
    KEPT,
    KP,
    ONE,
    STEP,
    ListedLaw,
    RoundedStep,
    kinds_of,
    list_law,
    second,
    short,
)

# The error of motion of a sample ago, and the reference of impedance controllers alone, in whose
# place the error of motion is a state.
BEFORE, ALONE = "error_before", "reference"
# States of every frame, and that of a command which outlasts a sample.
DELTA, HELD = "delta [rad]", "u held"
# What the measured angle is the sum of, and an input.
MEASURED = (DELTA, "encoder error", "rounding of the angle")
REFERENCE = "rounding of the reference"
# By how much the command is less than what the law makes of the sample, where a driver limits it.
CUT_OFF = "cut off from the command"
# What acts on a frame from outside, in this order.
INPUTS = (
    "velocity command",
    "friction",
    "encoder error",
    "force error",
    REFERENCE,
    "rounding of the angle",
    CUT_OFF,
)

T = TypeVar("T")
# Those of a motor, by their symbols.
Numbers = tuple[tuple[str, Fraction], ...]


class Turn(StrEnum):
    """What a processor with two periods computes at a sample."""

    BOTH = "both"
    MOTION = "motion"
    ADMITTANCE = "admittance"
    # Its deadline is missed: nothing is computed, and the drive is held, or told to stand still.
    HELD = "miss, held"
    ZEROED = "miss, zeroed"

    @property
    def is_miss(self) -> bool:
        """Whether a deadline is missed."""
        return self in (Turn.HELD, Turn.ZEROED)


@dataclass(frozen=True, slots=True)
class Frame:
    """What all modes of a sampled loop share."""

    # Asked for at every corner of every box, and made once for a loop.
    __eq__, __hash__ = object.__eq__, object.__hash__

    # From one sample to the next, of two periods the shorter one, and when commands take effect.
    timing: CommandTiming
    # What turns commands into motion.
    motor: HeldMotor
    # The motion controller, and the filter through which the laws get the force samples.
    step: StepFrame
    # Of all controllers, with the numbers that ship.
    laws: tuple[DiscreteLaw, ...]
    # How many force samples are on their way at most.
    longest_delay: int
    # What a period leaves of the states of laws that are not active; None where all laws are alike.
    idle: Fraction | None = None
    # What is computed at the samples of a round.
    turns: tuple[Turn, ...] = (Turn.BOTH,)

    @property
    def period(self) -> Fraction:
        """From one sample to the next in s."""
        return self.timing.period

    @property
    def roundings(self) -> dict[str, Fraction]:
        """What the arithmetic changes of every term of the law at most, over its size."""
        counts = self.counts
        shares = {name: short(rounding_share(count)) for name, count in counts.items()}
        again = {second(name): short(shares[KD] * shares[name]) for name in self._placing}
        return shares | again

    @property
    def counts(self) -> dict[str, int]:
        """How often each term of the law is rounded, as a certificate lists them."""
        counts = self.listed.all_counts
        first = (ERROR, KP, KD, KEPT)
        last = (STEP, IDLE_REFERENCE, IDLE_VELOCITY, *self._placing)
        others = [name for name in counts if name not in (*first, *last)]
        return {name: counts[name] for name in (*first, *others, *last) if name in counts}

    @property
    def listed(self) -> ListedLaw:
        """The list of operations of the law."""
        return list_law(self.step.order, kinds_of(self.laws), self.step.takes)

    @property
    def _placing(self) -> tuple[str, ...]:
        """The terms of a reference that is computed within a sample."""
        each = (results.get("error", {}) for results in self.listed.counts.values())
        names = dict.fromkeys(name for reference in each for name in reference)
        return tuple(name for name in names if name != ERROR)

    @property
    def remembers(self) -> bool:
        """Whether a force sample outlasts its period."""
        return self.longest_delay > 0 or self.step.low_pass is not None

    @property
    def holds(self) -> bool:
        """Whether the command outlasts a sample, and no command of before is a state anyway."""
        return Turn.ADMITTANCE in self.turns or (Turn.HELD in self.turns and not self._sent)

    @property
    def stored(self) -> dict[str, str]:
        """The states of the law, by name: as modes call them."""
        return {value.name: value.stored for value in self.listed.law.states if value.stored}

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units of the states."""
        place, others = _around(self.stored)
        ages = (f"F {j} before [N*m]" for j in range(1, self.longest_delay + 1))
        kept = [self.stored[BEFORE]] if BEFORE in self.stored else []
        motion = (*self.motor.states, *kept, *((HELD,) if self.holds else ()), *self._sent)
        return (*place, *motion, *others, *ages, DELTA)

    @property
    def samples_and_lags(self) -> tuple[str, ...]:
        """The states that show a force later: samples on their way, and the lags of its filter."""
        samples = (f"F {j} before [N*m]" for j in range(1, self.longest_delay + 1))
        lags = (text for name, text in self.stored.items() if name.startswith("filtered_"))
        return (*samples, *lags)

    @property
    def _sent(self) -> tuple[str, ...]:
        """The commands of samples before, the last one first, as far as they are not in force."""
        return tuple(f"u {age} before" for age in range(1, self.timing.oldest + 1))

    @property
    def _placed(self) -> bool:
        """Whether commands are positions: as states they count from the deflection."""
        return self.step.takes is Takes.POSITION

    def rows(
        self,
        law: DiscreteLaw,
        delay: int,
        values: Mapping[str, Fraction],
        turn: Turn = Turn.BOTH,
    ) -> list[LinearForm]:
        """Return the map of one period, below it the size of each rounding, and the command.

        The first rows lead from the states, the `INPUTS` and the `roundings` to the next states; a
        rounding error is at most the size that its row below gives. The last row is the command
        before it is cut off. `delay` is the age of the force sample; `values` are the numbers of
        the motor, as its box names them, and in contact the stiffness ``k`` and the damping ``b``
        that the force sample shows. What `turn` does not compute holds what it had.
        """
        contact = values.get("k", ZERO), values.get("b", ZERO)
        # An older sample is a state, whatever is touched now.
        seen = contact if delay == 0 else (ZERO, ZERO)
        made = _sample(self, law, delay, seen, turn)
        ages = [*([] if turn is Turn.MOTION else [_force(self, *contact)]), *made.at.samples]
        _, others = _around(made.after)
        needed = {name: self.motor.symbols_of(name) for name in (*self.motor.states, WAY)}
        taken = {
            name: tuple((symbol, value) for symbol, value in values.items() if symbol in symbols)
            for name, symbols in needed.items()
        }
        reference, delta = _place(made, self.motor, taken.pop(WAY))
        return [
            *reference,
            *(_state(made, self.motor, name, numbers) for name, numbers in taken.items()),
            *([made.after[BEFORE]] if BEFORE in made.after else []),
            *(self._counted(made.sent[0], delta) if self.holds else ()),
            *chain.from_iterable(self._counted(u, delta) for u in made.sent[:-1]),
            *others,
            *ages[: self.longest_delay],
            delta,
            *made.sizes,
            made.drive,
        ]

    def _counted(self, u: LinearForm, delta: LinearForm) -> Iterator[LinearForm]:
        """Yield a command as a state: a position counts from the deflection after the period."""
        yield combine((ONE, u), (-ONE, delta)) if self._placed else u

    def command(self) -> tuple[LinearForm, Sequence[LinearForm]]:
        """Return the command of the motion loop, and how large each rounding in it is at most.

        Both are forms of the states, the `INPUTS` and the `roundings`, for laws that change the
        reference after the command: it is then the same under each.
        """
        shares, at, _ = _beginning(self)
        nothing = zero(len(at[DELTA]))
        step = self._step(self.laws[0], nothing)
        sizes = step.motion_sizes()
        return step.command(nothing), [sizes.get(name, nothing) for name in shares]

    def _step(self, law: DiscreteLaw, force: LinearForm) -> RoundedStep:
        """Return what the law makes of a sample of the force."""
        shares, at, parts = _beginning(self)
        given = {
            **at.states,
            "angle": combine(
                *((ONE, at[n]) for n in (DELTA, "encoder error", "rounding of the angle"))
            ),
            "torque": force,
            "velocity_command": at["velocity command"],
        }
        if law.law.commands == "position":
            # It is rounded as it is read, the reference of an admittance as it moves.
            given["position"] = at[REFERENCE]
        numbers = self.step.numbers | numbers_in_force(law, parts, self.idle)
        terms = self.listed.terms(law, numbers, given, at.rounded)
        return RoundedStep(self.listed, law, numbers, at.rounded, shares, terms)


@dataclass(frozen=True, slots=True)
class _Sample:
    """What a sample makes of a state, before the motor moves; and how large roundings are."""

    # Each is made once.
    __eq__, __hash__ = object.__eq__, object.__hash__

    after: Mapping[str, LinearForm]
    drive: LinearForm  # The command of this sample before it is cut off
    sizes: Sequence[LinearForm]
    at: _Signals
    sent: Sequence[LinearForm]  # What is sent of it, and after it the commands of samples before
    given: Commands


# Corners of the motor's ranges share what the law makes of one stiffness.
@lru_cache(maxsize=64)
def _sample(
    frame: Frame,
    law: DiscreteLaw,
    delay: int,
    contact: tuple[Fraction, Fraction],
    turn: Turn,
) -> _Sample:
    """Return what `Frame.rows` knows before the motor's parameters."""
    shares, at, _ = _beginning(frame)
    step = frame._step(law, at.samples[delay - 1] if delay else _force(frame, *contact))
    nothing = zero(len(at[DELTA]))
    after, drive = dict(at.states), at.forms.get(HELD, nothing)
    if turn.is_miss:
        # Of commands that are on their way, the newest is sent again.
        held = at[HELD if frame.holds else frame._sent[0]] if turn is Turn.HELD else nothing
        return _made(frame, after, held, nothing, [nothing for _ in shares], at)
    cut = at[CUT_OFF] if turn is not Turn.ADMITTANCE else nothing
    sizes: dict[str, LinearForm] = {}
    following = frame.listed.following
    if turn is not Turn.ADMITTANCE:
        drive = step.command(nothing)
        if frame._placed:
            drive = combine((ONE, drive), (ONE, at[REFERENCE]))
        if not frame.step.streams:
            after[BEFORE] = step.result(following.pop(BEFORE), nothing)
            sizes |= step.motion_sizes()
    following.pop(BEFORE, None)
    if turn is not Turn.MOTION:
        after |= {name: step.result(made, nothing) for name, made in following.items()}
        moved = (ONE if law.law.commands == "velocity" else ZERO, at[REFERENCE])
        after |= {name: combine((ONE, after[name]), moved) for name in _places(after)}
        sizes |= step.other_sizes()
    return _made(frame, after, drive, cut, [sizes.get(name, nothing) for name in shares], at)


def _made(
    frame: Frame,
    after: Mapping[str, LinearForm],
    drive: LinearForm,
    cut: LinearForm,
    sizes: Sequence[LinearForm],
    at: _Signals,
) -> _Sample:
    """Return what a sample makes of a state, with the commands that act in its period."""
    sent = [combine((ONE, drive), (ONE, cut)), *(at[name] for name in frame._sent)]
    ages = frame.timing.within
    given = Commands(
        tuple(at[name] for name in frame.motor.states),
        at[DELTA],
        combine((ONE, sent[-1]), (ONE, at["friction"])),
        tuple(combine((ONE, sent[age]), (-ONE, sent[age + 1])) for age in ages),
    )
    return _Sample(after, drive, sizes, at, sent, given)


@lru_cache(maxsize=64)
def _force(frame: Frame, k: Fraction, b: Fraction) -> LinearForm:
    """Return the force sample of a spring and a damper beside it."""
    _, at, _ = _beginning(frame)
    return combine((k, at[DELTA]), (b, at[OMEGA]), (ONE, at["force error"]))


# Corners share what does not depend on all of their numbers: as one object, so that they are known
# to be alike.
@lru_cache(maxsize=256)
def _state(made: _Sample, motor: HeldMotor, name: str, numbers: Numbers) -> LinearForm:
    return motor.result(name, made.given, dict(numbers))


@lru_cache(maxsize=256)
def _place(
    made: _Sample, motor: HeldMotor, numbers: Numbers
) -> tuple[list[LinearForm], LinearForm]:
    """Return the reference, if any, or the error of it, and the deflection after the period."""
    delta = combine((ONE, made.at[DELTA]), (ONE, motor.result(WAY, made.given, dict(numbers))))
    if ALONE in made.after:
        return [combine((ONE, made.after[ALONE]), (-ONE, delta))], delta
    return _around(made.after)[0], delta


def _places(states: Collection[str]) -> list[str]:
    """Return the reference among the states of a law, which comes before all others, or nothing."""
    if BEFORE not in states:
        return [ALONE] if ALONE in states else []
    return [*takewhile(lambda name: name != BEFORE, states)]


def _around(states: Mapping[str, T]) -> tuple[list[T], list[T]]:
    """Return the reference among the states of a law, if any, and what is behind the error."""
    place = _places(states)
    return [states[n] for n in place], [states[n] for n in states if n not in (*place, BEFORE)]


@dataclass(frozen=True, slots=True)
class _Signals:
    """The forms of the states, inputs and roundings of a frame."""

    # Those of the law, by name.
    states: Mapping[str, LinearForm]
    # All states and inputs, by name; the oldest force sample last.
    forms: Mapping[str, LinearForm]
    samples: Sequence[LinearForm]
    rounded: Mapping[str, LinearForm]

    def __getitem__(self, name: str) -> LinearForm:
        return self.forms[name]

    @classmethod
    def of(cls, frame: Frame, shares: Sequence[str]) -> _Signals:
        names = (*frame.states, *INPUTS)
        unit = coordinates(len(names) + len(shares))
        forms = dict(zip(names, unit, strict=False))
        positions = (*frame._sent, *([HELD] if frame.holds else [])) if frame._placed else ()
        for name in positions:
            forms[name] = combine((ONE, forms[name]), (ONE, forms[DELTA]))
        states = {name: forms[text] for name, text in frame.stored.items()}
        if ALONE in states:
            states[ALONE] = combine((ONE, states[ALONE]), (ONE, forms[DELTA]))
        last = len(frame.states) - 1
        samples = unit[last - frame.longest_delay : last]
        return cls(states, forms, samples, dict(zip(shares, unit[len(names) :], strict=True)))


@lru_cache(maxsize=8)
def _beginning(
    frame: Frame,
) -> tuple[Mapping[str, Fraction], _Signals, tuple[StepPart, ...]]:
    """Return roundings, signals and parts of a frame, which all its corners and delays share."""
    shares = frame.roundings
    return shares, _Signals.of(frame, tuple(shares)), step_parts(frame.laws)
