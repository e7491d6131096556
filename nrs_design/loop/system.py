"""The switched system of a sampled loop: modes, disturbances, roundings and contact loss."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product

from nrs_design.controllers.controller_design import SHARED_STATES, ControllerDesign
from nrs_design.controllers.float32 import float32_not_above
from nrs_design.controllers.gains import idle_share
from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.controllers.step_analysis import rounding_share
from nrs_design.controllers.step_law import StepFrame
from nrs_design.errors import AssemblyError
from nrs_design.loop.calendar import Calendar, CommandTiming, turns_of
from nrs_design.loop.constraints import (
    assemble_switching,
    clock_of,
    count_stays,
    leaving_impedance,
    zeroing,
)
from nrs_design.loop.flow import HeldDrive
from nrs_design.loop.free_motion import (
    Loss,
    could_pull,
    flights_of,
    force_rows,
    lost_on_surface,
    outputs_of,
)
from nrs_design.loop.located import ConstantParameter, LocatedMode, enclosures_of, grouped
from nrs_design.loop.loop_assumptions import assume_sampled_loop
from nrs_design.loop.program import (
    FORCE_ERROR,
    INPUTS,
    ROUNDED_ANGLE,
    ROUNDED_REFERENCE,
    SampledProgram,
)
from nrs_design.loop.sampled import NOTHING, SampledLoop
from nrs_design.loop.sampled_modes import Modes
from nrs_design.loop.saturation import add_sampled_saturation
from nrs_design.models.drive import Drive
from nrs_design.models.linear_form import ONE, ZERO, LinearForm, coordinates
from nrs_design.models.plant import Plant
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.channels import Channel, Output, Rounding
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import IdleStatesSpec
from nrs_design.spec.build_plant import OperatingConditions
from nrs_design.spec.misses import automaton_of
from nrs_design.spec.motion import MOTOR_COMMAND
from nrs_design.spec.sampling import SamplingSpec


def close_sampled_loop(
    conditions: OperatingConditions,
    plant: Plant,
    design: ControllerDesign,
    constants: Sequence[ConstantParameter] = (),
    *,
    points: bool = False,
) -> tuple[SwitchedSystem, Sequence[LocatedMode]]:
    """Return the system of a sampled loop, and its modes.

    `points`: of drives at the ends of their ranges, instead of the enclosure of all drives.
    """
    sampling = conditions.sampling
    assert sampling is not None
    if (odd := sampling.find_odd_periods()) is not None:
        raise AssemblyError(odd, remedy="change both periods", at=("sampling", "outer_period"))
    laws = {
        c.name: c.law.discretize(sampling.outer, sampling.admittance) for c in design.controllers
    }
    environments = plant.select_environments(design.contacts)
    if points:
        # The rates of a memory depend on its stiffness: their ends belong to no loop.
        environments = tuple(e.scaled(ZERO) if e.law.has_memory else e for e in environments)
        # Saturation is stated for the enclosure of all drives.
        conditions = replace(conditions, initial_force=None)
    drive = plant.contact_drive(environments)
    loop = _wired(conditions, sampling, drive, design, tuple(laws.values()))
    held_drive = HeldDrive(drive, loop.calendar.timing)
    loss = Loss.classify(conditions.contact, environments, design, slowed=plant.slowed)
    builder = Modes(
        loop,
        held_drive,
        environments,
        tuple(constants),
        # A controller that names no contacts may be in any contact.
        loss.anywhere or not all(c.contacts for c in design.controllers),
        tuple(held_drive.points()) if points else (),
    )
    modes, free = builder.list_modes(design.controllers, laws, loss)
    items = (*modes, *free)
    channels = tuple(_channels(conditions, design.sensor.lasting, items))
    velocity = coordinates(len(loop.states))[loop.states.index(drive.states[0])]
    tensions = tuple(force_rows(velocity, loop.states, could_pull(environments)))
    outputs = outputs_of(velocity, loop.states, environments, conditions.torque) if channels else ()
    if drive.speed is not None:
        # The velocity jumps after the sample, and with it a damped force.
        damped = any(environment.load[1].high for environment in environments)
        outputs = () if damped else tuple(one for one in outputs if one.name == "force")
    # Points are at the period itself, where a dwell time has more samples.
    period = sampling.step if points else sampling.longest_step
    clock, rules, counts = count_stays(conditions.switching, grouped(items), period)
    driven, unlimited = _motor_command(
        conditions.largest_command, conditions.command, loop, channels
    )
    system = SwitchedSystem(
        name=conditions.name,
        time=Time.DISCRETE,
        states=loop.states,
        modes=tuple(item.mode for item in modes),
        assumptions=(
            *assume_sampled_loop(conditions, sampling, plant, loop, laws, design, loss),
            *unlimited,
            *counts,
        ),
        switching=assemble_switching(rules, grouped(modes), _resets(conditions.idle, loop, design)),
        contact=lost_on_surface((item.mode for item in free), tensions, conditions.contact)
        if free
        else None,
        sample_time=sampling.longest_step,
        channels=channels,
        outputs=(*outputs, *driven),
        roundings=tuple(_roundings(loop, channels, items)),
        clock=_clock(sampling, items) or clock,
        flights=flights_of(modes, environments, tensions) if loss.anywhere else None,
        enclosures=tuple(enclosures_of(items)),
    )
    if conditions.initial_force is not None:
        system = add_sampled_saturation(system, conditions, loop, items, environments)
    return system, modes


def _wired(
    conditions: OperatingConditions,
    sampling: SamplingSpec,
    drive: Drive,
    design: ControllerDesign,
    laws: tuple[DiscreteLaw, ...],
) -> SampledLoop:
    """Return program, drive and calendar of a loop; force samples are kept if a law takes them.

    An `AssemblyError` if the controllers share no state.
    """
    idle, low_pass, motion = conditions.idle, design.sensor.filter, design.motion
    if (odd := design.find_odd_states(is_mixture=idle is not None)) is not None:
        raise AssemblyError(
            f"{odd}, so their modes share no state", remedy=SHARED_STATES, at=("controllers",)
        )
    filtered = None if low_pass is None else low_pass.discretize(sampling.outer)
    step = StepFrame(
        motion.Kp, motion.difference_gain(sampling.period.exact), filtered, interface=design.takes
    )
    program = SampledProgram(step, laws, None if idle is None else idle_share(idle, sampling.outer))
    timing = CommandTiming(sampling.step, *conditions.command_delay, sampling.unsteady)
    calendar = Calendar(timing, turns=turns_of(sampling))
    loop = SampledLoop(program, drive, calendar)
    if not loop.takes_force:
        return loop
    return replace(loop, calendar=replace(calendar, ages=sampling.delay))


def _resets(
    idle: IdleStatesSpec | None, loop: SampledLoop, design: ControllerDesign
) -> Iterator[tuple[str, str, RationalMatrix]]:
    """Yield the switches at which impedance controllers leave no state behind."""
    if idle is not None and idle.reset:
        map_ = zeroing(loop.states, ("reference [rad]", "vm [rad/s]"))
        yield from ((*pair, map_) for pair in leaving_impedance(design.controllers))


def _clock(sampling: SamplingSpec, items: Iterable[LocatedMode]) -> Clock | None:
    """Return the clock of rounds, or of missed deadlines."""
    first_modes = tuple(item.name for item in items if item.starts_round)
    if sampling.misses is not None:
        return clock_of(automaton_of(*sampling.misses.window), first_modes)
    return Clock(sampling.round, first_modes) if sampling.round > 1 else None


def _channels(
    conditions: OperatingConditions, off: Fraction, items: Sequence[LocatedMode]
) -> Iterator[Channel]:
    """Yield disturbances, and errors of the sensor: `off`, in N m, is the lasting one of force."""
    if conditions.disturbances is None:
        return
    bounds = dict(conditions.disturbances)
    if (angle := conditions.largest_angle) is not None:
        # An angle of the law is read from a count, times a coefficient.
        for name, n in ((ROUNDED_REFERENCE, 1), (ROUNDED_ANGLE, 3)):
            bounds[name] = (rounding_share(n) * angle, "rad")
    if off:
        bounds[FORCE_ERROR] = (off, "N*m")
    for i, name in sorted((INPUTS.index(name), name) for name in bounds):
        bound, unit = bounds[name]
        yield Channel(name, unit, bound, tuple(item.column(i) for item in items))


def _roundings(
    loop: SampledLoop, channels: Sequence[Channel], items: Sequence[LocatedMode]
) -> Iterator[Rounding]:
    """Yield what the arithmetic adds, with rows over the states and the declared disturbances."""
    n, names = len(loop.states), {channel.name for channel in channels}
    places = [*range(n), *(n + i for i, name in enumerate(INPUTS) if name in names)]
    for j, name in enumerate(loop.program.roundings):
        sizes = (item.period.sizes[j] for item in items)
        rows = (RationalMatrix.from_rows([[size[i] for i in places]]) for size in sizes)
        columns = (item.column(len(INPUTS) + j) for item in items)
        yield Rounding(name, tuple(columns), tuple(rows))


def _motor_command(
    largest: Fraction | None, unit: str, loop: SampledLoop, channels: Sequence[Channel]
) -> tuple[tuple[Output, ...], tuple[Assumption, ...]]:
    """Return the command under disturbances, roundings included, and its assumption.

    While the command stays below its limit, the driver does only what the model says: so a bound
    from rest, below the limit, excludes saturation under the same disturbances.
    Impedance controllers change the reference after the command, so it is the same form of the
    states in all modes. A rounding is at most a share of other forms, so the command is a mixture
    of rows in which every share is added or subtracted. Nothing without disturbances or a limit, or
    for other controllers.
    """
    moving = all(law.law.commands == "velocity" for law in loop.program.laws)
    if largest is None or not channels or not moving or loop.calendar.holds:
        return (), ()
    sample = loop.sample(loop.program.laws[0], loop.calendar.ages[0], NOTHING)
    form, n = sample.command, len(loop.states)
    end = n + len(INPUTS)
    bounds = {channel.name: channel.bound for channel in channels}
    shares = list(zip(form[end:], sample.sizes, strict=True))
    # Largest change of the command by disturbances of its own sample.
    inputs = [(ONE, form[n:end]), *((abs(c), size[n:end]) for c, size in shares)]
    direct = sum((c * _largest(row, bounds) for c, row in inputs), ZERO)
    roundings = [[c * v for v in size[:n]] for c, size in shares if c and any(size[:n])]
    rows = tuple(
        RationalMatrix.from_rows([[sum(column) for column in zip(form[:n], *signed, strict=True)]])
        for signed in product(*([row, [-v for v in row]] for row in roundings))
    )
    limit = float32_not_above(largest)
    left = limit - direct
    name = f"{MOTOR_COMMAND} before errors of its sample" if direct else MOTOR_COMMAND
    output = Output(name, unit, rows, left if left > 0 else None)
    assumption = Assumption.create(
        "not-quantized.command",
        limit=rounded_down(limit, unit),
        less=direct > 0 and "errors",
        at_once=direct > 0 and rounded_up(direct, unit),
        output=name,
    )
    return (output,), (assumption,)


def _largest(form: LinearForm, bounds: dict[str, Fraction]) -> Fraction:
    """Return the largest value of a form of the inputs; inputs without a bound are zero."""
    sizes = (abs(c) * bounds.get(name, ZERO) for name, c in zip(INPUTS, form, strict=True))
    return sum(sizes, ZERO)
