"""What a statement about the sampled loop takes for granted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import chain

from nrs_design.axis import AxisType
from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.loop.assumption import Assumption, say
from nrs_design.loop.assumptions import (
    REST,
    UNCOUPLED,
    command_texts,
    contact_texts,
    interval_text,
    motor_text,
    ranges_text,
    rule_texts,
)
from nrs_design.loop.command_timing import CommandTiming
from nrs_design.loop.loop_assumptions import kept_by_laws, tissue_texts
from nrs_design.loop.loss import Loss
from nrs_design.loop.program import SampledProgram
from nrs_design.loop.sampled import SampledLoop
from nrs_design.models.contact.environment import Environment
from nrs_design.models.drive import Drive, Takes
from nrs_design.models.interval import may_change
from nrs_design.models.plant import Plant
from nrs_design.proof.bounds import rounded_down
from nrs_design.proof.text import exact_text
from nrs_design.spec.misses import DeadlinesSpec
from nrs_design.spec.operating import OperatingConditions
from nrs_design.spec.sampling import SamplingSpec


def assume_sampled(
    conditions: OperatingConditions,
    sampling: SamplingSpec,
    plant: Plant,
    loop: SampledLoop,
    laws: Mapping[str, DiscreteLaw],
    design: ControllerDesign,
    loss: Loss,
) -> tuple[Assumption, ...]:
    """Say what holds for the sampled loop of an interaction design."""
    reset = conditions.idle is not None and conditions.idle.reset
    disturbed = conditions.disturbances is not None
    environments, program = plant.among(design.contacts), loop.program
    # Sentences that do not hold for the disturbances of the spec begin with that.
    but = "-disturbed" if disturbed else ""
    inputs = "sampled-position" if loss in (Loss.BY_LAWS, Loss.UNDER_FORCE_CONTROL) else "sampled"
    return (
        *_period_texts(sampling, design),
        *_deadline_texts(sampling.misses),
        *_late_texts(loop.calendar.timing, conditions.constant_late),
        *_jump_texts(plant.drive),
        _delay_text(*sampling.delay),
        _motor_text(plant, loop, conditions.axis, environments),
        *_load_texts(plant, conditions.axis, environments),
        *(map(say, ("friction.period", "at-samples.force")) if disturbed else ()),
        say(f"inputs.{inputs}{but}", rest=REST[loss is Loss.SURFACE]),
        *_spring_texts(program, design),
        *_placed_texts(program, design, reset=reset),
        UNCOUPLED,
        *contact_texts(design),
        say("tissue.linear", ranges_text(environments, conditions.axis)),
        *chain.from_iterable(tissue_texts(e, alone=len(environments) == 1) for e in environments),
        *_loss_texts(loss, design, program),
        say("at-a-switch.sampled", states="All other states are" if reset else "States are"),
        *(
            rule_texts(conditions.switching, "controller")
            if sampling.misses is None
            else (say("any-signal.in-time"),)
        ),
        say("numbers.coefficients", coefficients=_coefficients(program, laws)),
        *(() if design.takes else command_texts(design.command, design.axis)),
        say(
            "arithmetic.rounding",
            counts=", ".join(f"{n} {k}" for n, k in program.counts.items()),
        ),
        _angle_text(conditions.largest_angle, conditions.axis),
        say(f"not-quantized.{'sensor' if conditions.sensed else 'sampled'}{but}"),
    )


def _period_texts(sampling: SamplingSpec, design: ControllerDesign) -> Iterator[Assumption]:
    """Say when what is computed."""
    period, outer = exact_text(sampling.period.exact), exact_text(sampling.outer)
    jitter = exact_text(sampling.unsteady)
    if sampling.round == 1:
        if sampling.jitter is None:
            yield say("period.single", f"{period} s, exactly", period=period)
        else:
            yield say("period.jitter", f"{period} s +- {jitter} s", period=period, jitter=jitter)
        return
    filtered = "" if design.sensor.filter is None else ", the filter of the force"
    steady, exactly = "Neither has jitter", "exactly"
    if sampling.jitter is not None:
        steady = f"A period of the faster one lasts up to {jitter} s more or less at every sample"
        exactly = f"+- {jitter} s at a sample"
    bound = f"{period} s and {outer} s, {exactly}"
    said = {"period": period, "outer": outer, "filtered": filtered, "steady": steady}
    yield say("period.double", bound, **said)
    yield say("period.order", "the order that is named")


def _deadline_texts(misses: DeadlinesSpec | None) -> Iterator[Assumption]:
    """Say how many deadlines are missed, and what happens then."""
    if misses is not None:
        yield say(f"deadlines.{misses.command}", f"at most {misses}", rule=misses)


def _late_texts(timing: CommandTiming, constant: str | None) -> Iterator[Assumption]:
    """Say when commands take effect, unless they do so at once."""
    earliest, late = exact_text(timing.earliest), exact_text(timing.latest)
    if not timing.latest:
        return
    if timing.earliest == timing.latest:
        yield say("command-age.fixed", f"{late} s, exactly", late=late)
    elif constant is not None:
        yield say("command-age.constant", f"{earliest} s to {late} s", earliest=earliest, late=late)
    else:
        yield say("command-age.range", f"{earliest} s to {late} s", earliest=earliest, late=late)


def _jump_texts(drive: Drive | None) -> Iterator[Assumption]:
    """Say what a sample shows of a velocity that jumps at that moment."""
    if drive is not None and drive.speed is not None:
        yield say("command-age.before", "the order that is named")


def _motor_text(
    plant: Plant, loop: SampledLoop, axis: AxisType, environments: Sequence[Environment]
) -> Assumption:
    ranges, timing = plant.actuator_ranges, loop.calendar.timing
    motor, tau = motor_text(ranges, axis), ranges.time_constant
    corner = "a corner of that, of no motor of the range"
    if timing.varies:
        corner = "a corner of that, of no motor and no times of the ranges"
    elif tau.low == tau.high:
        corner = "a point of that, which differs in what is rounded to 64 binary digits"
    moving = ranges.may_change("at every sample, not in between")
    if plant.slowed:
        return say("motor.loaded", motor, motor=motor, moving=moving)
    if plant.drive is not None:
        return _drive_text(plant.drive, axis, environments)
    if loop.program.step.streams:
        lag = motor.partition(" and its time constant ")[2]
        return say("motor.followed", lag, motor=lag, moving=moving, corner=corner)
    return say(
        "nominal-motor.sampled" if ranges.fixed else "motor.sampled",
        motor,
        motor=motor,
        moving=moving,
        corner=corner,
    )


def _load_texts(
    plant: Plant, axis: AxisType, environments: Sequence[Environment]
) -> Iterator[Assumption]:
    """Say what loads the motor, unless that is what a drive says of itself."""
    if not plant.held.loaded:
        yield say("unloaded.sampled")
    elif plant.drive is None and plant.load_inertia is not None:
        inertia = f"{exact_text(plant.load_inertia)} {axis.unit('kg*m^2')}"
        yield say("load.sampled", inertia, inertia=inertia, but=_but_constant(environments))


def _but_constant(environments: Sequence[Environment]) -> str:
    touched = chain.from_iterable(environment.ranges for environment in environments)
    return ", but for what is constant" * any(number.is_constant for number in touched)


def _drive_text(drive: Drive, axis: AxisType, environments: Sequence[Environment]) -> Assumption:
    """Say how a robot moves that has no motor of the user's."""
    moving = may_change(drive.ranges.values(), "at every sample, not in between")
    if drive.takes is Takes.TORQUE:
        inertia = f"{interval_text(drive.ranges['J'])} {axis.unit('kg*m^2')}"
        friction = f"{interval_text(drive.ranges['B'])} {axis.unit('N*m*s/rad')}"
        bound = f"J {inertia}, B {friction}"
        but = _but_constant(environments)
        said = {"inertia": inertia, "friction": friction, "moving": moving, "but": but}
        return say("motor.torque", bound, **said)
    if "tau" in drive.ranges:
        lag = f"{interval_text(drive.ranges['tau'])} s"
        return say("motor.followed-position", lag, lag=lag, moving=moving)
    return say("motor.followed-function", what=str(drive.takes))


def _spring_texts(program: SampledProgram, design: ControllerDesign) -> Iterator[Assumption]:
    if any(c.law.spring for c in design.controllers):
        yield say("spring.shared" if program.idle is None else "spring.idle")
        yield say("spring.sample")


def _placed_texts(
    program: SampledProgram, design: ControllerDesign, *, reset: bool
) -> Iterator[Assumption]:
    """Say what position and force controllers do, and what the others do meanwhile."""
    if all(c.law.commands == "velocity" for c in design.controllers):
        return
    streams = program.step.streams
    yield say(f"rest-position.{'streamed' if streams else 'sampled'}")
    if streams and program.idle is not None:
        yield say("rest-position.streamed-beside")
    if not all(c.contacts for c in design.controllers):
        yield say("contacts.in-position", "what other controllers touch")
    for text in dict.fromkeys(c.law.sampled_text for c in design.controllers):
        if text:
            yield say("idle.sampled-law", text=text)
    if any(c.law.bleeds for c in design.controllers):
        others = dict.fromkeys(c.law.name for c in design.controllers if not c.law.bleeds)
        if others and program.idle is not None:
            decay = exact_decimal(program.idle)
            yield say("idle.sampled-bleeding", others=" or ".join(others), decay=decay)
    moving = [c.law for c in design.controllers if c.law.commands == "velocity"]
    if program.idle is None or not moving:
        return
    what = "velocity vm and reference" if any(law.states for law in moving) else "the reference"
    yield say("idle.sampled", what=what, decay=exact_decimal(program.idle))
    if reset:
        yield say("at-a-switch.sampled-zeroed")


def _loss_texts(
    loss: Loss, design: ControllerDesign, program: SampledProgram
) -> Iterator[Assumption]:
    """Say how contact is lost; on the surface, a statement that covers it says so."""
    if loss is Loss.BY_LAWS:
        yield from kept_by_laws(design, alone=program.idle is None)
    elif loss is not Loss.SURFACE:
        yield say(loss.value)


def _angle_text(angle: Fraction | None, axis: AxisType) -> Assumption:
    if angle is None:
        return say("arithmetic.angles-left-out")
    largest = rounded_down(angle, axis.unit("rad"))
    return say("arithmetic.angles", f"angles within {largest}", largest=largest)


def _delay_text(least: int, most: int) -> Assumption:
    oldest = f"{most} sample{'s' * (most != 1)}"
    if least < most:
        return say("sample-age.range", f"{least} to {oldest}", least=least, most=oldest)
    return say("sample-age.fixed" if most else "sample-age.now", oldest, most=oldest)


def _coefficients(program: SampledProgram, laws: Mapping[str, DiscreteLaw]) -> str:
    texts = [f"Kp = {exact_decimal(program.step.Kp)}", f"Kd/T = {exact_decimal(program.step.D)}"]
    texts, known = [] if program.step.takes else texts, program.listed.law.coefficient
    for name, law in laws.items():
        symbols = zip(law.numbers, law.coefficients.items(), strict=True)
        coefficients = (said for key, said in symbols if key in known)
        texts += [f"{key} of {name} = {exact_decimal(c)}" for key, c in coefficients]
    return ", ".join(texts)
