"""The sampled loop of one axis: every mode of it, and how contact is lost."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import chain, product

from nrs_design.controllers.controller_design import SHARED_STATES, Controller, ControllerDesign
from nrs_design.controllers.gains import idle_share
from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.controllers.parts import FORCE_GAIN
from nrs_design.controllers.step_law import StepFrame
from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import LinearForm, coordinates
from nrs_design.models.plant import Plant
from nrs_design.proof.channels import Output
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import IdleStatesSpec
from nrs_design.spec.interaction_parts import FREE
from nrs_design.spec.misses import MISS, automaton_of
from nrs_design.spec.operating import OperatingConditions
from nrs_design.spec.sampling import SamplingSpec
from nrs_design.switched.assumptions import at_once_texts
from nrs_design.switched.command_timing import CommandTiming, timing_of
from nrs_design.switched.constraints import assemble_switching, leaving_impedance, zeroing
from nrs_design.switched.free_motion import (
    could_pull,
    flights_among,
    force_rows,
    lost_on_surface,
    outputs_of,
)
from nrs_design.switched.held_drive import HeldDrive
from nrs_design.switched.held_motor import HeldMotor, hold
from nrs_design.switched.misses import clock_of
from nrs_design.switched.motor_command import motor_command
from nrs_design.switched.parameter_box import Box
from nrs_design.switched.sampled_assumptions import Loss, assume_sampled
from nrs_design.switched.sampled_frame import Frame, Turn
from nrs_design.switched.sampled_inputs import (
    SampledMode,
    anything_of,
    channels_of,
    damping_of,
    roundings_of,
)
from nrs_design.switched.saturation import with_sampled_saturation


def close_sampled_loop(
    conditions: OperatingConditions,
    sampling: SamplingSpec,
    plant: Plant,
    design: ControllerDesign,
    *,
    points: bool = False,
) -> SwitchedSystem:
    """Assemble every mode of the sampled loop.

    One mode for each controller, delay and corner of the ranges of stiffness, damping and actuator.
    The map is affine in stiffness, damping, ``Km``, and in ``E`` and ``s`` together, each for
    itself, so it is a convex combination of the corners in the whole box. E and s are
    transcendental: both are enclosed, and so they have ranges even where gain and time constant are
    known.
    """
    _check_periods(sampling)
    period, method = sampling.outer, sampling.admittance
    laws = {c.name: c.law.discretize(period, method) for c in design.controllers}
    ranges = plant.actuator_ranges
    timing = timing_of(sampling, conditions.late)
    motor = hold(ranges, timing)
    if plant.drive is not None:
        motor = HeldDrive.of(plant.drive, timing)
    frame = _frame(conditions.idle, sampling, design, tuple(laws.values()), motor, timing)
    environments = plant.among(design.contacts)
    loss = _loss_of_contact(conditions.contact, environments, design)
    motors = tuple(_labelled(motor.points())) if points else ()
    loop = _Loop(frame, sampling.delay, loses=loss.startswith("anywhere"), motors=motors)
    parts, free = _motions(frame, loop, plant, design, laws, loss)
    groups = {key: tuple(item.mode.name for item in part) for key, part in parts.items()}
    motions = tuple(chain.from_iterable(parts.values()))
    velocity = coordinates(len(frame.states))[frame.states.index("omega [rad/s]")]
    pulls = tuple(force_rows(velocity, frame.states, could_pull(environments)))
    losable = flights = None
    if free:
        losable = lost_on_surface((item.mode for item in free), pulls, conditions.contact)
    if loss.startswith("anywhere"):
        names = (item.mode.name for item in motions)
        # A controller without contacts takes no force: its modes are the same in contact and free,
        # unless a force sample outlasts them.
        resting = [c.name for c in design.controllers] if frame.remembers else ()
        flights = flights_among(names, plant.environments, pulls, resting)
    every = (*motions, *free)
    begins = tuple(item.mode.name for item in every if item.begins)
    channels = tuple(
        channels_of(conditions.disturbances, conditions.largest_angle, design.sensor.lasting, every)
    )
    outputs: tuple[Output, ...] = ()
    if channels:
        outputs = outputs_of(velocity, frame.states, environments, conditions.torque)
        if motor.drive is not None and motor.drive.speed is not None:
            # It jumps after the sample, and the force of what is damped with it.
            outputs = () if pulls else outputs[:1]
    driven = motor_command(conditions.largest_command, conditions.command, frame, channels)
    texts: tuple[str, ...] = (
        *assume_sampled(conditions, sampling, ranges, frame, laws, design, loss, environments),
        *at_once_texts(environments),
        *(() if driven is None else (driven.text,)),
    )
    resets: Iterable[tuple[str, str, RationalMatrix]] = ()
    if conditions.idle is not None and conditions.idle.reset:
        map_ = zeroing(frame.states, ("reference [rad]", "vm [rad/s]"))
        resets = ((*pair, map_) for pair in leaving_impedance(design.controllers))
    system = SwitchedSystem(
        name=conditions.name,
        time=Time.DISCRETE,
        states=frame.states,
        modes=tuple(item.mode for item in motions),
        assumptions=texts,
        switching=assemble_switching(conditions.switching, groups, resets),
        contact=losable,
        sample_time=sampling.longest_step,
        channels=channels,
        outputs=(*outputs, *(() if driven is None else (driven.output,))),
        roundings=tuple(roundings_of(frame, channels, every)),
        clock=_clock(sampling, begins),
        flights=flights,
        enclosures=tuple(_enclosures(every)),
    )
    if conditions.initial_force is not None and not points:
        system = with_sampled_saturation(system, conditions, frame, every, environments)
    return system


def _labelled(
    motors: Iterable[tuple[tuple[str, ...], HeldMotor]],
) -> Iterator[tuple[str, HeldMotor]]:
    for labels, motor in motors:
        yield "".join(f"/{label}" for label in labels), motor


def _enclosures(every: Iterable[SampledMode]) -> Iterator[tuple[str, ...]]:
    """Yield the modes that enclose one map together."""
    found: dict[str, list[str]] = {}
    for item in every:
        found.setdefault(item.point, []).append(item.mode.name)
    yield from (tuple(names) for names in found.values() if len(names) > 1)


def _motions(
    frame: Frame,
    loop: _Loop,
    plant: Plant,
    design: ControllerDesign,
    laws: Mapping[str, DiscreteLaw],
    loss: Loss,
) -> tuple[dict[str, tuple[SampledMode, ...]], tuple[SampledMode, ...]]:
    """Return the motions of each controller, and those of free motion beside them.

    Where contact is lost anywhere, a controller moves freely as it does in one more contact.
    """
    parts: dict[str, tuple[SampledMode, ...]] = {}
    free: list[SampledMode] = []
    for c in design.controllers:
        own = tuple(map(plant.environment, c.contacts))
        parts[c.name] = loop.in_contact(c, laws[c.name], own or plant.among(design.contacts))
        if not c.contacts:
            continue
        if loss == "on the surface":
            free += loop.in_the_air(c.name, laws[c.name])
        elif loss.startswith("anywhere"):
            parts[c.name] += tuple(loop.in_the_air(c.name, laws[c.name]))
    if frame.turns[-1].is_miss:
        law = next(iter(laws.values()))
        contacts = dict.fromkeys(name for c in design.controllers for name in c.contacts)
        touched = [*map(plant.environment, contacts)]
        parts[f"/{MISS}"] = tuple(loop.missed(law, touched))
        # As for controllers, free motion is among them or beside them.
        if loss == "on the surface":
            free += loop.missed(law, ())
        elif loss.startswith("anywhere"):
            parts[f"/{MISS}"] += tuple(loop.missed(law, ()))
    if Turn.MOTION in frame.turns:
        law = next(iter(laws.values()))
        # No controller has a name with a slash.
        parts[f"/{Turn.MOTION}"] = tuple(loop.between(law, str(Turn.MOTION)))
        free += loop.between(law, f"{Turn.MOTION}/{FREE}") if free else ()
    return parts, tuple(free)


def _check_periods(sampling: SamplingSpec) -> None:
    """Refuse loops that do not meet, as they may where a period is changed."""
    if (odd := sampling.find_odd_periods()) is not None:
        raise AssemblyError(odd, remedy="change both periods", at=("sampling", "outer_period"))


def _clock(sampling: SamplingSpec, begins: tuple[str, ...]) -> Clock | None:
    """Return which modes may be in force: some begin a round, or are those in time."""
    if sampling.misses is not None:
        return clock_of(automaton_of(*sampling.misses.window), begins)
    return Clock(sampling.round, begins) if sampling.round > 1 else None


def _turns(sampling: SamplingSpec) -> tuple[Turn, ...]:
    """Return what is computed at a sample, in a round and in between, or in time and missed."""
    if sampling.misses is not None:
        return Turn.BOTH, Turn.HELD if sampling.misses.command == "hold" else Turn.ZEROED
    if sampling.round == 1:
        return (Turn.BOTH,)
    faster = sampling.outer < sampling.period.exact
    return Turn.BOTH, Turn.ADMITTANCE if faster else Turn.MOTION


def _frame(
    idle: IdleStatesSpec | None,
    sampling: SamplingSpec,
    design: ControllerDesign,
    laws: Sequence[DiscreteLaw],
    motor: HeldMotor,
    timing: CommandTiming,
) -> Frame:
    if (odd := design.find_odd_states(mixed=idle is not None)) is not None:
        raise AssemblyError(
            f"{odd}, so their modes share no state", remedy=SHARED_STATES, at=("controllers",)
        )
    low_pass, motion = design.sensor.filter, design.motion
    outer = sampling.outer
    filtered = None if low_pass is None else low_pass.discretize(outer)
    return Frame(
        timing,
        motor,
        StepFrame(motion.Kp, motion.over(sampling.period.exact), filtered, takes=design.takes),
        tuple(laws),
        sampling.delay[1],
        None if idle is None else idle_share(idle, outer),
        _turns(sampling),
    )


@dataclass(frozen=True, slots=True)
class _Loop:
    """What the motions of a loop have in common."""

    frame: Frame
    delays: tuple[int, int]
    loses: bool = False  # Whether contact may be lost anywhere
    # Motors that there are, each with its label, instead of what encloses them all.
    motors: tuple[tuple[str, HeldMotor], ...] = ()

    def with_motor(self, motor: HeldMotor) -> _Loop:
        """Return the loop with another motor."""
        return replace(self, frame=replace(self.frame, motor=motor))

    def moved(self) -> Iterator[tuple[str, _Loop]]:
        """Yield the loop with every motor, and the label of each."""
        for label, motor in self.motors or (("", self.frame.motor),):
            yield label, self.with_motor(motor)

    def touching(
        self, environment: Environment, environments: Iterable[Environment], *, forced: bool
    ) -> Iterator[tuple[str, _Loop, Box]]:
        """Yield the loop in contact with every motor, a label, and stiffness and damping."""
        own = {"k": environment.stiffness, "b": damping_of(environment)}
        for label, loop in self.moved():
            motor = loop.frame.motor
            if motor.drive is None or not motor.drive.loaded:
                yield label, loop, Box(own)
            elif self.motors and environment.depends:
                yield label, loop.with_motor(motor.touching(own, forced=forced)), Box(own)
            elif not self.motors:
                # It may be another one within a period, too, or nothing where contact is lost.
                touched = anything_of(environments, lost=self.loses)
                yield label, loop.with_motor(motor.touching(touched, forced=forced)), Box(touched)
            else:
                for ends in product(*(interval.ends for interval in own.values())):
                    named = [(symbol, *end) for symbol, end in zip(own, ends, strict=True)]
                    labels = "".join(f"/{symbol}-{end}" for symbol, end, _ in named if end)
                    touched = {symbol: Interval.point(value) for symbol, _, value in named}
                    again = motor.touching(touched, forced=forced)
                    yield f"{labels}{label}", loop.with_motor(again), Box(touched)

    def in_contact(
        self, controller: Controller, law: DiscreteLaw, environments: Iterable[Environment]
    ) -> tuple[SampledMode, ...]:
        """Return the motions of a controller in all contacts, and in the air if it has none.

        Position control takes no force, but what it touches is sampled, and may be used by the
        controller after it.
        """
        found: list[SampledMode] = []
        if not controller.contacts:
            for label, loop in self.moved():
                found += loop._corners(law, Box({}), f"{controller.name}{label}")
            environments = environments if self.frame.remembers else ()
        environments = tuple(environments)
        forced = any(FORCE_GAIN in one.numbers for one in self.frame.laws)
        for environment in environments:
            name = f"{controller.name}/{environment.name}"
            for label, loop, box in self.touching(environment, environments, forced=forced):
                found += loop._corners(law, box, f"{name}{label}", environment)
        return tuple(found)

    def in_the_air(self, controller: str, law: DiscreteLaw) -> Iterator[SampledMode]:
        """Yield the motions of a controller that touches nothing."""
        for label, loop in self.moved():
            yield from loop._corners(law, Box({}), f"{controller}/{FREE}{label}")

    def between(self, law: DiscreteLaw, name: str) -> Iterator[SampledMode]:
        """Yield the motions at samples of the motion loop alone, which no force reaches."""
        for label, loop in self.moved():
            yield from loop._of_no_law(law, Turn.MOTION, Box({}), f"{name}{label}")

    def missed(
        self, law: DiscreteLaw, environments: Iterable[Environment]
    ) -> Iterator[SampledMode]:
        """Yield the motions of a period whose deadline is missed, in all contacts or in none."""
        turn, remembers = self.frame.turns[-1], self.frame.longest_delay > 0
        contacts = tuple(environments)
        for environment in contacts:
            for label, loop, box in self.touching(environment, contacts, forced=remembers):
                # The force of a sample that nobody takes matters where it is still on its way.
                kept = box if remembers else Box({})
                name = f"{MISS}/{environment.name}{label}"
                yield from loop._of_no_law(law, turn, kept, name, environment)
        if not contacts:
            for label, loop in self.moved():
                yield from loop._of_no_law(law, turn, Box({}), f"{MISS}/{FREE}{label}")

    def _of_no_law(
        self, law: DiscreteLaw, turn: Turn, box: Box, name: str, touched: Environment | None = None
    ) -> Iterator[SampledMode]:
        """Yield the motions in which nothing of a law is computed."""
        frame = self.frame

        def rows_at(values: Mapping[str, Fraction]) -> list[LinearForm]:
            return frame.rows(law, 0, values, turn)

        box = box.beside(frame.motor.box)
        corners = zip(box.corners(rows_at, name), self._points(box, name, touched), strict=True)
        for (corner, rows), point in corners:
            yield SampledMode.of(corner, rows, len(frame.states), point, begins=False)

    def _points(self, box: Box, name: str, touched: Environment | None) -> Iterator[str]:
        """Yield, for every corner, of which map that is attained it is a corner."""
        motor, attained = self.frame.motor, set(self.frame.motor.attained)
        loaded = motor.drive is not None and motor.drive.loaded
        if not loaded and not (touched is not None and touched.depends):
            attained |= {"k", "b"}
        return box.points(name, attained)

    def _corners(
        self, law: DiscreteLaw, box: Box, name: str, touched: Environment | None = None
    ) -> Iterator[SampledMode]:
        """Yield the motions in one contact, at every delay that makes a difference."""
        box = box.beside(self.frame.motor.box)
        _, values = next(box.named_values(name))
        ages = range(self.delays[0], self.delays[1] + 1)
        # A law that takes no force has the same map at every age of its sample.
        youngest, oldest = (self._rows(law, age, Turn.BOTH, values) for age in self.delays)
        if youngest == oldest:
            ages = ages[:1]
        for turn, delay in product(self.frame.turns, ages):
            if turn is Turn.MOTION or turn.is_miss:
                continue
            late = f"{name}/delay-{delay}" if len(ages) > 1 else name
            late = f"{late}/{turn}" if turn is Turn.ADMITTANCE else late
            rows_at = partial(self._rows, law, delay, turn)
            corners = zip(box.corners(rows_at, late), self._points(box, late, touched), strict=True)
            for (corner, rows), point in corners:
                size = len(self.frame.states)
                yield SampledMode.of(corner, rows, size, point, begins=turn is Turn.BOTH)

    def _rows(
        self, law: DiscreteLaw, delay: int, turn: Turn, values: Mapping[str, Fraction]
    ) -> list[LinearForm]:
        return self.frame.rows(law, delay, values, turn)


def _loss_of_contact(
    contact: str | None, environments: Iterable[Environment], design: ControllerDesign
) -> Loss:
    """Tell how contact is lost; with springs everywhere, free motion is a mode like others."""
    if any(c.law.commands == "position" for c in design.controllers):
        # Force control rests in the air where it does in contact: at what is commanded.
        lost = contact == "losable"
        return "anywhere under force control" if lost else "not under force control"
    sprung = {c.law.spring != 0 for c in design.controllers}
    if contact == "kept" or (True in sprung and contact is None):
        return "never"
    if any(e.preloaded or (e.parts and not e.each_losable) for e in environments):
        return "not modelled"
    return "anywhere" if sprung == {True} else "on the surface"
