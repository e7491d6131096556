"""Table of the checks between parts of an interaction design."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import partial
from typing import NamedTuple

from nrs_design.models.drive import CommandInterface
from nrs_design.proof.bounds import rounded_up
from nrs_design.spec import features as has
from nrs_design.spec.check import NO_SUCH, Reference, Row, each, refuse
from nrs_design.spec.combinations import COMBINATIONS
from nrs_design.spec.controllers import names_in, touched_in
from nrs_design.spec.faults import Location
from nrs_design.spec.goals import (
    OF_THE_CERTIFICATE,
    ONLY_FOR,
    GoalsSpec,
)
from nrs_design.spec.interaction_parts import FREE, INTERFACES, MOTION, NOT_CONTROLLERS, OF_CORNERS
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec
from nrs_design.spec.motion import commands_in
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.sampling import LONGEST_DELAY
from nrs_design.spec.scenario_checks import LOGIC_CHECKS, SCENARIO_CHECKS
from nrs_design.spec.switching import switching_checks


def _too_late(spec: Spec) -> tuple[str, str, str, int] | None:
    """Return the longest time to a command, where a dead time makes it too long, and the limit."""
    if spec.late_at is None or spec.late_at[1] != "dead_time" or spec.sampling is None:
        return None
    too_long = spec.late[1] > LONGEST_DELAY * spec.sampling.period.exact
    return (*spec.late_at, rounded_up(spec.late[1]), LONGEST_DELAY) if too_long else None


def _apart(spec: Spec) -> Iterator[tuple[Location, tuple[str, str]]]:
    """Yield controllers that do not touch the environment of their design, and that environment."""
    for name, controller in spec.controllers.items():
        names, own = touched_in(controller.contacts), controller.environment
        if own is not None and own not in names and spec.environments.keys() >= set(names):
            yield ("controllers", name, "contacts"), (name, own)


def _named_environments(spec: Spec) -> Iterator[tuple[Location, Reference]]:
    """Yield the environments that controllers name."""
    for name, controller in spec.controllers.items():
        reference = partial(Reference, "environment", choices=spec.environments)
        if controller.environment is not None:
            at = ("controllers", name, "environment")
            yield at, reference(name=controller.environment)
        # By default the contact is the environment itself.
        if "contacts" in controller.model_fields_set:
            for index, contact in enumerate(controller.contacts):
                for key in names_in(contact):
                    yield ("controllers", name, "contacts", index), reference(name=key)


def _not_freeable(spec: Spec) -> Iterator[tuple[Location, tuple[str, str, str]]]:
    """Yield the gains that are to be free and cannot, with those of their controller that can."""
    for name, given in spec.design.free.items():
        known = _freeable(spec, name)
        for gain, _ in given.given():
            if gain not in known:
                yield ("design", "free", name, gain), (name, gain, ", ".join(known) or "none")


def _freeable(spec: Spec, name: str) -> tuple[str, ...]:
    if name == MOTION:
        loop = spec.motion_loop
        return () if loop is None or loop.transfer_function is not None else ("Kp", "Kd")
    controller = spec.controllers.get(name)
    known = () if controller is None else controller.freeable
    # A spring that is not there has no value to start from.
    return tuple(gain for gain in known if getattr(controller, gain, True) is not None)


def _contact_mix(spec: Spec) -> tuple[str, ...]:
    """Two kinds of controllers, and the controllers whose idle states need a rule."""
    first_name, first = next(iter(spec.controllers.items()))
    for name, controller in spec.controllers.items():
        if controller.commands != first.commands:
            return name, controller.type, first.type, first_name, "impedance"
    if bleeding := has.BLEEDING.find(spec):
        name = str(bleeding)
        return name, spec.controllers[name].type, first.type, first_name, "pi-force"
    return ()


def _other_offset(spec: Spec) -> Iterator[tuple[str, ...]]:
    """Yield controllers whose offset differs from that of the first controller with an offset."""
    offsets = [(name, c.own_offset) for name, c in spec.controllers.items() if c.own_offset]
    return ((*item, *offsets[0]) for item in offsets if item[1] != offsets[0][1])


def _undriven(spec: Spec) -> Iterator[str]:
    """Yield disturbances of samples in a loop without samples."""
    given = () if spec.sampling is not None else spec.disturbances or ()
    return (key for key, value in given if key != "command" and value is not None)


def _understated(spec: Spec) -> Iterator[tuple[str, str, str]]:
    """Yield a noise of readings that is below an error that the spec names elsewhere."""
    # The key of the noise, the place of the error, and its number of parts.
    named = (
        ("angle_noise", "disturbances", "encoder_step", 2),
        ("torque_noise", "disturbances", "force_step", 2),
        ("torque_noise", "sensor", "resolution", 2),
        ("torque_noise", "sensor", "bias", 1),
    )
    said = {"disturbances": spec.disturbances, "sensor": spec.sensor}
    for key, part, name, parts in named if spec.monitoring is not None else ():
        noise: Quantity = getattr(spec.monitoring, key)
        error: Quantity | None = getattr(said[part], name, None)
        if error is not None and noise.not_below < error.not_above / parts:
            yield key, noise.text, f"{'half of ' * (parts > 1)}`{part}: {name}`, {error.text}"


class _Goals(NamedTuple):
    """Goals of all controllers or of one, and the laws with these goals."""

    it: GoalsSpec
    types: Collection[str]
    own: bool
    creeps: bool

    @property
    def keys(self) -> list[str]:
        """The goals that are given, by key."""
        return [key for key, _ in self.it.given()]


def _goals(spec: Spec) -> Iterator[tuple[Location, _Goals]]:
    """Yield the goals of all controllers, and of each."""
    creeps = spec.sensor is not None and spec.sensor.has_errors
    if spec.goals is not None:
        types = {c.type for c in spec.controllers.values() if "goals" in type(c).model_fields}
        yield ("goals",), _Goals(spec.goals, types, False, creeps)
    for name, c in spec.controllers.items():
        if c.goals is not None:
            yield ("controllers", name, "goals"), _Goals(c.goals, {c.type}, True, creeps)


_GOALS = (
    Row[_Goals](
        "{0}",
        lambda g: (key for key in sorted(OF_THE_CERTIFICATE.intersection(g.keys)) if g.own),
        "{0} is a goal for all controllers together",
        "move it to the goals of the spec",
    ),
    Row[_Goals](
        "",
        lambda g: not g.types and set(g.keys) - OF_THE_CERTIFICATE,
        "there is no controller that a goal applies to: they are for impedance and force control",
        "remove goals",
    ),
    Row[_Goals](
        "{0}",
        lambda g: (
            (key, ONLY_FOR[key])
            for key in g.keys
            if g.types and key in ONLY_FOR and ONLY_FOR[key] not in g.types
        ),
        "{0} is for {1} controllers",
        "remove it",
    ),
    Row[_Goals](
        "",
        lambda g: not g.creeps and (g.it.max_creep or g.it.max_creep_angle),
        "a goal for the creep, and no errors of a sensor that the robot creeps by",
        "add `sensor: {{bias: 5e-3 N*m}}`, or remove the goal",
    ),
)


def _about_commands(spec: Spec) -> Iterator[tuple[Location, Quantity | None]]:
    """Yield what is about commands of the motor."""
    yield ("motion_loop", "derivative_gain"), getattr(spec.motion_loop, "derivative_gain", None)
    # A robot that follows streamed commands has no such limit.
    yield ("limits", "command"), None if spec.followed else spec.limits.command
    yield ("disturbances", "friction"), getattr(spec.disturbances, "friction", None)
    for name, run in spec.scenarios.items():
        yield ("scenarios", name, "errors", "friction"), getattr(run.errors, "friction", None)


def _untimed(spec: Spec) -> Iterator[tuple[Location, str]]:
    """Yield dwell times in steps."""
    for at, dwell in spec.switching.dwell_times():
        if dwell.unit != "s":
            yield ("switching", *at), dwell.text


def _weightless(spec: Spec) -> tuple[str, object] | None:
    """Return an admittance without inertia in the hand of someone."""
    hand, inertias = has.HAND.find(spec), {n: c.gains() for n, c in spec.controllers.items()}
    light = (n for n, gains in inertias.items() if "Mt" in gains and not gains["Mt"].min.value)
    name = next(light, None)
    return (name, hand) if hand and name else None


def _constant_over_samples(spec: Spec) -> tuple[str, str, str, str] | None:
    """Return the place of a constant latency whose ends lie between different samples."""
    at = spec.constant_late
    if at is None or spec.sampling is None:
        return None
    low, high, period = *spec.late, spec.sampling.step
    if high <= (low // period + 1) * period:
        return None
    return *at, f"{float(low):g}", f"{float(high):g}"


INTERACTION_CHECKS: tuple[Row[Spec], ...] = (
    # The drive.
    Row(
        "{0}",
        lambda s: (
            (k, other)
            for other in s.drives
            for k in ("actuator", "motion_loop", *s.drives)
            if other in INTERFACES and k != other and getattr(s, k)
        ),
        "{0} stands beside {1}, which says all of how the robot moves",
        "remove {0}, or {1}",
    ),
    Row(
        "",
        lambda s: (k for k in ("actuator", "motion_loop") if not s.takes and not getattr(s, k)),
        "the key `{0}` is missing",
        "say how the robot moves: actuator and motion_loop, or velocity_interface, "
        "position_interface or torque_interface for a robot that takes those",
    ),
    Row(
        "controllers.{0}.type",
        lambda s: (
            n
            for n, c in s.controllers.items()
            if (s.takes is CommandInterface.TORQUE) != c.makes_torques
        ),
        "{0!r} does not fit the drive: controllers of type torque-impedance are for a "
        "torque_interface, and it takes no others",
        "choose the type by what the robot takes",
    ),
    # Names.
    *each(_named_environments, NO_SUCH),
    refuse(
        _not_freeable,
        "{0!r} has no gain {1} that can be free; those that can be: {2}",
        "name motion with Kp or Kd, a force controller with Kp, or Ki, or an impedance controller "
        "with the spring Kt that it is given; Mt and Bt are free by min and max",
    ),
    Row(
        "environments.{0}",
        lambda s: (n for n in s.environments if n == FREE or OF_CORNERS.fullmatch(n)),
        "an environment cannot be called {0!r}: so are the modes without contact, or at the end of "
        "a range",
        "call it by what it is, such as `tissue`",
    ),
    Row(
        "controllers.{0}",
        lambda s: ((n, NOT_CONTROLLERS[n]) for n in s.controllers if n in NOT_CONTROLLERS),
        "a controller cannot be called {0!r}: so are {1}",
        "call it by what it does, such as `insertion`",
    ),
    *switching_checks(
        lambda s: s.switching,
        lambda s: s.contact_names if s.switching.names_contacts else s.controllers,
        "controller",
    ),
    # Controllers.
    refuse(
        _apart,
        "{0!r} is designed for {1!r}, but that is not among its contacts: nothing would be proved "
        "about it there",
        "add {1} to contacts, or design it for one of them",
    ),
    Row(
        "controllers.{0}.type",
        lambda s: s.idle_states is None and _contact_mix(s),
        "{1} is mixed with {2} ({3!r}), and it is not said what the states of {4} controllers do "
        "meanwhile",
        "add `idle_states: {{decay: 20 1/s}}`, or use one kind of controller",
    ),
    Row(
        "idle_states",
        lambda s: has.IDLE.find(s) and not _contact_mix(s),
        "idle_states without impedance controllers beside position or force controllers, or "
        "pi-force controllers beside others",
        "remove idle_states",
    ),
    Row(
        "anti_windup",
        lambda s: s.anti_windup is not None and not any(c.is_leaky for c in s.controllers.values()),
        "anti_windup without a pi-force controller, the only kind with an integral to cut off",
        "remove anti_windup",
    ),
    Row(
        "anti_windup",
        lambda s: s.anti_windup is not None and s.sampling is None,
        "anti_windup is what the processor does at a sample, and no sampling is given",
        "add `sampling: {{period: 2 ms, delay: [0, 1]}}`, or remove anti_windup",
    ),
    Row(
        "controllers.{0}.offset",
        _other_offset,
        "{0!r} has offset {1}, {2!r} has {3}: one state cannot hold both",
        "give all force controllers `offset: {3}`",
    ),
    Row(
        "controllers.{0}.Mt",
        _weightless,
        "{1.name!r} is a hand with a mass, whose force depends on itself where the admittance has "
        "no inertia",
        "give Mt a smallest value above zero",
    ),
    # Goals.
    *each(_goals, *_GOALS),
    # The bound holds for what is declared alone: under friction, of a robot that nobody moves.
    Row(
        "goals.peak_torque",
        lambda s: (
            getattr(s.goals, "peak_torque", None)
            and getattr(s.disturbances, "command", None) is None
        ),
        "peak_torque is wanted, and the bound would be that of a loop without a command",
        "add `disturbances: {{command: 8 deg/s}}`",
    ),
    Row(
        "{0}.{1}",
        _too_late,
        "{2} s from a sample to its command, dead time and latency, is more than {3} periods, and "
        "is not modelled",
        "shorten them, or run the law less often",
    ),
    Row(
        "{0}.{1}.varies",
        _constant_over_samples,
        "a constant time from {2} s to {3} s crosses a sample, and is not modelled as a constant",
        "narrow it to less than a period, from one whole number of periods to the next, or leave "
        "`varies: false` out",
    ),
    Row(
        "{0}.{1}.varies",
        lambda s: (
            at
            for at, times in s.late_times.items()
            if times.is_constant and (s.constant_late is None or (s.sampling and s.sampling.jitter))
        ),
        "{0}.{1} is constant beside what varies: dead time and latency add up, and a jitter moves "
        "both",
        "let all of them vary, or none",
    ),
    Row(
        "goals.delay",
        lambda s: getattr(s.goals, "delay", None) and s.sampling is None,
        "a proof up to a delay is wanted, but the spec has no samples",
        "add `sampling: {{period: 2 ms, delay: [0, 2]}}`, or use min_delay_margin",
    ),
    Row(
        "goals.initial_force",
        lambda s: has.SATURATED.find(s) and not (s.followed or s.limits.command),
        "nothing says where the command of the motor saturates",
        "add `command` to the limits, in {s.command}, for the error that the gains are for",
    ),
    # Disturbances, sensor and the motor.
    Row(
        "disturbances.{0}",
        _undriven,
        "without sampling, {0} is not modelled",
        "add `sampling: {{period: 2 ms, delay: 1}}`, or name the command alone",
    ),
    Row(
        "disturbances.force_step",
        lambda s: s.sensor is not None and getattr(s.disturbances, "force_step", None),
        "the sensor says how far its signal is off, and force_step does, too",
        "move it to `sensor: {{resolution: ...}}`",
    ),
    Row(
        "monitoring.{0}",
        _understated,
        "{1!r} is below {2}",
        "write the largest error of a reading, all causes together",
    ),
    commands_in(lambda s: s.command, _about_commands),
    # Switching and runs.
    *LOGIC_CHECKS,
    *SCENARIO_CHECKS,
    refuse(_untimed, "{0!r} is not a time", "write seconds, such as '2.76 s'"),
    *COMBINATIONS,
)
