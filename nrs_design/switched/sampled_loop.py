"""The sampled loop of one axis: what one period does to the state, exactly.

The actuator holds the command between samples and is not loaded by the tissue, so the stiffness
enters through the force sample alone: every entry is affine in it, and a stiffness that moves at
will is covered by its ends. State: ``[e, omega, e_before, vm, F_1, ..., F_d, delta]`` with the
error e of the motion loop, its value a period ago, the velocity vm of the admittance (absent
without inertia), the lags of a filter, the force samples on their way, and the deflection.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import chain
from math import ceil, floor

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.sampled import (
    ROUNDINGS,
    ROUNDINGS_WITHOUT_INERTIA,
    SampledAdmittance,
    SampledMotion,
    Term,
    rounding_share,
)
from nrs_design.controllers.sensor import SampledLowPass
from nrs_design.errors import AssemblyError
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.contact.environment import Environment
from nrs_design.models.linear_form import LinearForm, combine, coordinates, zero
from nrs_design.models.plant import Plant
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import (
    Channel,
    Contact,
    Mode,
    Output,
    Rounding,
    SwitchedSystem,
    Time,
)
from nrs_design.proof.taylor import exponential_between
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.interval import Interval
from nrs_design.spec.sampling import DisturbancesSpec, SamplingSpec
from nrs_design.switched.assumptions import at_once_texts
from nrs_design.switched.constraints import assemble_switching
from nrs_design.switched.parameter_box import Box
from nrs_design.switched.parameters import Corner
from nrs_design.switched.sampled_assumptions import Loss, assume_sampled

ONE = Fraction(1)
# Binary digits of how large roundings are, and of the enclosures of exponentials.
SIZE_BITS, EXPONENTIAL_BITS = 8, 56
KP, KD, FORCE, STEP = "Kp e", "D (e - e before)", "b F", "T (v - vm)"
# What acts on a frame from outside, in this order.
INPUTS = (
    "velocity command",
    "friction",
    "encoder error",
    "force error",
    "rounding of the reference",
    "rounding of the angle",
)


@dataclass(frozen=True, slots=True)
class Frame:
    """What all modes of a sampled loop share.

    Parameters
    ----------
    period : Fraction
        In s.
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
    """

    period: Fraction
    motion: SampledMotion
    has_inertia: bool
    longest_delay: int
    time_constant: Fraction | None
    low_pass: SampledLowPass | None = None
    sprung: bool = False

    @property
    def roundings(self) -> dict[str, Fraction]:
        """What the arithmetic changes of every term of the law at most, over its size."""
        return {name: _short(rounding_share(count)) for name, count in self.counts.items()}

    @property
    def counts(self) -> dict[str, int]:
        """How often each term of the law is rounded."""
        plain = ROUNDINGS if self.has_inertia else ROUNDINGS_WITHOUT_INERTIA
        stages, pushes = self._force_terms(ONE, [], [[]] * self._order, [])
        forces = {term.name: term.roundings for term in chain(*stages, pushes)}
        counts: dict[str, int] = {}
        for name, count in plain.items():
            counts |= forces if name == FORCE else {name: count}
        return counts

    @property
    def _order(self) -> int:
        return 0 if self.low_pass is None else self.low_pass.order

    def _force_terms(
        self, b: Fraction, sample: LinearForm, lags: Sequence[LinearForm], pull: LinearForm
    ) -> tuple[list[tuple[Term, ...]], tuple[Term, ...]]:
        """Return the terms of each lag, and those of what the force adds to the velocity."""
        # The sample is rounded when it is read; the pull is a difference of references times Kt.
        felt: tuple[Term, ...] = (Term("F", sample, 1),)
        stages: list[tuple[Term, ...]] = []
        if self.low_pass is not None:
            stages = self.low_pass.stages(felt, lags)
            felt = stages[-1]
        if self.sprung:
            felt = (*(term.times(ONE, "", 1) for term in felt), Term("Kt r", pull, 3))
        more = 1 + self.has_inertia
        return stages, tuple(term.times(b, "b ", more) for term in felt)

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units of the states."""
        ages = (f"F {j} before [N*m]" for j in range(1, self.longest_delay + 1))
        inner = ("vm [rad/s]",) if self.has_inertia else ()
        first = ("e [rad]", "omega [rad/s]", "e before [rad]")
        sensed = () if self.low_pass is None else self.low_pass.states
        return (*first, *inner, *sensed, *ages, "delta [rad]")

    def rows(
        self, admittance: SampledAdmittance, delay: int, values: Mapping[str, Fraction]
    ) -> list[LinearForm]:
        """Return the map of one period, and below it how large each rounding is at most.

        The first rows lead from the states, the `INPUTS` and the `roundings` to the next states;
        of a rounding, the size is at most that of its row below.

        Parameters
        ----------
        admittance : SampledAdmittance
            Of the controller in force.
        delay : int
            Age of its force sample.
        values : mapping
            The gain ``Km``, ``E = exp(-T/tau)``, and ``s = tau (1 - E)`` unless tau is known; in
            contact the stiffness ``k`` and the damping ``b`` that the force sample shows.
        """
        Km, E, tau = values["Km"], values["E"], self.time_constant
        s = values["s"] if tau is None else tau * (1 - E)
        k, b = values.get("k", Fraction(0)), values.get("b", Fraction(0))
        size, shares = len(self.states), self.roundings
        unit = coordinates(size + len(INPUTS) + len(shares))
        error, omega, before, delta = unit[0], unit[1], unit[2], unit[size - 1]
        command, friction, encoder, sensor, reference, angle = unit[size : size + len(INPUTS)]
        rounded = dict(zip(shares, unit[size + len(INPUTS) :], strict=True))
        samples = unit[size - 1 - self.longest_delay : size - 1]
        read = combine((ONE, error), (-ONE, encoder), (-ONE, angle))
        seen = combine((ONE, read), (ONE, rounded["e"]))
        Kp, D, T = self.motion.Kp, self.motion.D, admittance.T
        drive = combine((Kp + D, seen), (-D, before), (ONE, friction))
        drive = combine((ONE, drive), (ONE, rounded[KP]), (ONE, rounded[KD]))
        moved = combine((s, omega), (Km * (self.period - s), drive))
        ages = [combine((k, delta), (b, omega), (ONE, sensor)), *samples]
        lags = unit[3 + self.has_inertia : 3 + self.has_inertia + self._order]
        # The reference, e + theta, is by how much the admittance has moved it.
        pull = combine((admittance.Kt, error), (admittance.Kt, delta))
        stages, pushes = self._force_terms(admittance.b, ages[delay], lags, pull)
        sensed = [_sum_of(stage, rounded) for stage in stages]
        pushed, kept = combine(*((ONE, term.form) for term in pushes)), list[LinearForm]()
        velocity = exact = _sum_of(pushes, rounded)
        if admittance.a is None:
            exact = pushed
        else:
            velocity, inner = unit[3], combine((admittance.a, unit[3]))
            kept = [combine((ONE, inner), (ONE, exact), (ONE, rounded["a vm"]))]
            exact = velocity
        first = combine((ONE, error), (T, command), (-T, velocity), (ONE, rounded[STEP]))
        # Of a sum of two sizes, the part that is of second order counts with another term.
        second = shares[KP] * Kp * (1 + shares["e"]) + shares[KD] * D * shares["e"]
        beyond = ONE if kept else 1 + shares[STEP]
        sizes = {
            "e": combine((shares["e"], read)),
            KP: combine((_short(second), read)),
            KD: combine((_short(shares[KD] * D), combine((ONE, read), (-ONE, before)))),
            "a vm": combine((_short(shares.get("a vm", ONE) * (admittance.a or 1)), unit[3])),
            **{t.name: combine((shares[t.name], t.form)) for t in chain(*stages)},
            **{t.name: combine((shares[t.name] * beyond, t.form)) for t in pushes},
            STEP: combine((_short(shares[STEP] * T), combine((ONE, command), (-ONE, exact)))),
        }
        return [
            combine((ONE, first), (ONE, reference), (-ONE, moved)),
            combine((E, omega), (Km * (1 - E), drive)),
            seen,
            *kept,
            *sensed,
            *ages[: self.longest_delay],
            combine((ONE, delta), (ONE, moved)),
            *(sizes[name] for name in shares),
        ]


def _short(size: Fraction) -> Fraction:
    """Round a size up to a few binary digits, so that the numbers of a certificate stay short."""
    bits = size.numerator.bit_length() - size.denominator.bit_length()
    unit = Fraction(2) ** (bits - SIZE_BITS)
    return ceil(size / unit) * unit


def _sum_of(terms: Iterable[Term], rounded: Mapping[str, LinearForm]) -> LinearForm:
    """Return the sum of terms, each with what it is rounded by."""
    return combine(*((ONE, form) for t in terms for form in (t.form, rounded[t.name])))


@dataclass(frozen=True, slots=True)
class _Motion:
    """One mode, the columns of inputs and roundings, and the rows that bound the roundings."""

    mode: Mode
    columns: tuple[RationalMatrix, ...]
    sizes: tuple[LinearForm, ...]

    @classmethod
    def of(cls, name: str, rows: Sequence[LinearForm], n: int) -> _Motion:
        moves, width = rows[:n], len(rows[0])
        columns = ([[row[i]] for row in moves] for i in range(n, width))
        mode = Mode(name, RationalMatrix.from_rows([row[:n] for row in moves]))
        return cls(mode, tuple(map(RationalMatrix.from_rows, columns)), tuple(rows[n:]))


def close_sampled_loop(
    spec: InteractionDesignSpec, sampling: SamplingSpec, plant: Plant, design: ControllerDesign
) -> SwitchedSystem:
    """Assemble every mode of the sampled loop.

    One mode for each controller, delay and corner of the ranges of stiffness, damping and actuator.
    The map is affine in stiffness, damping, ``Km``, ``E`` and ``s``, each for itself, so it is a
    convex combination of the corners in the whole box. E and s are transcendental: both are
    enclosed, and so they have ranges even where gain and time constant are known.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With the name, the rules of switching and what is said of contact.
    sampling : SamplingSpec
        Its processor.
    plant : Plant
        Actuator and environments.
    design : ControllerDesign
        Gains that ship.

    Raises
    ------
    AssemblyError
        If something about the spec is not modelled in the sampled loop.
    """
    period = sampling.period.exact
    sampled = {c.name: c.law.sampled(period, sampling.admittance) for c in design.controllers}
    _check_modelled(spec, plant, design, sampled)
    laws = {name: law for name, law in sampled.items() if law is not None}
    ranges = plant.actuator_ranges or ActuatorRanges.point(plant.actuator)
    has_inertia = _have_inertia(laws.values())
    low_pass = design.sensor.filter
    tau = ranges.time_constant
    frame = Frame(
        period,
        SampledMotion.of(design.motion, period),
        has_inertia,
        sampling.delay[1],
        tau.nominal if tau.low == tau.high else None,
        None if low_pass is None else low_pass.sampled(period),
        any(law.Kt for law in laws.values()),
    )
    motor = motor_box(ranges, period)
    parts = {
        controller.name: tuple(
            _motions(frame, laws[controller.name], sampling.delay, controller, plant, motor)
        )
        for controller in design.controllers
    }
    touched = plant.among(design.contacts)
    loss = _loss_of_contact(spec, touched, laws.values())
    air = {
        name: _free_motions(frame, name, law, sampling.delay, motor) for name, law in laws.items()
    }
    if loss == "anywhere":
        parts = {name: (*part, *air[name]) for name, part in parts.items()}
    free = tuple(chain.from_iterable(air.values())) if loss == "on the surface" else ()
    groups = {key: tuple(Corner(item.mode.name) for item in part) for key, part in parts.items()}
    motions = tuple(chain.from_iterable(parts.values()))
    flying = tuple(item.mode for item in free)
    losable = Contact(flying, required=spec.contact == "losable") if free else None
    every = (*motions, *free)
    channels = tuple(_channels(spec, design.sensor.lasting, every))
    return SwitchedSystem(
        spec.name,
        Time.DISCRETE,
        frame.states,
        tuple(item.mode for item in motions),
        (
            *assume_sampled(spec, sampling, ranges, frame.motion, laws, design, loss, frame.counts),
            *at_once_texts(touched),
        ),
        assemble_switching(spec.switching, groups, ()),
        losable,
        period,
        channels,
        _outputs(frame, touched, spec.limits.torque.exact) if channels else (),
        tuple(_roundings(frame, channels, every)),
    )


def _have_inertia(laws: Iterable[SampledAdmittance]) -> bool:
    """Tell whether the admittances have a velocity of their own: all of them, or none."""
    found = {law.a is not None for law in laws}
    if len(found) > 1:
        raise AssemblyError(
            "some impedance controllers have a virtual inertia and some have none, so they share "
            "no state",
            remedy="give all impedance controllers a virtual inertia Mt > 0, or none of them",
            at=("controllers",),
        )
    return True in found


def _channels(
    spec: InteractionDesignSpec, off: Fraction, motions: Sequence[_Motion]
) -> Iterator[Channel]:
    """Yield the disturbances of the spec, and the errors of its sensor, with their columns."""
    if spec.disturbances is None:
        return
    bounds = spec.disturbances.bounds() | _angle_bounds(spec.disturbances)
    if off:
        bounds["force error"] = (off, "N*m")
    for i, name in enumerate(INPUTS):
        if name in bounds:
            bound, unit = bounds[name]
            yield Channel(name, unit, bound, tuple(motion.columns[i] for motion in motions))


def _angle_bounds(disturbances: DisturbancesSpec) -> dict[str, tuple[Fraction, str]]:
    """Return how far angles of the law are off; one is read from a count, times a coefficient."""
    if disturbances.largest_angle is None:
        return {}
    largest = disturbances.largest_angle.not_below
    counts = {"rounding of the reference": 1, "rounding of the angle": 3}
    return {name: (rounding_share(n) * largest, "rad") for name, n in counts.items()}


def _roundings(
    frame: Frame, channels: Sequence[Channel], motions: Sequence[_Motion]
) -> Iterator[Rounding]:
    """Yield what the arithmetic adds, with rows over the states and the declared disturbances."""
    n, named = len(frame.states), [channel.name for channel in channels]
    kept = [*range(n), *(n + i for i, name in enumerate(INPUTS) if name in named)]
    for j, name in enumerate(frame.roundings):
        rows = ([[motion.sizes[j][i] for i in kept]] for motion in motions)
        columns = (motion.columns[len(INPUTS) + j] for motion in motions)
        yield Rounding(name, tuple(columns), tuple(map(RationalMatrix.from_rows, rows)))


def _outputs(frame: Frame, touched: Sequence[Environment], limit: Fraction) -> tuple[Output, ...]:
    """Return the force at the corners of its ranges, with what it is meant to keep, and omega."""
    size, rows = len(frame.states), []
    for environment in touched:
        box = Box({"k": environment.stiffness, "b": damping_of(environment)})
        for values in box.values():
            row = zero(size)
            row[1], row[-1] = values["b"], values["k"]
            rows.append(RationalMatrix.from_rows([row]))
    omega = RationalMatrix.from_rows(coordinates(size)[1:2])
    force = Output("force", "N*m", tuple(rows), limit)
    return force, Output("velocity", "rad/s", (omega,))


def motor_box(ranges: ActuatorRanges, period: Fraction) -> Box:
    """Return where Km, ``E = exp(-T/tau)`` and ``s = tau (1 - E)`` lie.

    Both rise with tau: the derivative of s is ``1 - (1 + x) exp(-x)`` at ``x = T/tau``, positive.
    Where tau is known, s is affine in E and is left out.

    Parameters
    ----------
    ranges : ActuatorRanges
        Of gain and time constant.
    period : Fraction
        In s.
    """
    tau = ranges.time_constant
    below, above = _between(-period / tau.low), _between(-period / tau.high)
    box = Box({"Km": ranges.gain, "E": Interval(below[0], below[0], above[1])})
    if tau.low == tau.high:
        return box
    lowest, highest = tau.low * (1 - below[1]), tau.high * (1 - above[0])
    return box.beside(Box({"s": Interval(lowest, lowest, highest)}))


def _between(exponent: Fraction) -> tuple[Fraction, Fraction]:
    """Enclose an exponential between short numbers."""
    low, high = exponential_between(exponent)
    unit = Fraction(1, 2**EXPONENTIAL_BITS)
    return floor(low / unit) * unit, ceil(high / unit) * unit


def _motions(
    frame: Frame,
    law: SampledAdmittance,
    delays: tuple[int, int],
    controller: Controller,
    plant: Plant,
    motor: Box,
) -> Iterator[_Motion]:
    for environment in map(plant.environment, controller.contacts):
        own = Box({"k": environment.stiffness, "b": damping_of(environment)}).beside(motor)
        yield from _corners(frame, law, delays, own, f"{controller.name}/{environment.name}")


def _free_motions(
    frame: Frame, controller: str, law: SampledAdmittance, delays: tuple[int, int], motor: Box
) -> Iterator[_Motion]:
    return _corners(frame, law, delays, motor, f"{controller}/free")


def _loss_of_contact(
    spec: InteractionDesignSpec,
    touched: Iterable[Environment],
    laws: Iterable[SampledAdmittance],
) -> Loss:
    """Tell how contact is lost; with springs everywhere, free motion is a mode like others."""
    sprung = {law.Kt != 0 for law in laws}
    if spec.contact == "kept" or (True in sprung and spec.contact is None):
        return "never"
    if not all(_is_zero(damping_of(e)) and not e.preloaded for e in touched):
        return "not modelled"
    return "anywhere" if sprung == {True} else "on the surface"


def _corners(
    frame: Frame, law: SampledAdmittance, delays: tuple[int, int], box: Box, name: str
) -> Iterator[_Motion]:
    """Yield the motions of one controller and contact, at every delay."""
    for delay in range(delays[0], delays[1] + 1):
        late = f"{name}/delay-{delay}" if delays[0] < delays[1] else name
        for corner, rows in box.corners(partial(frame.rows, law, delay), late):
            yield _Motion.of(corner, rows, len(frame.states))


def damping_of(environment: Environment) -> Interval:
    """Return the range of the damping beside the spring; zero for a spring."""
    return environment.parameters.get("b", Interval.point(Fraction(0)))


def _is_zero(interval: Interval) -> bool:
    return interval.low == 0 == interval.high


def _check_modelled(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    laws: Mapping[str, SampledAdmittance | None],
) -> None:
    """Refuse what the sampled loop does not model, at its place in the spec."""
    for at, what, remedy in _not_modelled(spec, plant, design, laws):
        raise AssemblyError(f"in the sampled loop, {what}: not modelled", remedy=remedy, at=at)


def _not_modelled(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    laws: Mapping[str, SampledAdmittance | None],
) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """Yield place, fault and remedy."""
    for controller in design.controllers:
        if laws[controller.name] is None:
            what = f"{controller.name} is a {controller.law.name} controller"
            at = ("controllers", controller.name, "type")
            yield at, what, "use impedance controllers, or leave sampling out"
    for name, written in spec.controllers.items():
        if any(gain.ranged for gain in written.gains().values()):
            what = f"the gains of {name} have ranges"
            yield ("controllers", name), what, "give nominal gains only, or leave sampling out"
    for environment in plant.environments:
        if environment.law.remembers:
            remedy = "use elastic or kelvin-voigt environments, or leave sampling out"
            yield ("environments", environment.name), f"{environment.name} remembers", remedy
    if plant.given_loop is not None:
        what = "the spec states the closed motion loop in continuous time"
        yield ("motion_loop", "transfer_function"), what, "leave transfer_function or sampling out"
    for environment in plant.among(design.contacts):
        if spec.contact == "losable" and not _is_zero(damping_of(environment)):
            what = f"loss of contact with {environment.name}, which has damping"
            yield ("contact",), what, "use `contact: kept`, or leave sampling out"
    sprung = {law.Kt != 0 for law in laws.values() if law is not None}
    if spec.contact == "losable" and len(sprung) > 1:
        what = "loss of contact where some controllers have a spring Kt and some have none"
        yield ("contact",), what, "use `contact: kept`, or give all of them a spring"
    commanded = spec.disturbances is not None and spec.disturbances.command is not None
    if commanded and True in sprung:
        what = "a velocity command moves the position that the spring Kt draws the robot to"
        yield ("disturbances", "command"), what, "leave command out, or Kt"
    if next(iter(spec.switching.dwell_times()), None) is not None:
        what = "the rules of switching have dwell times in s"
        yield ("switching",), what, "leave them out, or sampling"
