"""Reasons to doubt a spec that is valid: warnings, not errors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nrs_design.proof.bounds import rounded_up
from nrs_design.spec.plausible import doubt_sizes
from nrs_design.spec.quantity import is_less

if TYPE_CHECKING:
    from nrs_design.spec.interaction import InteractionDesignSpec
    from nrs_design.spec.load import Spec

# Beyond a force that a motion begins with, in limits of the torque, another unit was likely meant.
_HARDEST = 10


@dataclass(frozen=True, slots=True)
class Doubt:
    """Something that is allowed, and probably not meant."""

    at: tuple[str, ...]  # Keys that lead to it in the spec
    message: str  # What is doubtful; one line

    def __str__(self) -> str:
        """Return the message."""
        return self.message


def doubt_spec(spec: Spec) -> Iterator[Doubt]:
    """Yield what is doubtful about a spec, before anything is designed."""
    yield from (Doubt(at, text) for at, text in doubt_sizes(spec))
    if spec.kind != "interaction-design":
        return
    for at, item in spec.identified.items():
        if item.doubts and item.accept_doubt is None:
            yield Doubt(
                (*at, "doubts"),
                f"the identification of {at[-1]} is in doubt, and nothing says why that is "
                "accepted (record again, or add accept_doubt)",
            )
    for name in spec.environments:
        if name not in spec.touched:
            yield Doubt(
                ("environments", name),
                f"environment {name} is touched by no controller, so nothing is shown about it "
                "(list it in the contacts of a controller, or remove it)",
            )
    yield from _doubt_thresholds(spec)
    yield from _doubt_command(spec)
    yield from _doubt_initial_force(spec)
    yield from _doubt_bounds(spec)
    yield from _doubt_continuous(spec)


def _doubt_thresholds(spec: InteractionDesignSpec) -> Iterator[Doubt]:
    """Yield thresholds that the torque reaches only where it is too large already."""
    logic = None if spec.mode_logic is None else spec.mode_logic.thresholds
    limit = spec.limits.torque
    if logic is None:
        return
    for index, switch in enumerate(logic.switches, 1):
        torque = switch.torque
        if torque is None or torque.above is None:
            continue
        if torque.above.not_below > limit.not_above:
            yield Doubt(
                ("mode_logic", "switches"),
                f"switch {index} of the mode logic, from {switch.source} to {switch.target}, waits "
                f"for a torque of {torque.above.text}, above limits.torque of {limit.text} (lower "
                "the threshold by noise and by what the torque moves in its age)",
            )


def _doubt_command(spec: InteractionDesignSpec) -> Iterator[Doubt]:
    """Yield a limit of the command that holds the axis below the speed it has to reach."""
    limits, gain = spec.limits, spec.actuator.gain
    if limits.command is None:
        return
    reached = gain.range[1].not_above * limits.command.not_above
    if reached < limits.velocity.not_below:
        yield Doubt(
            ("limits", "command"),
            f"at limits.command of {limits.command.text} the motor turns at "
            f"{rounded_up(reached)} rad/s at most, below limits.velocity of "
            f"{limits.velocity.text}: the axis cannot follow a command at that limit (raise "
            "limits.command, or lower limits.velocity)",
        )


def _doubt_initial_force(spec: InteractionDesignSpec) -> Iterator[Doubt]:
    """Yield a wanted force that is out of proportion: some more than the limit is the very use."""
    force, limit = None if spec.goals is None else spec.goals.initial_force, spec.limits.torque
    if force is None or isinstance(force, str) or force.exact <= _HARDEST * limit.exact:
        return
    yield Doubt(
        ("goals", "initial_force"),
        f"goals.initial_force of {force.text} is more than {_HARDEST} times limits.torque of "
        f"{limit.text}: is that its unit? (what is shown is that motions from there decay, not "
        "that the torque is within its limit; write `largest` for as much as is found)",
    )


def _doubt_bounds(spec: InteractionDesignSpec) -> Iterator[Doubt]:
    """Yield what will not be proved beside two periods, and bounds that commands may leave."""
    two = spec.sampling is not None and spec.sampling.round > 1
    if two and spec.disturbances is not None:
        yield Doubt(
            ("disturbances",),
            "beside an outer_period, the decay of the undisturbed loop is proved, and no bound "
            "under disturbances (bounds of the loop without outer_period are listed; or remove "
            "disturbances)",
        )
    if two and spec.coupling is not None:
        yield Doubt(
            ("coupling",),
            "beside an outer_period, nothing is proved of axes that act on each other (what is "
            "proved without the one or the other is listed; or remove outer_period or coupling)",
        )
    command = None if spec.disturbances is None else spec.disturbances.command
    limit = spec.limits.velocity
    if command is not None and is_less(command, limit):
        yield Doubt(
            ("disturbances", "command"),
            f"bounds are for velocity commands up to {command.text}, and limits.velocity lets them "
            f"be {limit.text}: beyond the first, no bound holds (raise the first, or lower "
            "limits.velocity)",
        )


def _doubt_continuous(spec: InteractionDesignSpec) -> Iterator[Doubt]:
    """Yield what can be designed, but not proved, where there is no sampling."""
    if spec.sampling is not None:
        return
    others = [name for name, c in spec.controllers.items() if c.commands != "velocity"]
    memories = sorted(name for name in spec.touched if spec.environments[name].remembers)
    sprung = [name for name, c in spec.controllers.items() if "Kt" in c.gains()]
    end = "so certify-switching refuses this spec"
    if spec.contact == "losable" and (beside := (*others, *memories)):
        yield Doubt(
            ("contact",),
            f"in continuous time, loss of contact is not modelled beside {beside[0]}, {end} (use "
            "`contact: kept`; for position and force controllers, add sampling)",
        )
    commanded = spec.disturbances is not None and spec.disturbances.command is not None
    if commanded and (beside := (*others, *memories, *sprung)):
        yield Doubt(
            ("disturbances", "command"),
            f"a bound under a velocity command is not modelled beside {beside[0]}, {end} (leave "
            "command out)",
        )
    restless = [name for name in memories if not spec.environments[name].has_rest]
    if sprung and restless:
        yield Doubt(
            ("environments", restless[0], "model"),
            f"{restless[0]} has no rest position, and {sprung[0]} has a spring Kt: not modelled, "
            f"{end} (leave Kt out, or use another environment)",
        )
