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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from functools import lru_cache

from nrs_design.controllers.sampled import (
    SampledAdmittance,
    SampledLaw,
    SampledMotion,
    rounding_share,
)
from nrs_design.controllers.sensor import SampledLowPass
from nrs_design.controllers.step_law import numbers_of
from nrs_design.controllers.step_parts import StepFrame
from nrs_design.models.linear_form import ZERO, LinearForm, combine, coordinates, zero
from nrs_design.switched.sampled_law import (
    ERROR,
    IDLE_REFERENCE,
    IDLE_VELOCITY,
    KD,
    KEPT,
    KP,
    ONE,
    STEP,
    Kinds,
    ListedLaw,
    list_law,
)
from nrs_design.switched.sampled_step import SampledStep, second, short

# What acts on a frame from outside, in this order.
INPUTS = (
    "velocity command",
    "friction",
    "encoder error",
    "force error",
    "rounding of the reference",
    "rounding of the angle",
)


class Turn(StrEnum):
    """What a processor with two periods computes at a sample."""

    BOTH = "both"
    MOTION = "motion"
    ADMITTANCE = "admittance"


@dataclass(frozen=True, slots=True)
class Frame:
    """What all modes of a sampled loop share."""

    # Asked for at every corner of every box, and made once for a loop.
    __eq__, __hash__ = object.__eq__, object.__hash__

    period: Fraction  # From one sample to the next in s; of two periods the shorter one
    motion: SampledMotion  # The motion controller
    has_inertia: bool  # Whether the admittances have a velocity of their own
    longest_delay: int  # Force samples on their way
    time_constant: Fraction | None  # The tau of the motor in s, if it is known
    low_pass: SampledLowPass | None = None  # Through which the law gets the force samples
    sprung: bool = False  # Whether an admittance has a spring
    integrates: bool = True  # Whether there are impedance controllers
    takes_force: bool = False  # Whether there are force controllers
    # What a period leaves of reference and velocity of the impedance controllers, where there are
    # other controllers, too.
    idle: Fraction | None = None
    # Whether the command of the motion loop outlasts a sample: there are some at which only the
    # admittance is computed.
    holds: bool = False
    gathers: bool = False  # Whether there are PI force controllers

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
        return list_law(
            Kinds(
                0 if self.low_pass is None else self.low_pass.order,
                self.has_inertia,
                self.sprung,
                moves=self.integrates,
                places=not self.integrates or self.idle is not None,
                takes_force=self.takes_force,
                gathers=self.gathers,
            )
        )

    @property
    def _placing(self) -> tuple[str, ...]:
        """The terms of a reference that is computed within a sample."""
        each = (results["error"] for results in self.listed.counts.values())
        names = dict.fromkeys(name for reference in each for name in reference)
        return tuple(name for name in names if name != ERROR)

    @property
    def remembers(self) -> bool:
        """Whether a force sample outlasts its period."""
        return self.longest_delay > 0 or self.low_pass is not None

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units of the states."""
        ages = (f"F {j} before [N*m]" for j in range(1, self.longest_delay + 1))
        inner = ("vm [rad/s]",) if self.has_inertia else ()
        first = ("e [rad]" if self.idle is None else "reference [rad]",) if self.integrates else ()
        sensed = () if self.low_pass is None else self.low_pass.states
        motion = ("omega [rad/s]", "e before [rad]", *(("u held",) if self.holds else ()))
        gathered = ("integral [rad]",) if self.gathers else ()
        return (*first, *motion, *inner, *gathered, *sensed, *ages, "delta [rad]")

    def rows(
        self,
        law: SampledLaw,
        delay: int,
        values: Mapping[str, Fraction],
        turn: Turn = Turn.BOTH,
    ) -> list[LinearForm]:
        """Return the map of one period, and below it how large each rounding is at most.

        Without the last of `rows_and_slip`.

        Parameters
        ----------
        law, delay, values, turn
            As there.
        """
        return self.rows_and_slip(law, delay, values, turn)[:-1]

    def rows_and_slip(
        self,
        law: SampledLaw,
        delay: int,
        values: Mapping[str, Fraction],
        turn: Turn = Turn.BOTH,
    ) -> list[LinearForm]:
        """Return the map of one period, and below it how large each rounding is at most.

        The first rows lead from the states, the `INPUTS` and the `roundings` to the next states;
        of a rounding, the size is at most that of its row below. The last row is the slip: by how
        much the speed is not the one that the motor comes to under its command.

        Parameters
        ----------
        law : SampledAdmittance or SampledForce
            Of the controller in force.
        delay : int
            Age of its force sample.
        values : mapping
            The gain ``Km``, ``E = exp(-T/tau)``, and ``s = tau (1 - E)`` unless tau is known; in
            contact the stiffness ``k`` and the damping ``b`` that the force sample shows; other
            names say where the law itself is in a range.
        turn : Turn
            What is computed; the rest holds what it had.
        """
        contact = values.get("k", ZERO), values.get("b", ZERO)
        # An older sample is a state, whatever is touched now.
        seen = contact if delay == 0 else (ZERO, ZERO)
        made = _sample(self, law, delay, seen, turn, retuned="a" in values)
        ages = [*([] if turn is Turn.MOTION else [_force(self, *contact)]), *made.at.samples]
        Km, E, tau = values["Km"], values["E"], self.time_constant
        s = values["s"] if tau is None else tau * (1 - E)
        reference, delta = _place(made, Km, s)
        return [
            *([reference] if self.integrates else []),
            _speed(made, Km, E),
            made.seen,
            *([made.drive] if self.holds else []),
            *made.velocity,
            *made.integral,
            *made.lags,
            *ages[: self.longest_delay],
            delta,
            *made.sizes,
            _slip(made, Km),
        ]

    def command(self, law: SampledLaw) -> tuple[LinearForm, Sequence[LinearForm]]:
        """Return the command of the motion loop, and how large each rounding in it is at most.

        Both are forms of the states, the `INPUTS` and the `roundings`, for an admittance: it
        changes the reference after the command.

        Parameters
        ----------
        law : SampledAdmittance or SampledForce
            Of the controller in force.
        """
        shares = self.roundings
        at = _Signals.of(self, tuple(shares))
        nothing = zero(len(at.delta))
        step = self._step(law, at, nothing, shares)
        sizes = step.motion_sizes()
        return step.command(nothing), [sizes.get(name, nothing) for name in shares]

    def _step(
        self, law: SampledLaw, at: _Signals, force: LinearForm, shares: Mapping[str, Fraction]
    ) -> SampledStep:
        """Return what the law makes of a sample of the force."""
        moves = isinstance(law, SampledAdmittance)
        # Beside one with a spring, an admittance may have none.
        numbers = {"Kt": Fraction(0)} | numbers_of(
            StepFrame(self.motion, self.low_pass), law, self.idle
        )
        given = {
            "angle": combine((ONE, at.delta), (ONE, at.encoder), (ONE, at.angle)),
            "torque": force,
            "velocity_command": at.command,
            "reference": at.reference,
            "offset": at.reference,
            "error_before": at.before,
            "velocity": at.velocity,
            "integral": at.integral,
            **{f"filtered_{i}": lag for i, lag in enumerate(at.lags, 1)},
        }
        # A commanded position is rounded as it is read, the reference of an admittance as it moves.
        given |= {} if moves else {"position": at.reference_rounding}
        return SampledStep.of(self.listed, law, numbers, given, at.rounded, shares)


@dataclass(frozen=True, slots=True)
class _Sample:
    """What a sample makes of a state, before the motor moves; and how large roundings are."""

    # Each is made once.
    __eq__, __hash__ = object.__eq__, object.__hash__

    frame: Frame
    reference: LinearForm
    seen: LinearForm
    drive: LinearForm
    velocity: Sequence[LinearForm]
    integral: Sequence[LinearForm]
    lags: Sequence[LinearForm]
    sizes: Sequence[LinearForm]
    at: _Signals
    taken: LinearForm


# Corners of the motor's ranges share what the law makes of one stiffness.
@lru_cache(maxsize=64)
def _sample(
    frame: Frame,
    law: SampledLaw,
    delay: int,
    contact: tuple[Fraction, Fraction],
    turn: Turn,
    *,
    retuned: bool,
) -> _Sample:
    """Return what `Frame.rows_and_slip` knows before the motor's parameters."""
    shares, at = _beginning(frame)
    force = at.samples[delay - 1] if delay else _force(frame, *contact)
    listed, step = frame.listed, frame._step(law, at, force, shares)
    following, nothing = listed.following, zero(len(at.delta))
    lags, velocity = [*at.lags], [at.velocity] if frame.has_inertia else []
    integral = [at.integral] if frame.gathers else []
    seen, drive, reference = at.before, at.drive, at.reference
    sizes: dict[str, LinearForm] = {}
    if turn is not Turn.ADMITTANCE:
        seen = step.result(following["error_before"], nothing)
        drive = step.command(nothing)
        sizes |= step.motion_sizes()
    if turn is not Turn.MOTION:
        after = {name: step.result(made, nothing) for name, made in following.items()}
        lags = [after[f"filtered_{i}"] for i in range(1, len(lags) + 1)]
        velocity = [after["velocity"] for _ in velocity]
        integral = [after["integral"] for _ in integral]
        moves = isinstance(law, SampledAdmittance)
        reference = after.get("reference", after.get("offset", nothing))
        reference = combine((ONE, reference), (Fraction(moves), at.reference_rounding))
        sizes |= step.other_sizes(retuned=retuned)
    return _Sample(
        frame,
        reference,
        seen,
        drive,
        velocity,
        integral,
        lags,
        [sizes.get(name, nothing) for name in shares],
        at,
        combine((ONE, drive), (ONE, at.friction)),
    )


@lru_cache(maxsize=64)
def _force(frame: Frame, k: Fraction, b: Fraction) -> LinearForm:
    """Return the force sample of a spring and a damper beside it."""
    _, at = _beginning(frame)
    return combine((k, at.delta), (b, at.omega), (ONE, at.sensor))


# What the motor makes of the command less friction. Corners share what does not depend on all of
# its numbers: as one object, so that they are known to be alike.
@lru_cache(maxsize=256)
def _speed(made: _Sample, Km: Fraction, E: Fraction) -> LinearForm:
    return combine((E, made.at.omega), (Km * (1 - E), made.taken))


@lru_cache(maxsize=256)
def _place(made: _Sample, Km: Fraction, s: Fraction) -> tuple[LinearForm, LinearForm]:
    """Return the reference, or the error of it, and the deflection after the way of the motor."""
    frame, at = made.frame, made.at
    delta = combine((ONE, at.delta), (s, at.omega), (Km * (frame.period - s), made.taken))
    if frame.integrates and frame.idle is None:
        return combine((ONE, made.reference), (-ONE, delta)), delta
    return made.reference, delta


@lru_cache(maxsize=64)
def _slip(made: _Sample, Km: Fraction) -> LinearForm:
    return combine((ONE, made.at.omega), (-Km, made.taken))


# The inputs, as their forms are called below.
_FIELDS = ("command", "friction", "encoder", "sensor", "reference_rounding", "angle")


@dataclass(frozen=True, slots=True)
class _Signals:
    """The forms of the states, inputs and roundings of a frame."""

    reference: LinearForm
    omega: LinearForm
    before: LinearForm
    drive: LinearForm
    velocity: LinearForm
    integral: LinearForm
    lags: Sequence[LinearForm]
    samples: Sequence[LinearForm]
    delta: LinearForm
    command: LinearForm
    friction: LinearForm
    encoder: LinearForm
    sensor: LinearForm
    reference_rounding: LinearForm
    angle: LinearForm
    rounded: Mapping[str, LinearForm]

    @classmethod
    def of(cls, frame: Frame, shares: Sequence[str]) -> _Signals:
        names = frame.states
        size = len(names)
        unit = coordinates(size + len(INPUTS) + len(shares))
        left, delta, nothing = iter(unit[: size - 1]), unit[size - 1], zero(len(unit))
        first = next(left) if frame.integrates else nothing
        reference = first
        if frame.integrates and frame.idle is None:
            reference = combine((ONE, first), (ONE, delta))
        omega, before = next(left), next(left)
        drive = next(left) if frame.holds else nothing
        velocity = next(left) if frame.has_inertia else nothing
        integral = next(left) if frame.gathers else nothing
        order = 0 if frame.low_pass is None else frame.low_pass.order
        lags = [next(left) for _ in range(order)]
        inputs = dict(zip(_FIELDS, unit[size:], strict=False))
        rounded = dict(zip(shares, unit[size + len(INPUTS) :], strict=True))
        samples = [*left]
        return cls(
            reference,
            omega,
            before,
            drive,
            velocity,
            integral,
            lags,
            samples,
            delta,
            rounded=rounded,
            **inputs,
        )


@lru_cache(maxsize=8)
def _beginning(frame: Frame) -> tuple[Mapping[str, Fraction], _Signals]:
    """Return the roundings and the signals of a frame, which all its corners and delays share."""
    shares = frame.roundings
    return shares, _Signals.of(frame, tuple(shares))
