"""Assumptions about the loop of an interaction design, sampled or in continuous time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.gains import idle_decay
from nrs_design.controllers.laws import LAWS, CompliantLaw, DiscreteLaw
from nrs_design.loop.assumptions import COMMAND_UNIT, assume, assume_rules
from nrs_design.loop.free_motion import Loss
from nrs_design.loop.program import SampledProgram
from nrs_design.loop.sampled import SampledLoop
from nrs_design.loop.shared_state import REFERENCE, SharedState
from nrs_design.models.axis import AxisType
from nrs_design.models.contact.environment import Environment
from nrs_design.models.drive import CommandInterface
from nrs_design.models.interval import moving
from nrs_design.models.plant import Plant
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.bounds import rounded_down
from nrs_design.proof.text import exact_text
from nrs_design.spec import IdleStatesSpec, SwitchingSpec
from nrs_design.spec.build_plant import OperatingConditions
from nrs_design.spec.sampling import SamplingSpec
from nrs_design.spec.units import THESIS_COMMAND

UNCOUPLED = assume("uncoupled.axes")


# Assumption about sample times. Keys: single period, and no jitter.
_PERIODS = {
    (True, True): "period.single",
    (True, False): "period.jitter",
    (False, True): "period.double",
    (False, False): "period.double-jitter",
}


def assume_loop(
    loop: SharedState, rules: SwitchingSpec, *, losable: bool, free: bool, has_saturation: bool
) -> Iterator[Assumption]:
    """Yield the assumptions about an interaction design.

    `losable`: the system says how contact is lost, and a statement whether it is kept; `free`: free
    motion is one of the modes; `has_saturation`: some statement is about signals that saturate.
    """
    design = loop.design
    yield from _assume_motion(loop)
    yield from _assume_inputs(loop, losable=losable)
    yield UNCOUPLED
    yield from _assume_contacts(design)
    if loop.feels and not all(c.contacts for c in design.controllers):
        yield assume("contacts.in-position")
    yield from _assume_parts(loop.environments)
    tissue_id = "tissue.linear" if loop.offset == "none" else "tissue.offset"
    yield _assume_tissue(loop.environments, design.axis, tissue_id)
    integrated = any(c.law.commands == "velocity" for c in design.controllers)
    if integrated and all(e.law.has_rest for e in loop.environments):
        yield assume("at-a-switch.deflection")
    for e in loop.environments:
        yield from e.law.assumptions(e.name, is_only=len(loop.environments) == 1)
    yield from () if loop.idle is None else _assume_idle(loop, loop.idle)
    # If contact may be lost, each statement says whether it covers the loss.
    if free:
        yield assume("contact-lost.anywhere")
    elif not losable:
        yield from _assume_kept_contact(design, uniform=loop.idle is None)
    reset = (loop.idle is not None and loop.idle.reset) or loop.offset == "measured"
    scope = "others" if reset else "all"
    if rules.is_arbitrary:
        yield assume("at-a-switch.any-signal", which=scope)
    else:
        yield assume("at-a-switch.continuous", which=scope)
        yield from assume_rules(rules, "mode" if rules.names_contacts else "controller")
        if not rules.names_contacts and rules.dwell_time is None:
            yield assume("any-signal.environment")
    yield assume(f"not-sampled{'-but-limited' if has_saturation else ''}.continuous")
    yield assume("numbers.gains")
    yield from _assume_command_unit(design.command, design.axis)


def _assume_motion(loop: SharedState) -> Iterator[Assumption]:
    """Yield the model of the motion loop and of its load."""
    joint, axis = loop.joint, loop.design.axis
    if joint is None:
        yield assume(f"nominal-motor.{'given' if loop.is_stated else 'designed'}")
        return
    motor = "nominal-motor.joint" if joint.ranges.fixed else "motor.joint"
    yield assume(motor, **joint.ranges.assumed(axis))
    if joint.load_inertia is None:
        yield assume("unloaded.continuous")
    else:
        inertia = f"{exact_text(joint.load_inertia)} {axis.unit('kg*m^2')}"
        yield assume("load.inertia", inertia=inertia)


def _assume_inputs(loop: SharedState, *, losable: bool) -> Iterator[Assumption]:
    """Yield the inputs, and the equilibria for zero inputs."""
    if loop.offset != "none":
        yield assume("rest-position.moving")
        yield assume("at-a-switch.offset", taken=loop.offset)
        if loop.offset == "measured":
            yield assume("at-a-switch.lead")
            yield assume("at-a-switch.kick")
        yield assume("inputs.constant")
        return
    yield assume("inputs.continuous", rest="contact" if losable else "always")
    sprung = any(c.law.spring for c in loop.design.controllers)
    yield assume("inputs.bounded", also=sprung and "bounded", air=losable and "open")
    if sprung:
        yield assume("spring.shared" if loop.idle is None else "spring.idle")


def _assume_idle(loop: SharedState, idle: IdleStatesSpec) -> Iterator[Assumption]:
    """Yield the evolution of idle states of impedance controllers, and of an idle integral."""
    label, laws = loop.design.axis.label, [c.law for c in loop.design.controllers]
    decay = idle_decay(idle)
    rate = decay and exact_decimal(decay)
    driving = _names(law for law in laws if law.commands == "velocity")
    others = _names(law for law in laws if law.commands == "position")
    if driving:
        kind, states = "decay" if decay else "held", map(label, (*loop.law.states, REFERENCE))
        yield assume(
            f"idle.{kind}", driving=driving, others=others, states=tuple(states), decay=rate
        )
    if (law := next((law for law in laws if law.is_leaky), None)) is not None:
        yield assume(
            "idle.integral" if decay else "idle.held-integral",
            others=_names(law for law in laws if not law.is_leaky),
            states=tuple(map(label, law.states)),
            law=law.name,
            decay=rate,
        )
    if idle.reset and driving:
        yield assume("at-a-switch.zeroed", driving=driving, others=others)
    yield assume("rest-position.commanded")
    yield assume("at-a-switch.kick")


def _names(laws: Iterable[CompliantLaw]) -> tuple[str, ...]:
    """Return the distinct names of some laws."""
    return tuple(dict.fromkeys(law.name for law in laws))


def assume_sampled_loop(
    conditions: OperatingConditions,
    sampling: SamplingSpec,
    plant: Plant,
    loop: SampledLoop,
    laws: Mapping[str, DiscreteLaw],
    design: ControllerDesign,
    loss: Loss,
) -> Iterator[Assumption]:
    """Yield the assumptions about the sampled loop of an interaction design."""
    reset = conditions.idle is not None and conditions.idle.reset
    disturbed = conditions.disturbances is not None
    environments, program = plant.select_environments(design.contacts), loop.program
    timing, axis = loop.calendar.timing, conditions.axis
    extra = disturbed and "disturbances"
    single, steady = sampling.round == 1, sampling.jitter is None
    yield assume(
        _PERIODS[single, steady],
        period=exact_text(sampling.period.exact),
        jitter=not steady and exact_text(sampling.unsteady),
        outer=not single and exact_text(sampling.outer),
        sampled=not single and design.sensor.filter and "filter",
    )
    if not single:
        yield assume("period.order")
    if (misses := sampling.misses) is not None:
        limit, steps = misses.window
        yield assume(f"deadlines.{misses.command}", at_most=limit, of=steps)
    if timing.latest:
        fixed, constant = timing.earliest == timing.latest, conditions.constant_delay_key
        kind = "fixed" if fixed else "range" if constant is None else "constant"
        earliest = not fixed and exact_text(timing.earliest)
        yield assume(f"command-age.{kind}", earliest=earliest, late=exact_text(timing.latest))
    if plant.drive is not None and plant.drive.speed is not None:
        # The velocity jumps when a command takes effect.
        yield assume("command-age.before")
    lowest, highest = sampling.delay
    kind, oldest = "fixed" if highest else "now", f"{highest} sample{'s' * (highest != 1)}"
    if lowest < highest:
        yield assume("sample-age.range", least=lowest, most=oldest)
    else:
        yield assume(f"sample-age.{kind}", most=oldest)
    but = "constant" if any(r.is_constant for e in environments for r in e.ranges) else ""
    yield from _assume_motor(plant, loop, axis, but)
    if disturbed:
        yield assume("friction.period")
        yield assume("at-samples.force")
    is_position = loss in (Loss.LAW_SPECIFIC, Loss.UNDER_FORCE_CONTROL)
    yield assume(
        "inputs.sampled",
        beyond=extra,
        inputs="position" if is_position else "velocity",
        place=is_position and "position",
        rest="contact" if loss is Loss.SURFACE else "always",
    )
    if any(c.law.spring for c in design.controllers):
        spring_id = "spring.shared" if program.idle is None else "spring.idle"
        velocity = program.step.interface is CommandInterface.VELOCITY
        yield from map(assume, ["spring.measured"] if velocity else [spring_id, "spring.sample"])
    yield from _assume_positions(program, design, reset=reset)
    yield UNCOUPLED
    yield from _assume_contacts(design)
    yield _assume_tissue(environments, axis)
    for e in environments:
        yield from e.law.assumptions(e.name, is_only=len(environments) == 1)
    # Statements say themselves whether they cover contact loss at the surface.
    if loss is Loss.LAW_SPECIFIC:
        yield from _assume_kept_contact(design, uniform=program.idle is None)
    elif loss is not Loss.SURFACE:
        yield assume(loss.value)
    yield assume("at-a-switch.sampled", which="others" if reset else "all")
    if misses is None:
        yield from assume_rules(conditions.switching, "controller")
    else:
        yield assume("any-signal.in-time")
    yield from _assume_arithmetic(conditions, program, laws, design)
    yield assume(
        "not-quantized.sampled",
        beyond=extra,
        quantized="encoder" if conditions.sensed else "sensors",
        saturation="left-out" if conditions.initial_force is None else "stated",
    )
    yield from _assume_parts(environments)


def _assume_motor(
    plant: Plant, loop: SampledLoop, axis: AxisType, but: str
) -> Iterator[Assumption]:
    """Yield the model of the motor, or of the robot, and its load; `but` says what is constant."""
    ranges, inertia = plant.actuator_ranges, plant.load_inertia
    drive = plant.drive
    numbers = (ranges.gain, ranges.time_constant) if drive is None else drive.ranges.values()
    # Parameters change at samples only.
    moves = f"{kind}-sampled" if (kind := moving(numbers)) else ""
    motor = ranges.assumed(axis) | {"moving": moves}
    if drive is not None and drive.interface is CommandInterface.TORQUE:
        J = f"{drive.ranges['J'].text} {axis.unit('kg*m^2')}"
        B = f"{drive.ranges['B'].text} {axis.unit('N*m*s/rad')}"
        yield assume("motor.torque", J=J, B=B, moving=moves, but=but)
    elif drive is not None and "tau" in drive.ranges:
        tau = f"{drive.ranges['tau'].text} s"
        yield assume("motor.followed-position", tau=tau, moving=moves)
    elif drive is not None:
        yield assume("motor.followed-function", what=drive.interface)
    elif plant.slowed:
        yield assume("motor.loaded", **motor)
    else:
        known = ranges.time_constant.low == ranges.time_constant.high
        varies = loop.calendar.timing.varies
        motor["corner"] = "times" if varies else "point" if known else "motor"
        if loop.program.step.streams:
            del motor["gain"]
            yield assume("motor.followed", **motor)
        else:
            yield assume("nominal-motor.sampled" if ranges.fixed else "motor.sampled", **motor)
    if not plant.zoh_drive.loaded:
        yield assume("unloaded.sampled")
    elif drive is None and inertia is not None:
        weight = f"{exact_text(inertia)} {axis.unit('kg*m^2')}"
        yield assume("load.sampled", inertia=weight, but=but)


def _assume_positions(
    program: SampledProgram, design: ControllerDesign, *, reset: bool
) -> Iterator[Assumption]:
    """Yield the behaviour of position and force controllers, and of idle states."""
    laws = [c.law for c in design.controllers]
    moving = [law for law in laws if law.commands == "velocity"]
    if len(moving) == len(laws):
        return
    streams = program.step.streams
    yield assume(f"rest-position.{'streamed' if streams else 'sampled'}")
    if streams and program.idle is not None:
        yield assume("rest-position.streamed-beside")
    if not all(c.contacts for c in design.controllers):
        yield assume("contacts.in-position")
    yield from map(assume, dict.fromkeys(law.sampled for law in laws if law.sampled))
    if program.idle is None:
        return
    decay = exact_decimal(program.idle)
    others = _names(law for law in laws if not law.is_leaky)
    if others and any(law.is_leaky for law in laws):
        yield assume("idle.sampled-bleeding", others=others, decay=decay)
    if moving:
        left = "all" if any(law.states for law in moving) else "reference"
        yield assume("idle.sampled", left=left, decay=decay)
        if reset:
            yield assume("at-a-switch.sampled-zeroed")


def _assume_arithmetic(
    conditions: OperatingConditions,
    program: SampledProgram,
    laws: Mapping[str, DiscreteLaw],
    design: ControllerDesign,
) -> Iterator[Assumption]:
    """Yield the coefficients of the program, and its roundings."""
    step, known = program.step, program.operation_list.law.coefficient
    gains = {} if step.interface else {"Kp": step.Kp, "Kd/T": step.D}
    gains |= {
        f"{symbol} of {name}": number
        for name, law in laws.items()
        for key, (symbol, number) in zip(law.numbers, law.coefficients.items(), strict=True)
        if key in known
    }
    texts = tuple(f"{name} = {exact_decimal(number)}" for name, number in gains.items())
    yield assume("numbers.coefficients", coefficients=texts)
    if not design.takes:
        yield from _assume_command_unit(design.command, conditions.axis)
    counts = tuple(f"{name} {count}" for name, count in program.counts.items())
    yield assume("arithmetic.rounding", counts=counts)
    if (angle := conditions.largest_angle) is None:
        yield assume("arithmetic.angles-left-out")
    else:
        largest = rounded_down(angle, conditions.axis.unit("rad"))
        yield assume("arithmetic.angles", largest=largest)


def _assume_contacts(design: ControllerDesign) -> Iterator[Assumption]:
    """Yield the environments that each controller may contact."""
    for c in design.controllers:
        if c.contacts:
            yield assume("contacts.controller", controller=c.name, contacts=tuple(c.contacts))


def _assume_parts(environments: Iterable[Environment]) -> Iterator[Assumption]:
    """Yield the assumptions about environments in simultaneous contact."""
    for e in environments:
        if e.parts:
            kind = "contacts.one-side" if e.each_losable else "contacts.at-once"
            yield assume(kind, environment=e.name, parts=tuple(part.name for part in e.parts))


def _assume_tissue(
    environments: Sequence[Environment], axis: AxisType, name: str = "tissue.linear"
) -> Assumption:
    """Return the parameter ranges of the environments."""
    ranges = [
        f"{e.name}: {symbol} {interval.description} {axis.unit(unit)}"
        for e in environments
        for symbol, interval, unit in zip(
            e.law.parameters(), e.ranges, e.law.units(rotational=True), strict=True
        )
    ]
    return assume(name, ranges=tuple(ranges))


def _assume_kept_contact(design: ControllerDesign, *, uniform: bool) -> Iterator[Assumption]:
    """Yield the assumption of each control law about contact.

    `uniform`: all controllers give the motion loop the same kind of command.
    """
    names = {controller.law.name for controller in design.controllers}
    laws = [law for name, law in LAWS.items() if name in names]
    # Among velocity commands alone there is no mode of free motion.
    ids = ("never" if uniform and a.commands == "velocity" else a.contact_kept for a in laws)
    yield from (assume(f"contact-kept.{id}") for id in ids if id is not None)


def _assume_command_unit(command: str, axis: AxisType) -> Iterator[Assumption]:
    """Yield the unit of the motor command, if it is not rpm."""
    if command != THESIS_COMMAND:
        yield assume(COMMAND_UNIT, unit=command, per=axis.unit("rad"))
