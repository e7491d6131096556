"""The sampled loop of one axis: what one period does to the state, exactly.

The actuator holds the command between samples and is not loaded by the tissue, so the stiffness
enters through the force sample alone: every entry is affine in it, and a stiffness that moves at
will is covered by its ends. State: ``[e, omega, e_before, vm, F_1, ..., F_d, delta]`` with the
error e of the motion loop, its value a period ago, the velocity vm of the admittance (absent
without inertia), the force samples on their way, and the deflection.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import chain

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.sampled import SampledAdmittance, SampledMotion
from nrs_design.errors import AssemblyError
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.contact.environment import Environment
from nrs_design.models.linear_form import LinearForm, combine, coordinates, zero
from nrs_design.models.plant import Plant
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import Channel, Contact, Mode, Output, SwitchedSystem, Time
from nrs_design.proof.taylor import exponential_between
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.interval import Interval
from nrs_design.spec.sampling import SamplingSpec
from nrs_design.switched.assumptions import at_once_texts
from nrs_design.switched.constraints import assemble_switching
from nrs_design.switched.parameter_box import Box
from nrs_design.switched.parameters import Corner
from nrs_design.switched.sampled_assumptions import assume_sampled

ONE = Fraction(1)
# What acts on a frame from outside, in this order.
INPUTS = ("velocity command", "friction", "encoder error", "force error")


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
    """

    period: Fraction
    motion: SampledMotion
    has_inertia: bool
    longest_delay: int
    time_constant: Fraction | None

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units of the states."""
        ages = (f"F {j} before [N*m]" for j in range(1, self.longest_delay + 1))
        inner = ("vm [rad/s]",) if self.has_inertia else ()
        first = ("e [rad]", "omega [rad/s]", "e before [rad]")
        return (*first, *inner, *ages, "delta [rad]")

    def rows(
        self, admittance: SampledAdmittance, delay: int, values: Mapping[str, Fraction]
    ) -> list[LinearForm]:
        """Return the map of one period, from the states and the `INPUTS` to the next states.

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
        size = len(self.states)
        unit = coordinates(size + len(INPUTS))
        error, omega, before, delta = unit[0], unit[1], unit[2], unit[size - 1]
        command, friction, encoder, sensor = unit[size:]
        samples = unit[size - 1 - self.longest_delay : size - 1]
        seen = combine((ONE, error), (-ONE, encoder))
        Kp, D = self.motion.Kp, self.motion.D
        drive = combine((Kp + D, seen), (-D, before), (ONE, friction))
        moved = combine((s, omega), (Km * (self.period - s), drive))
        ages = [combine((k, delta), (b, omega), (ONE, sensor)), *samples]
        if admittance.a is None:
            velocity, kept = combine((admittance.b, ages[delay])), []
        else:
            velocity = unit[3]
            kept = [combine((admittance.a, velocity), (admittance.b, ages[delay]))]
        T = admittance.T
        return [
            combine((ONE, error), (T, command), (-T, velocity), (-ONE, moved)),
            combine((E, omega), (Km * (1 - E), drive)),
            seen,
            *kept,
            *ages[: self.longest_delay],
            combine((ONE, delta), (ONE, moved)),
        ]


@dataclass(frozen=True, slots=True)
class _Motion:
    """One mode, and the columns of the `INPUTS`."""

    mode: Mode
    columns: tuple[RationalMatrix, ...]

    @classmethod
    def of(cls, name: str, rows: Sequence[LinearForm]) -> _Motion:
        n = len(rows)
        columns = ([[row[n + i]] for row in rows] for i in range(len(INPUTS)))
        mode = Mode(name, RationalMatrix.from_rows([row[:n] for row in rows]))
        return cls(mode, tuple(map(RationalMatrix.from_rows, columns)))


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
    ranges = plant.actuator_ranges or ActuatorRanges(
        Interval.point(plant.actuator.gain), Interval.point(plant.actuator.time_constant)
    )
    has_inertia = _have_inertia(laws.values())
    tau = ranges.time_constant
    frame = Frame(
        period,
        SampledMotion.of(design.motion, period),
        has_inertia,
        sampling.delay[1],
        tau.nominal if tau.low == tau.high else None,
    )
    motor = motor_box(ranges, period)
    parts = {
        controller.name: tuple(
            _motions(frame, laws[controller.name], sampling.delay, controller, plant, motor)
        )
        for controller in design.controllers
    }
    touched = plant.among(design.contacts)
    springs = all(_is_zero(damping_of(e)) and not e.preloaded for e in touched)
    free: tuple[_Motion, ...] = ()
    if spec.contact != "kept" and springs:
        free = tuple(_free_motions(frame, laws, sampling.delay, motor))
    groups = {key: tuple(Corner(item.mode.name) for item in part) for key, part in parts.items()}
    motions = tuple(chain.from_iterable(parts.values()))
    flying = tuple(item.mode for item in free)
    losable = Contact(flying, required=spec.contact == "losable") if free else None
    channels = tuple(_channels(spec, (*motions, *free)))
    return SwitchedSystem(
        spec.name,
        Time.DISCRETE,
        frame.states,
        tuple(item.mode for item in motions),
        (
            *assume_sampled(spec, sampling, ranges, frame.motion, laws, design, springs=springs),
            *at_once_texts(touched),
        ),
        assemble_switching(spec.switching, groups, ()),
        losable,
        period,
        channels,
        (_force_output(frame, touched, spec.limits.torque.exact),) if channels else (),
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


def _channels(spec: InteractionDesignSpec, motions: Sequence[_Motion]) -> Iterator[Channel]:
    """Yield the disturbances that the spec declares, with their columns."""
    if spec.disturbances is None:
        return
    bounds = spec.disturbances.bounds()
    for i, name in enumerate(INPUTS):
        if name in bounds:
            bound, unit = bounds[name]
            yield Channel(name, unit, bound, tuple(motion.columns[i] for motion in motions))


def _force_output(frame: Frame, touched: Sequence[Environment], limit: Fraction) -> Output:
    """Return the force in contact, at the corners of its ranges, and what it is meant to keep."""
    size, rows = len(frame.states), []
    for environment in touched:
        box = Box({"k": environment.stiffness, "b": damping_of(environment)})
        for values in box.values():
            row = zero(size)
            row[1], row[-1] = values["b"], values["k"]
            rows.append(RationalMatrix.from_rows([row]))
    return Output("force", "N*m", tuple(rows), limit)


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
    below, above = exponential_between(-period / tau.low), exponential_between(-period / tau.high)
    box = Box({"Km": ranges.gain, "E": Interval(below[0], below[0], above[1])})
    if tau.low == tau.high:
        return box
    lowest, highest = tau.low * (1 - below[1]), tau.high * (1 - above[0])
    return box.beside(Box({"s": Interval(lowest, lowest, highest)}))


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
    frame: Frame,
    laws: Mapping[str, SampledAdmittance],
    delays: tuple[int, int],
    motor: Box,
) -> Iterator[_Motion]:
    for controller, law in laws.items():
        yield from _corners(frame, law, delays, motor, f"{controller}/free")


def _corners(
    frame: Frame, law: SampledAdmittance, delays: tuple[int, int], box: Box, name: str
) -> Iterator[_Motion]:
    """Yield the motions of one controller and contact, at every delay."""
    for delay in range(delays[0], delays[1] + 1):
        late = f"{name}/delay-{delay}" if delays[0] < delays[1] else name
        for corner, rows in box.corners(partial(frame.rows, law, delay), late):
            yield _Motion.of(corner, rows)


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
    if next(iter(spec.switching.dwell_times()), None) is not None:
        what = "the rules of switching have dwell times in s"
        yield ("switching",), what, "leave them out, or sampling"
