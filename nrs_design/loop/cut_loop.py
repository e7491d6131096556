"""The loop of one controller in one contact, cut where its law takes the force.

Where a spring draws the measured position, it is cut there, too: both enter the law at one place.

With the share g of the force that reaches the law, the characteristic polynomial of an assembled
mode is ``D + g N``: the force enters the law at one place, so its determinant is affine in g. D
is that of the mode with ``g = 0``, ``D + N`` that of the mode which is proved, and ``L = N/D`` the
open loop, whatever is in it. Exact; in continuous time polynomials in s, sampled in
``w = (2/T) (z - 1)/(z + 1)``, which is on the imaginary axis where z is on the unit circle: at
``(2/T) tan(omega T/2)``, near omega while that is small.

The determinant is also affine in the stiffness of the contact and, times Mt in continuous time, in
Mt, Bt and Kt; sampled in the coefficients a and b of the law. So a few modes give those of all
gains.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from itertools import product
from typing import TypeAlias

from nrs_design.axis import unit
from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import (
    Admittance,
    CompliantLaw,
    DiscreteLaw,
    ProportionalDerivative,
)
from nrs_design.controllers.sensor import LowPass, Sensor
from nrs_design.controllers.step_law import StepFrame
from nrs_design.loop.calendar import Calendar, CommandTiming, Turn
from nrs_design.loop.flow import HeldDrive
from nrs_design.loop.modes import ForceShare, position_mode, velocity_mode
from nrs_design.loop.parameter_box import Joint
from nrs_design.loop.program import SampledProgram
from nrs_design.loop.sampled import NOTHING, Contact, Rows, SampledLoop
from nrs_design.models.actuator import Actuator, ActuatorRanges
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.models.drive import GAIN, LOAD, Drive, Takes
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import LinearForm
from nrs_design.models.motion_loop import JointMotionLoop, Realization, realize
from nrs_design.models.plant import Plant
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.matrix import multiply as multiply_matrices
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.sampling import SamplingSpec

Polynomial = tuple[Fraction, ...]
ZERO, ONE = Fraction(0), Fraction(1)
# Decay and driving rate of the memory of a contact; None without memory.
Memory: TypeAlias = tuple[Fraction, Fraction] | None
REMEMBERED = "damper deflection [rad]"
_KEPT = 512
# Shares of the force that reach the law and a motor with a load.
_CLOSED, _OPENED, _FREE = ForceShare(), ForceShare(sensed=ZERO), ForceShare(ZERO, ZERO)


@dataclass(frozen=True, slots=True)
class Place:
    """Operating point of a loop, apart from contact and gains."""

    motor: Actuator  # Motor at a corner of its ranges, or the nominal motor
    age: int = 0  # Constant age of the force sample; zero in continuous time
    late: Fraction = ZERO  # From a sample to its command in s, always the same
    texts: tuple[str, ...] = ()  # Deviations from nominal; the age if there are several


@dataclass(frozen=True, slots=True)
class CutLoop:
    """Characteristic polynomials of one mode, highest power first, of one length."""

    opened: Polynomial  # Without force feedback to the law; the load of a motor remains
    closed: Polynomial  # Of the closed loop
    free: Polynomial  # Where the force does not act at all


@dataclass(frozen=True, slots=True)
class AbstractAxis(ABC):
    """One axis, from which the modes of each of its controllers follow."""

    places: tuple[Place, ...]

    @property
    @abstractmethod
    def period(self) -> Fraction | None:
        """Time between two force samples in s; None in continuous time."""

    @abstractmethod
    def cut(self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place) -> CutLoop:
        """Return the loop of a controller at fixed parameters of the contact and a place."""

    @abstractmethod
    def modes(
        self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place
    ) -> tuple[Sequence[LinearForm], Sequence[LinearForm]]:
        """Return the mode without the force in the law, and the one that is proved.

        They differ by one column times one row; sampled, they are steps.
        """

    @abstractmethod
    def admittances(
        self, contact: AbstractLinearLaw, spring: Fraction, place: Place, *, inert: bool
    ) -> tuple[CutLoop, CutLoop, CutLoop]:
        """Return the loops of three admittances, at (2, 2), (3, 2) and (2, 3) in two coordinates.

        They are Mt and Bt, and the polynomials are times Mt; sampled, they are a and b, and without
        inertia there is no a. All polynomials are affine in both. The spring Kt is in N m/rad; zero
        is none.
        """


# Neither zero nor one, with which a law has fewer operations.
COORDINATES = ((Fraction(2), Fraction(2)), (Fraction(3), Fraction(2)), (Fraction(2), Fraction(3)))


@dataclass(frozen=True, slots=True)
class ContinuousAxis(AbstractAxis):
    """An axis whose law is never sampled; the nominal place is the first one.

    `joint` is the motor in its physical state, where it has ranges or a load.
    """

    realization: Realization
    joint: Joint | None = None
    low_pass: LowPass | None = None

    @property
    def period(self) -> None:
        """There is none."""
        return

    def motion_at(self, motor: Actuator) -> Realization | JointMotionLoop:
        """Return the motion loop with a motor."""
        if self.joint is None:
            return self.realization
        return self.joint.at({"Km": motor.gain, "tau": motor.time_constant})

    def cut(self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place) -> CutLoop:
        """Return the loop of a controller."""
        cuts = _OPENED, _CLOSED, _FREE
        return CutLoop(*(characteristic(self.rows(law, contact, place, cut)) for cut in cuts))

    def modes(
        self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place
    ) -> tuple[Sequence[LinearForm], Sequence[LinearForm]]:
        """Return the mode without the force in the law, and the one that is proved."""
        return self.rows(law, contact, place, _OPENED), self.rows(law, contact, place)

    def rows(
        self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place, cut: ForceShare = _CLOSED
    ) -> list[LinearForm]:
        """Return a mode, of the states of this controller and contact alone.

        `cut` is how much of the force acts.
        """
        motion = self.motion_at(place.motor)
        if law.commands == "position":
            placed = motion if isinstance(motion, Realization) else motion.placed
            return position_mode(placed, law, contact, self.low_pass, cut=cut)
        return velocity_mode(motion, law, contact, self.low_pass, cut)

    def admittances(
        self, contact: AbstractLinearLaw, spring: Fraction, place: Place, *, inert: bool
    ) -> tuple[CutLoop, CutLoop, CutLoop]:
        """Return the loops of three admittances; without inertia is a limit of the same."""
        first, second, third = (
            _times(Mt, self.cut(Admittance(Mt, Bt, spring), contact, place))
            for Mt, Bt in COORDINATES
        )
        return first, second, third


@dataclass(frozen=True, slots=True)
class ProcessorAxis(AbstractAxis):
    """An axis whose law a processor computes.

    The first place is the nominal motor at the youngest force sample. `takes` and `drive` are there
    where the robot takes no commands of a motor, and no motor moves its joint.
    """

    motion: ProportionalDerivative
    sampling: SamplingSpec
    drive: Drive
    low_pass: LowPass | None = None
    takes: Takes | None = None

    @property
    def period(self) -> Fraction:
        """Time between two force samples in s."""
        return self.sampling.outer

    def cut(self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place) -> CutLoop:
        """Return the loop of a controller."""
        held = law.discretize(self.sampling.outer, self.sampling.admittance)
        return self._cut(held, contact, place)

    def modes(
        self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place
    ) -> tuple[Sequence[LinearForm], Sequence[LinearForm]]:
        """Return the step without the force in the law, and the one that is proved."""
        held = law.discretize(self.sampling.outer, self.sampling.admittance)
        opened, closed, _ = _touches(contact)
        return self.step(self._opened(held), place, *opened), self.step(held, place, *closed)

    def admittances(
        self, contact: AbstractLinearLaw, spring: Fraction, place: Place, *, inert: bool
    ) -> tuple[CutLoop, CutLoop, CutLoop]:
        """Return the loops of three admittances."""
        T = to_float32(self.sampling.outer)
        first, second, third = (
            self._cut(Admittance.discrete(a if inert else None, b, T, spring), contact, place)
            for a, b in COORDINATES
        )
        return first, second, third

    def _cut(self, law: DiscreteLaw, contact: AbstractLinearLaw, place: Place) -> CutLoop:
        pairs = zip((self._opened(law), law, law), _touches(contact), strict=True)
        loops = [characteristic(self.step(own, place, *touch)) for own, touch in pairs]
        while all(p[-1] == 0 for p in loops):  # A force sample that leaves its last place.
            loops = [p[:-1] for p in loops]
        return CutLoop(*(on_the_axis(p, self.period) for p in loops))

    def _opened(self, law: DiscreteLaw) -> DiscreteLaw:
        """Return a law where it is cut: a spring that draws the measured position is cut as well.

        It enters the law where the force does, so the loop is cut at the command.
        """
        if self.takes is not Takes.VELOCITY:
            return law
        return DiscreteLaw(law.law, {n: x for n, x in law.numbers.items() if n != "Kt"})

    def step(
        self,
        law: DiscreteLaw,
        place: Place,
        sensed: Contact,
        carried: Contact,
        memory: Memory = None,
    ) -> Sequence[LinearForm]:
        """Return the map of a period.

        `sensed` is what the force sample shows, `carried` what slows a motor with a load, `memory`
        the rates of what is touched.
        """
        # One place is asked for, and the hash of all takes as long as the loop.
        alone, carried = replace(self, places=()), carried if self.drive.loaded else NOTHING
        loop, flow = _loop(alone, law, place, carried, memory)
        n = len(loop.states)

        def rows(turn: Turn, age: int) -> list[LinearForm]:
            period = loop.period(loop.sample(law, age, sensed, turn), flow)
            return [row[:n] for row in period.moves]

        whole, between = rows(Turn.BOTH, place.age), self.sampling.round - 1
        for motion in [rows(Turn.MOTION, 0)] * between if between else ():
            whole = [*multiply_matrices(motion, whole)]
        return whole


def _touches(contact: AbstractLinearLaw) -> tuple[tuple[Contact, Contact, Memory], ...]:
    """Return sensed and carried contact and its memory: opened, closed, without force."""
    touched, memory = contact.load, contact.memory_rates
    return (NOTHING, touched, memory), (touched, touched, memory), (NOTHING, NOTHING, memory)


# Laws and contacts of a spec share what touches nothing, and the motor.
@lru_cache(maxsize=_KEPT)
def _loop(
    axis: ProcessorAxis, law: DiscreteLaw, place: Place, carried: Contact, memory: Memory
) -> tuple[SampledLoop, Rows]:
    """Return the loop of a law, and the flow of a period at one point."""
    T = axis.sampling.outer
    low_pass = None if axis.low_pass is None else axis.low_pass.discretize(T)
    D = axis.motion.over(axis.sampling.period.exact)
    step = StepFrame(axis.motion.Kp, D, low_pass, takes=axis.takes)
    timing = CommandTiming(axis.sampling.step, place.late, place.late)
    known = axis.drive.at({"tau": place.motor.time_constant, GAIN: place.motor.gain})
    if memory is not None:
        known = known.remembering(REMEMBERED, [*map(Interval.point, memory)])
    touched = {s: Interval.point(v) for s, v in zip(LOAD, carried, strict=True)}
    flow = HeldDrive(known, timing).flow(touched)[0].rows
    calendar = Calendar(timing, (place.age, place.age))
    loop = SampledLoop(
        SampledProgram(step, (law,)), axis.takes, known.states, known.memory, calendar
    )
    return loop, flow


def axis_of(
    spec: InteractionDesignSpec, plant: Plant, motion: ProportionalDerivative, sensor: Sensor
) -> AbstractAxis | None:
    """Return the axis of a spec, at its nominal motor and at every corner of its ranges.

    None where the force is sampled more often than the motion loop: it then enters a round at
    several samples, and there is no one place to cut.
    """
    sampling, low_pass = spec.sampling, sensor.filter
    ranges = plant.actuator_ranges
    if sampling is None:
        loop = plant.motion_loop(motion.Kp, motion.Kd)
        joint = Joint.of(plant, motion)
        return ContinuousAxis(tuple(_places(ranges, (0, 0))), realize(loop), joint, low_pass)
    if sampling.outer < sampling.period.exact:
        return None
    places = tuple(_places(ranges, sampling.delay, spec.late))
    return ProcessorAxis(places, motion, sampling, plant.held, low_pass, spec.takes)


def _places(
    ranges: ActuatorRanges, ages: tuple[int, int], lates: tuple[Fraction, ...] = (ZERO,)
) -> Iterator[Place]:
    nominal = ranges.nominal
    motors: dict[Actuator, tuple[str, ...]] = {nominal: ()}
    # Parameters without a range have one corner.
    numbers = (
        ("Km", f"{unit('rad/s')}/{ranges.command}", ranges.gain),
        ("tau", "s", ranges.time_constant),
    )
    for (_, gain), (_, tau) in product(*(r.ends for _, _, r in numbers)):
        texts = tuple(
            f"{name} = {float(value):.6g} {measured}"
            for (name, measured, r), value in zip(numbers, (gain, tau), strict=True)
            if r.low < r.high
        )
        motors.setdefault(replace(nominal, gain=gain, time_constant=tau), texts)
    every = product(motors.items(), range(ages[0], ages[1] + 1), dict.fromkeys(lates))
    for (motor, texts), age, late in every:
        aged = () if ages[0] == ages[1] else (f"delay {age}",)
        told = () if len({*lates}) == 1 else (f"command {float(late):.6g} s late",)
        yield Place(motor, age, late, (*texts, *aged, *told))


def characteristic(rows: Sequence[LinearForm]) -> Polynomial:
    """Return ``det(s I - A)`` exactly, highest power first."""
    from flint import fmpz_mat

    A = RationalMatrix.from_rows(rows)
    found = fmpz_mat([[*row] for row in A.numerators]).charpoly().coeffs()
    n = len(found) - 1
    return tuple(
        Fraction(int(c), A.denominator ** (n - i)) for i, c in reversed([*enumerate(found)])
    )


def _times(factor: Fraction, loop: CutLoop) -> CutLoop:
    each = loop.opened, loop.closed, loop.free
    return CutLoop(*(tuple(factor * c for c in polynomial) for polynomial in each))


def on_the_axis(polynomial: Sequence[Fraction], period: Fraction) -> Polynomial:
    """Put ``z = (1 + w T/2)/(1 - w T/2)`` in, times ``(1 - w T/2)^n``.

    The polynomial is in z, of degree n, highest power first; T is the period.
    """
    from flint import fmpq, fmpq_poly

    half = fmpq(period.numerator, 2 * period.denominator)
    first, *others = (fmpq(c.numerator, c.denominator) for c in polynomial)
    total, power = fmpq_poly([first]), fmpq_poly([1])
    rising, falling = fmpq_poly([1, half]), fmpq_poly([1, -half])
    for c in others:
        power *= falling
        total = total * rising + c * power
    found = [Fraction(int(c.p), int(c.q)) for c in total.coeffs()]
    return (*[ZERO] * (len(polynomial) - len(found)), *reversed(found))
