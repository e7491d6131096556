"""The loop of one controller in one contact, cut where its law takes the force.

A spring that draws the measured position enters the law at the same place, and is cut there, too.

With the share g of the force that reaches the law, the characteristic polynomial of a mode is ``D +
g N``: the force enters at one place, so the determinant is affine in g. D is that of ``g = 0``, ``D
+ N`` that of the proved mode, and ``L = N/D`` the open loop. All is exact; polynomials are in s, or
sampled in ``w = (2/T) (z - 1)/(z + 1)``, which is ``(2/T) tan(omega T/2)`` on the imaginary axis
where z is on the unit circle: near omega while that is small.

The determinant is also affine in the stiffness of the contact and, times Mt in continuous time, in
Mt, Bt and Kt; sampled in the coefficients a and b. So a few modes give those of all gains.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from itertools import product
from typing import NamedTuple, TypeAlias

from nrs_design.controllers.float32 import round_float32
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
from nrs_design.loop.hull import fraction, rational
from nrs_design.loop.located import labelled_ends
from nrs_design.loop.modes import WHOLE, ForceShare, Rows, position_mode, velocity_mode
from nrs_design.loop.parameter_box import Joint
from nrs_design.loop.program import SampledProgram
from nrs_design.loop.sampled import NOTHING, Contact, SampledLoop
from nrs_design.loop.sampled import Rows as Flow
from nrs_design.models.actuator import Actuator, ActuatorRanges
from nrs_design.models.axis import unit
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.models.drive import GAIN, LOAD, CommandInterface, Drive
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import ZERO, LinearForm
from nrs_design.models.motion_loop import JointMotionLoop, Realization, realize
from nrs_design.models.plant import Plant
from nrs_design.proof.matrix import multiply
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.sampling import SamplingSpec

Polynomial = tuple[Fraction, ...]
# Decay and driving rate of the memory of a contact; None without memory.
Memory: TypeAlias = tuple[Fraction, Fraction] | None
REMEMBERED = "damper deflection [rad]"
_CACHE_SIZE = 512
# Shares of the force in the loops of `CutLoop`, in its order.
_OPENED, _FREE = ForceShare(sensed=ZERO), ForceShare(ZERO, ZERO)
_CUTS = _OPENED, WHOLE, _FREE


@dataclass(frozen=True, slots=True)
class Place:
    """Operating point of a loop, apart from contact and gains."""

    motor: Actuator  # Motor at a corner of its ranges, or the nominal motor
    age: int = 0  # Constant age of the force sample; zero in continuous time
    lateness: Fraction = ZERO  # From a sample to its command in s, always the same
    texts: tuple[str, ...] = ()  # Deviations from nominal; the age if there are several


class CutLoop(NamedTuple):
    """Characteristic polynomials of one mode, highest power first, of one length."""

    opened: Polynomial  # Without force feedback to the law; the load of a motor remains
    closed: Polynomial  # The closed loop
    free: Polynomial  # Where the force does not act at all


# Three admittances, in the two coordinates in which all polynomials are affine. Neither zero nor
# one, with which a law has fewer operations.
COORDINATES = ((Fraction(2), Fraction(2)), (Fraction(3), Fraction(2)), (Fraction(2), Fraction(3)))


@dataclass(frozen=True, slots=True)
class AbstractAxis(ABC):
    """One axis, from which the modes of each of its controllers follow."""

    places: tuple[Place, ...]  # The nominal motor first, at the youngest force sample

    @property
    @abstractmethod
    def period(self) -> Fraction | None:
        """Time between two force samples in s; None in continuous time."""

    @abstractmethod
    def rows(
        self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place, share: ForceShare = WHOLE
    ) -> Rows:
        """Return a mode, or step, of this controller and contact under a share of the force."""

    @abstractmethod
    def _loop(self, modes: Iterable[Rows]) -> CutLoop:
        """Return the loop whose modes at the shares of `_CUTS` are given."""

    @abstractmethod
    def admittances(
        self, contact: AbstractLinearLaw, spring: Fraction, place: Place, *, inert: bool
    ) -> list[CutLoop]:
        """Return the loops of the three admittances of `COORDINATES`.

        In continuous time these are Mt and Bt, and the polynomials are times Mt; sampled, they are
        a and b, and without inertia there is no a. The spring Kt is in N m/rad; zero is none.
        """

    def find_loop(self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place) -> CutLoop:
        """Return the loop of a controller at fixed parameters of the contact and a place."""
        return self._loop(self.rows(law, contact, place, share) for share in _CUTS)

    def modes(
        self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place
    ) -> tuple[Rows, Rows]:
        """Return the mode without force in the law, and the proved one: one rank apart."""
        return self.rows(law, contact, place, _OPENED), self.rows(law, contact, place)


@dataclass(frozen=True, slots=True)
class ContinuousAxis(AbstractAxis):
    """An axis whose law is never sampled."""

    realization: Realization
    joint: Joint | None = None  # Motor in physical states; None without ranges and load
    low_pass: LowPass | None = None

    @property
    def period(self) -> None:
        """There is none."""
        return

    def find_motion(self, motor: Actuator) -> Realization | JointMotionLoop:
        """Return the motion loop with a motor."""
        if self.joint is None:
            return self.realization
        return self.joint.evaluate({"Km": motor.gain, "tau": motor.time_constant})

    def rows(
        self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place, share: ForceShare = WHOLE
    ) -> Rows:
        """Return a mode."""
        motion = self.find_motion(place.motor)
        if law.commands == "position":
            loop = motion if isinstance(motion, Realization) else motion.position_loop
            return position_mode(loop, law, contact, self.low_pass, share=share)
        return velocity_mode(motion, law, contact, self.low_pass, share)

    def _loop(self, modes: Iterable[Rows]) -> CutLoop:
        return CutLoop(*map(characteristic, modes))

    def admittances(
        self, contact: AbstractLinearLaw, spring: Fraction, place: Place, *, inert: bool
    ) -> list[CutLoop]:
        """Return the loops of three admittances; without inertia is a limit of the same."""
        return [
            CutLoop(*(tuple(law.Mt * c for c in p) for p in self.find_loop(law, contact, place)))
            for law in (Admittance(Mt, Bt, spring) for Mt, Bt in COORDINATES)
        ]


@dataclass(frozen=True, slots=True)
class ProcessorAxis(AbstractAxis):
    """An axis with a sampled law."""

    motion: ProportionalDerivative
    sampling: SamplingSpec
    drive: Drive
    low_pass: LowPass | None = None
    interface: CommandInterface | None = None  # None for a motor command

    @property
    def period(self) -> Fraction:
        """Time between two force samples in s."""
        return self.sampling.outer

    def rows(
        self, law: CompliantLaw, contact: AbstractLinearLaw, place: Place, share: ForceShare = WHOLE
    ) -> Rows:
        """Return the map of a period."""
        discrete = law.discretize(self.sampling.outer, self.sampling.admittance)
        return self._step(discrete, contact, place, share)

    def admittances(
        self, contact: AbstractLinearLaw, spring: Fraction, place: Place, *, inert: bool
    ) -> list[CutLoop]:
        """Return the loops of three admittances."""
        T = round_float32(self.sampling.outer)
        laws = [Admittance.discrete(a if inert else None, b, T, spring) for a, b in COORDINATES]
        return [
            self._loop(self._step(law, contact, place, share) for share in _CUTS) for law in laws
        ]

    def _loop(self, modes: Iterable[Rows]) -> CutLoop:
        loops = [*map(characteristic, modes)]
        while all(p[-1] == 0 for p in loops):  # A force sample that leaves its last place.
            loops = [p[:-1] for p in loops]
        return CutLoop(*(apply_bilinear(p, self.period) for p in loops))

    def _step(
        self, law: DiscreteLaw, contact: AbstractLinearLaw, place: Place, share: ForceShare
    ) -> Rows:
        """Return the map of a period in which a share of the force acts."""
        if share.carried and not share.sensed and self.interface is CommandInterface.VELOCITY:
            # A spring that draws the measured position enters the law where the force does, so it
            # is cut as well.
            law = DiscreteLaw(law.law, {n: x for n, x in law.numbers.items() if n != "Kt"})
        sensed = contact.load if share.sensed else NOTHING
        carried = contact.load if share.carried and self.drive.loaded else NOTHING
        # Hashing all places takes as long as making the loop.
        axis = replace(self, places=())
        loop, flow = _sampled_loop(axis, law, place, carried, contact.memory_rates)
        n = len(loop.states)

        def rows(turn: Turn, age: int) -> list[LinearForm]:
            period = loop.period(loop.sample(law, age, sensed, turn), flow)
            return [row[:n] for row in period.moves]

        whole, repeats = rows(Turn.BOTH, place.age), self.sampling.round - 1
        for motion in [rows(Turn.MOTION, 0)] * repeats if repeats else ():
            whole = [*multiply(motion, whole)]
        return whole


# Laws and contacts of a spec share what touches nothing, and the motor.
@lru_cache(maxsize=_CACHE_SIZE)
def _sampled_loop(
    axis: ProcessorAxis, law: DiscreteLaw, place: Place, carried: Contact, memory: Memory
) -> tuple[SampledLoop, Flow]:
    """Return the loop of a law, and the flow of a period at one point."""
    T = axis.sampling.outer
    low_pass = None if axis.low_pass is None else axis.low_pass.discretize(T)
    D = axis.motion.difference_gain(axis.sampling.period.exact)
    step = StepFrame(axis.motion.Kp, D, low_pass, interface=axis.interface)
    timing = CommandTiming(axis.sampling.step, place.lateness, place.lateness)
    known = axis.drive.fix_values({"tau": place.motor.time_constant, GAIN: place.motor.gain})
    if memory is not None:
        known = known.remembering(REMEMBERED, [*map(Interval.point, memory)])
    load = {s: Interval.point(v) for s, v in zip(LOAD, carried, strict=True)}
    flow = HeldDrive(known, timing).flow(load)[0].rows
    calendar = Calendar(timing, (place.age, place.age))
    return SampledLoop(SampledProgram(step, (law,)), known, calendar), flow


def axis_of(
    spec: InteractionDesignSpec, plant: Plant, motion: ProportionalDerivative, sensor: Sensor
) -> AbstractAxis | None:
    """Return the axis of a spec, at its nominal motor and at every corner of its ranges.

    None where the force enters a round at several samples: there is no one place to cut.
    """
    sampling, low_pass = spec.sampling, sensor.filter
    ranges = plant.actuator_ranges
    if sampling is None:
        loop = plant.motion_loop(motion.Kp, motion.Kd)
        joint = Joint.from_plant(plant, motion)
        return ContinuousAxis(tuple(_places(ranges, (0, 0))), realize(loop), joint, low_pass)
    if sampling.outer < sampling.period.exact:
        return None
    places = tuple(_places(ranges, sampling.delay, spec.late))
    return ProcessorAxis(places, motion, sampling, plant.zoh_drive, low_pass, spec.takes)


def _places(
    ranges: ActuatorRanges, ages: tuple[int, int], lates: tuple[Fraction, ...] = (ZERO,)
) -> Iterator[Place]:
    nominal = ranges.nominal
    motors: dict[Actuator, tuple[str, ...]] = {nominal: ()}
    units = {GAIN: f"{unit('rad/s')}/{ranges.command}", "tau": "s"}
    for labels, values in labelled_ends({GAIN: ranges.gain, "tau": ranges.time_constant}):
        symbols = [label.partition("-")[0] for label in labels]
        texts = tuple(f"{s} = {float(values[s]):.6g} {units[s]}" for s in symbols)
        motors.setdefault(replace(nominal, gain=values[GAIN], time_constant=values["tau"]), texts)
    points = product(motors.items(), range(ages[0], ages[1] + 1), dict.fromkeys(lates))
    for (motor, texts), age, lateness in points:
        aged = () if ages[0] == ages[1] else (f"delay {age}",)
        lag_text = () if len({*lates}) == 1 else (f"command {float(lateness):.6g} s late",)
        yield Place(motor, age, lateness, (*texts, *aged, *lag_text))


def characteristic(rows: Sequence[LinearForm]) -> Polynomial:
    """Return ``det(s I - A)`` exactly, highest power first."""
    from flint import fmpq_mat

    found = fmpq_mat([[rational(c) for c in row] for row in rows]).charpoly().coeffs()
    return tuple(map(fraction, reversed(found)))


def apply_bilinear(polynomial: Sequence[Fraction], period: Fraction) -> Polynomial:
    """Put ``z = (1 + w T/2)/(1 - w T/2)`` in, times ``(1 - w T/2)^n``.

    The polynomial is in z, of degree n, highest power first; T is the period.
    """
    from flint import fmpq_poly

    half = rational(period / 2)
    first, *others = map(rational, polynomial)
    total, power = fmpq_poly([first]), fmpq_poly([1])
    rising, falling = fmpq_poly([1, half]), fmpq_poly([1, -half])
    for c in others:
        power *= falling
        total = total * rising + c * power
    found = [*map(fraction, total.coeffs())]
    return (*[ZERO] * (len(polynomial) - len(found)), *reversed(found))
