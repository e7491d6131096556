"""Table of settings of an interaction design that are allowed but probably not meant."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import isclose, sqrt

from nrs_design.proof.bounds import rounded_up
from nrs_design.spec import features as has
from nrs_design.spec.check import Feature, Row, not_together, refuse
from nrs_design.spec.faults import Location
from nrs_design.spec.interaction_parts import AbstractInteractionSpec as Spec
from nrs_design.spec.quantity import is_less

# Largest distance of given gains from the desired loop that counts as rounding.
_NEAR = 0.05
# Beyond a force that a motion begins with, in limits of the torque, another unit was likely meant.
_HARDEST = 10


def _doubted(spec: Spec) -> Iterator[tuple[Location, str]]:
    """Yield identified values with doubts that are not accepted."""
    for at, item in spec.identified.items():
        if item.doubts and item.accept_doubt is None:
            yield (*at, "doubts"), at[-1]


def _slow(spec: Spec) -> str | None:
    """Return the speed at the limit of the command, if the axis has to be faster."""
    if spec.limits.command is None or spec.actuator is None:
        return None
    reached = spec.actuator.gain.range[1].not_above * spec.limits.command.not_above
    return rounded_up(reached) if reached < spec.limits.velocity.not_below else None


def _older(spec: Spec) -> tuple[str, str] | None:
    """Return a wanted delay that no force sample has, so that no proof is about it."""
    delay, sampling = getattr(spec.goals, "delay", None), spec.sampling
    if delay is None or sampling is None or sampling.oldest >= delay.exact:
        return None
    return delay.text, rounded_up(sampling.oldest, "s")


def _late_threshold(spec: Spec) -> Iterator[tuple[object, ...]]:
    """Yield thresholds that the torque reaches only where it is too large already."""
    logic = spec.mode_logic
    limit = spec.limits.torque
    for index, switch in enumerate(() if logic is None else logic.switches, 1):
        above = None if switch.torque is None else switch.torque.above
        if above is not None and above.not_below > limit.not_above:
            yield index, switch.source, switch.target, above.text, limit.text


def _hard(spec: Spec) -> tuple[str, str] | None:
    """Return a wanted force that is out of proportion: some more than the limit is the very use."""
    force, limit = getattr(spec.goals, "initial_force", None), spec.limits.torque
    if force is None or isinstance(force, str) or force.exact <= _HARDEST * limit.exact:
        return None
    return force.text, limit.text


def _left(spec: Spec) -> tuple[str, str] | None:
    """Return a disturbance that commands may leave, and their limit."""
    command = getattr(spec.disturbances, "command", None)
    if command is None or not is_less(command, spec.limits.velocity):
        return None
    return command.text, spec.limits.velocity.text


def _other_loop(spec: Spec) -> tuple[str, str, str, str] | None:
    """Return the desired damping ratio and settling time of the PD, and those of given gains."""
    loop, motor = spec.motion_loop, spec.actuator
    if loop is None or motor is None or loop.derivative_gain is None or loop.zero is None:
        return None
    tau, Kd = motor.time_constant.nominal.si, motor.gain.nominal.si * loop.derivative_gain.si
    ratio, settling = (1 + Kd) / (2 * sqrt(tau * Kd * loop.zero.si)), 8 * tau / (1 + Kd)
    wanted = float(loop.damping_ratio), loop.settling_time.si
    if all(isclose(*pair, rel_tol=_NEAR) for pair in zip(wanted, (ratio, settling), strict=True)):
        return None
    asked = f"{wanted[0]:.6g}", loop.settling_time.text
    return (*asked, f"{ratio:.3g}", f"{settling:.4g} s")


def _unbounded(part: Feature[Spec], what: str) -> Row[Spec]:
    """Return the row of what lets decay be proved, and no bound."""
    return Row(
        "disturbances",
        lambda s: part.find(s) and has.DISTURBED.find(s),
        f"beside {what}, the decay of the undisturbed loop is proved, and no bound under "
        "disturbances",
        "remove disturbances, or expect no bound",
    )


def _unproved(*features: Feature[Spec]) -> Row[Spec]:
    """Return the row of what can be designed, but not proved, in continuous time."""
    form = "{}: not modelled, so certify-switching refuses this spec"
    return not_together(*features, has.CONTINUOUS, form=form)


INTERACTION_DOUBTS: tuple[Row[Spec], ...] = (
    refuse(
        _doubted,
        "the identification of {0} is in doubt, and nothing says why that is accepted",
        "record again, or add accept_doubt",
    ),
    refuse(
        lambda s: ((("environments", n), n) for n in s.environments if n not in s.touched),
        "environment {0} is touched by no controller, so nothing is shown about it",
        "list it in the contacts of a controller, or remove it",
    ),
    Row(
        "goals.delay",
        _older,
        "goals.delay is {0}, and force samples are declared to be at most {1} old",
        "declare a longer sampling.delay, relax the goal, or let `optimize` choose gains for it",
    ),
    Row(
        "limits.command",
        _slow,
        "at limits.command of {s.limits.command.text} the motor turns at {0} rad/s at most, below "
        "limits.velocity of {s.limits.velocity.text}: the axis cannot follow a command at that "
        "limit",
        "raise limits.command, or lower limits.velocity",
    ),
    _unbounded(has.TWO_PERIODS, "an outer_period"),
    _unbounded(has.MISSES, "missed deadlines"),
    Row(
        "motion_loop",
        _other_loop,
        "motion_loop asks for a damping ratio of {0} and a settling time of {1}, but with the "
        "derivative_gain and zero that are given the loop that ships has {2} and {3}",
        "write those, or leave out derivative_gain and zero",
    ),
    Row(
        "disturbances.command",
        _left,
        "bounds are for velocity commands up to {0}, and limits.velocity lets them be {1}: beyond "
        "the first, no bound holds",
        "raise the first, or lower limits.velocity",
    ),
    *map(partial(_unproved, has.LOSABLE), (has.OTHERS, has.MEMORY)),
    *map(partial(_unproved, has.COMMAND), (has.OTHERS, has.MEMORY, has.SPRUNG)),
    _unproved(has.RESTLESS, has.SPRUNG),
    Row(
        "mode_logic.switches",
        _late_threshold,
        "switch {0} of the mode logic, from {1} to {2}, waits for a torque of {3}, above "
        "limits.torque of {4}",
        "lower the threshold by noise and by what the torque moves in its age",
    ),
    Row(
        "goals.initial_force",
        _hard,
        f"goals.initial_force of {{0}} is more than {_HARDEST} times limits.torque of {{1}}: is "
        "that its unit?",
        "what is shown is that motions from there decay, not that the torque is within its limit; "
        "write `largest` for as much as is found",
    ),
)
