"""What one period does to the state of a sampled loop, exactly.

The actuator holds the command between samples and is not loaded by the tissue, so the stiffness
enters through the force sample alone: every entry is affine in it, and a stiffness that moves at
will is covered by its ends. State: ``[e, omega, e_before, vm, F_1, ..., F_d, delta]`` with the
error e of the motion loop, its value a period ago, the velocity vm of the admittance (absent
without inertia), the lags of a filter, the force samples on their way, and the deflection. Beside
position and force controllers, the reference of the impedance controllers stands in the place of
e; without impedance controllers, there is neither it nor vm. Where the admittance runs more often
than the motion loop, the command u that is held stands after e_before.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from fractions import Fraction
from itertools import chain
from math import ceil

from nrs_design.controllers.sampled import (
    FORCE_ROUNDINGS,
    ROUNDINGS,
    ROUNDINGS_WITHOUT_INERTIA,
    SampledAdmittance,
    SampledForce,
    SampledLaw,
    SampledMotion,
    Term,
    rounding_share,
)
from nrs_design.controllers.sensor import SampledLowPass
from nrs_design.models.linear_form import LinearForm, combine, coordinates, zero

ONE = Fraction(1)
# Binary digits of how large roundings are.
SIZE_BITS = 8
ERROR, KP, KD, FORCE, KEPT = "e", "Kp e", "D (e - e before)", "b F", "a vm"
STEP, IDLE_REFERENCE, IDLE_VELOCITY = "T (v - vm)", "d r", "d vm"
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
    """What all modes of a sampled loop share.

    Parameters
    ----------
    period : Fraction
        From one sample to the next in s; of two periods the shorter one.
    motion : SampledMotion
        The motion controller.
    has_inertia : bool
        Whether the admittances have a velocity of their own.
    longest_delay : int
        Force samples on their way.
    time_constant : Fraction or None
        The tau of the motor in s, if it is known.
    low_pass : SampledLowPass or None
        Through which the law gets the force samples.
    sprung : bool
        Whether an admittance has a spring.
    integrates : bool
        Whether there are impedance controllers.
    takes_force : bool
        Whether there are force controllers.
    idle : Fraction or None
        What a period leaves of reference and velocity of the impedance controllers, where there are
        other controllers, too.
    holds : bool
        Whether the command of the motion loop outlasts a sample: there are some at which only the
        admittance is computed.
    """

    period: Fraction
    motion: SampledMotion
    has_inertia: bool
    longest_delay: int
    time_constant: Fraction | None
    low_pass: SampledLowPass | None = None
    sprung: bool = False
    integrates: bool = True
    takes_force: bool = False
    idle: Fraction | None = None
    holds: bool = False

    @property
    def roundings(self) -> dict[str, Fraction]:
        """What the arithmetic changes of every term of the law at most, over its size."""
        shares = {name: _short(rounding_share(count)) for name, count in self.counts.items()}
        again = {term.name: _short(shares[KD] * shares[term.name]) for term in self._placing}
        return shares | {_again(name): share for name, share in again.items()}

    @property
    def counts(self) -> dict[str, int]:
        """How often each term of the law is rounded."""
        counts: dict[str, int] = {}
        plain = ROUNDINGS if self.has_inertia else ROUNDINGS_WITHOUT_INERTIA
        felt = self._felt([], [[]] * self._order)
        pushes = self._pushes(SampledAdmittance(None, ONE, ONE, ONE), felt[-1], [])
        for name, count in plain.items():
            if name == FORCE:
                terms = chain(*felt[1:], pushes if self.integrates else ())
                counts |= {term.name: term.roundings for term in terms}
            elif self.integrates or name in (ERROR, KP, KD):
                counts[name] = count
        if self.idle is not None:
            idle = (IDLE_REFERENCE, IDLE_VELOCITY) if self.has_inertia else (IDLE_REFERENCE,)
            counts |= dict.fromkeys(idle, 1)
        return counts | {term.name: term.roundings for term in self._placing}

    @property
    def remembers(self) -> bool:
        """Whether a force sample outlasts its period."""
        return self.longest_delay > 0 or self.low_pass is not None

    @property
    def _order(self) -> int:
        return 0 if self.low_pass is None else self.low_pass.order

    @property
    def _placing(self) -> tuple[Term, ...]:
        """The terms of a reference that force control computes."""
        if not self.takes_force:
            return ()
        return _placed(SampledForce(ONE), self._felt([], [[]] * self._order)[-1])

    def _felt(self, sample: LinearForm, lags: Sequence[LinearForm]) -> list[tuple[Term, ...]]:
        """Return the terms of the force sample and of each lag; the last is what a law takes."""
        # The sample is rounded when it is read.
        felt = (Term("F", sample, 1),)
        return [felt, *(() if self.low_pass is None else self.low_pass.stages(felt, lags))]

    def _pushes(
        self, law: SampledAdmittance, felt: tuple[Term, ...], pull: LinearForm
    ) -> tuple[Term, ...]:
        """Return the terms of what the force adds to the velocity."""
        if self.sprung:
            # The pull is a difference of references times Kt.
            felt = (*(term.times(ONE, "", 1) for term in felt), Term("Kt r", pull, 3))
        return tuple(term.times(law.b, "b ", 1 + self.has_inertia) for term in felt)

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units of the states."""
        ages = (f"F {j} before [N*m]" for j in range(1, self.longest_delay + 1))
        inner = ("vm [rad/s]",) if self.has_inertia else ()
        first = ("e [rad]" if self.idle is None else "reference [rad]",) if self.integrates else ()
        sensed = () if self.low_pass is None else self.low_pass.states
        motion = ("omega [rad/s]", "e before [rad]", *(("u held",) if self.holds else ()))
        return (*first, *motion, *inner, *sensed, *ages, "delta [rad]")

    def rows(
        self,
        law: SampledLaw,
        delay: int,
        values: Mapping[str, Fraction],
        turn: Turn = Turn.BOTH,
    ) -> list[LinearForm]:
        """Return the map of one period, and below it how large each rounding is at most.

        The first rows lead from the states, the `INPUTS` and the `roundings` to the next states;
        of a rounding, the size is at most that of its row below.

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
        at, shares = _Signals.of(self), self.roundings
        k, b = values.get("k", Fraction(0)), values.get("b", Fraction(0))
        ages = [combine((k, at.delta), (b, at.omega), (ONE, at.sensor)), *at.samples]
        felt = self._felt(ages[delay], at.lags)
        lags = [_sum_of(stage, at.rounded) for stage in felt[1:]]
        if turn is Turn.MOTION:
            kept = [at.velocity] if self.has_inertia else []
            answer = _Answer(at.reference, (), at.reference, kept)
            felt, lags, ages = [], [*at.lags], [*at.samples]
        elif isinstance(law, SampledAdmittance):
            answer = self._integrate(law, felt[-1], at, shares, retuned="a" in values)
        else:
            answer = self._place(law, felt[-1], at, shares)
        sizes = answer.sizes | {
            term.name: combine((shares[term.name], term.form)) for term in chain(*felt[1:])
        }
        if turn is Turn.ADMITTANCE:
            seen, drive = at.before, at.drive
        else:
            seen, drive = self._command(answer, at, shares, sizes)
        speed, moved = self._move(drive, at, values)
        delta = combine((ONE, at.delta), (ONE, moved))
        first = [answer.reference] if self.integrates else []
        if self.integrates and self.idle is None:
            first = [combine((ONE, answer.reference), (-ONE, delta))]
        nothing = zero(len(delta))
        return [
            *first,
            speed,
            seen,
            *([drive] if self.holds else []),
            *answer.velocity,
            *lags,
            *ages[: self.longest_delay],
            delta,
            *(sizes.get(name, nothing) for name in shares),
        ]

    def _integrate(
        self,
        law: SampledAdmittance,
        felt: tuple[Term, ...],
        at: _Signals,
        shares: Mapping[str, Fraction],
        *,
        retuned: bool,
    ) -> _Answer:
        """Return what an admittance does: its reference of the moment, and what comes of it."""
        # By how much the admittance has moved the reference is the reference itself.
        pushes = self._pushes(law, felt, combine((law.Kt, at.reference)))
        pushed, kept = combine(*((ONE, term.form) for term in pushes)), list[LinearForm]()
        velocity = exact = _sum_of(pushes, at.rounded)
        sizes: dict[str, LinearForm] = {}
        if law.a is None:
            exact = pushed
        else:
            inner = combine((law.a, at.velocity), (ONE, at.rounded[KEPT]))
            kept, velocity = [combine((ONE, inner), (ONE, exact))], at.velocity
            exact = velocity
            size = shares[KEPT] * law.a
            # Where the coefficient has a range, its corners suffice for what is affine in it.
            sizes[KEPT] = combine((size if retuned or not size else _short(size), at.velocity))
        step = combine((law.T, at.command), (-law.T, velocity), (ONE, at.rounded[STEP]))
        reference = combine((ONE, at.reference), (ONE, step), (ONE, at.reference_rounding))
        # Of a sum of two sizes, the part that is of second order counts with another term.
        beyond = ONE if kept else 1 + shares[STEP]
        sizes |= {t.name: combine((shares[t.name] * beyond, t.form)) for t in pushes}
        moving = combine((ONE, at.command), (-ONE, exact))
        sizes[STEP] = combine((_short(shares[STEP] * law.T), moving))
        return _Answer(at.reference, (), reference, kept, sizes)

    def _place(
        self,
        law: SampledForce,
        felt: tuple[Term, ...],
        at: _Signals,
        shares: Mapping[str, Fraction],
    ) -> _Answer:
        """Return what force or position control does, while the states of admittances are idle."""
        terms = _placed(law, felt) if law.Kp else ()
        placed = combine((ONE, at.reference_rounding), *((ONE, term.form) for term in terms))
        sizes: dict[str, LinearForm] = {}
        sizes |= {t.name: combine((shares[t.name], t.form)) for t in terms}
        if self.idle is None:
            return _Answer(placed, terms, [], [], sizes)
        left, kept = combine((self.idle, at.reference), (ONE, at.rounded[IDLE_REFERENCE])), []
        sizes[IDLE_REFERENCE] = combine((shares[IDLE_REFERENCE] * self.idle, at.reference))
        if self.has_inertia:
            kept = [combine((self.idle, at.velocity), (ONE, at.rounded[IDLE_VELOCITY]))]
            sizes[IDLE_VELOCITY] = combine((shares[IDLE_VELOCITY] * self.idle, at.velocity))
        return _Answer(placed, terms, left, kept, sizes)

    def _command(
        self,
        answer: _Answer,
        at: _Signals,
        shares: Mapping[str, Fraction],
        sizes: dict[str, LinearForm],
    ) -> tuple[LinearForm, LinearForm]:
        """Return the error that is seen, and the command, and add to the sizes."""
        Kp, D = self.motion.Kp, self.motion.D
        parts = ((ONE, answer.taken), (-ONE, at.delta), (-ONE, at.encoder), (-ONE, at.angle))
        read = combine(*parts)
        rounded = [at.rounded[ERROR], *(at.rounded[term.name] for term in answer.terms)]
        seen = combine((ONE, read), *((ONE, form) for form in rounded))
        drive = combine((Kp + D, seen), (-D, at.before))
        added = [KP, KD, *(_again(term.name) for term in answer.terms)]
        drive = combine((ONE, drive), *((ONE, at.rounded[name]) for name in added))
        # Of a sum of two sizes, the part that is of second order counts with another term.
        second = shares[KP] * Kp * (1 + shares[ERROR]) + shares[KD] * D * shares[ERROR]
        change = combine((ONE, read), (-ONE, at.before))
        sizes[ERROR] = combine((shares[ERROR], read))
        sizes[KP] = combine((_short(second), read))
        sizes[KD] = combine((_short(shares[KD] * D), change))
        for term in answer.terms:
            name = _again(term.name)
            sizes[name] = combine((shares[name] * (Kp + D), term.form))
        return seen, drive

    def _move(
        self, drive: LinearForm, at: _Signals, values: Mapping[str, Fraction]
    ) -> tuple[LinearForm, LinearForm]:
        """Return the speed and the way of the motor under a command, less friction."""
        Km, E, tau = values["Km"], values["E"], self.time_constant
        s = values["s"] if tau is None else tau * (1 - E)
        taken = combine((ONE, drive), (ONE, at.friction))
        moved = combine((s, at.omega), (Km * (self.period - s), taken))
        return combine((E, at.omega), (Km * (1 - E), taken)), moved


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
    def of(cls, frame: Frame) -> _Signals:
        names, shares = frame.states, frame.roundings
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
            lags,
            samples,
            delta,
            rounded=rounded,
            **inputs,
        )


@dataclass(frozen=True, slots=True)
class _Answer:
    """What a law makes of a sample.

    The reference that the motion loop takes now, the terms of which it is rounded; the next ones
    of the reference and of the velocity of impedance control, where there are such; sizes.
    """

    taken: LinearForm
    terms: tuple[Term, ...]
    reference: LinearForm
    velocity: Sequence[LinearForm]
    sizes: dict[str, LinearForm] = field(default_factory=dict)


def _placed(law: SampledForce, felt: tuple[Term, ...]) -> tuple[Term, ...]:
    return tuple(term.times(-law.Kp, "Kp ", FORCE_ROUNDINGS) for term in felt)


def _again(name: str) -> str:
    """Name the part of second order of what a term of the reference does to the command."""
    return f"u of {name}"


def _short(size: Fraction) -> Fraction:
    """Round a size up to a few binary digits, so that the numbers of a certificate stay short."""
    bits = size.numerator.bit_length() - size.denominator.bit_length()
    unit = Fraction(2) ** (bits - SIZE_BITS)
    return ceil(size / unit) * unit


def _sum_of(terms: Iterable[Term], rounded: Mapping[str, LinearForm]) -> LinearForm:
    """Return the sum of terms, each with what it is rounded by."""
    return combine(*((ONE, form) for t in terms for form in (t.form, rounded[t.name])))
