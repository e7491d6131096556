"""Outputs of the run in which the pressed axis is released."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from nrs_design.loop.joint import Joint
from nrs_design.models.linear_form import coordinates, zero
from nrs_design.models.motion_loop import realize
from nrs_design.pipeline.certification import Result
from nrs_design.pipeline.design import Designed
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec.interaction_parts import FREE

if TYPE_CHECKING:
    from nrs_design.simulation.release import Outputs

_DEFLECTION = "delta [rad]"
_REFERENCE = "reference [rad]"


def physical_outputs(result: Result) -> Outputs | str | None:
    """Return the physical outputs of that run as rows over the state, with the limits of the spec.

    A text says why there are none; None for given matrices, which have no units.
    """
    designed, system = result.designed, result.certification.system
    if designed is None:
        return None
    # Laws of contact name their states as those of an axis that turns.
    system = replace(system, states=tuple(map(designed.spec.axis.turning, system.states)))
    if (obstacle := _find_obstacle(designed, system)) is not None:
        return obstacle
    if system.time is Time.DISCRETE:
        return _sampled(designed, system)
    if any(c.law.commands == "position" for c in designed.design.controllers):
        return _following_positions(designed, system)
    return _following_velocities(designed, system)


def _find_obstacle(designed: Designed, system: SwitchedSystem) -> str | None:
    """Say why a state does not tell force and velocity, or no run keeps the rules."""
    rules, touched = system.switching, designed.plant.among(designed.design.contacts)
    if not touched:
        return "no contact is declared"
    if system.cases:
        return "the ranges of constants are cut in cases, and a run would mix them"
    if rules.resets:
        return "a switch sets parts of the state anew, which this run does not do"
    if not rules.is_arbitrary and (system.contact is not None or system.clock is not None):
        return "rules of switching beside a loss of contact or two periods are not kept by this run"
    if any(environment.law.has_mass for environment in touched):
        return "the force of a hand with a mass depends on its acceleration, which is no state"
    if not system.is_uniform:
        return "its modes are of different sizes"
    return None


def _sampled(designed: Designed, system: SwitchedSystem) -> Outputs:
    """Return what a sampled loop shows; its state holds velocity and deflection."""
    from nrs_design.loop.free_motion import force_rows

    touched = designed.plant.among(designed.design.contacts)
    states = system.states
    velocity = coordinates(system.order)[states.index("omega [rad/s]")]
    return _outputs(
        designed,
        system,
        list(force_rows(velocity, states, touched)),
        [[float(x) for x in velocity]],
        _unit(system, _DEFLECTION),
        [float(name in (_DEFLECTION, _REFERENCE)) for name in states],
    )


def _following_velocities(designed: Designed, system: SwitchedSystem) -> Outputs:
    """Return what a loop shows whose controllers command velocities."""
    from nrs_design.loop.free_motion import force_rows

    plant, motion = designed.plant, designed.design.motion
    touched = plant.among(designed.design.contacts)
    joint = Joint.of(plant, motion)
    loop = realize(plant.motion_loop(motion.Kp, motion.Kd)) if joint is None else joint.nominal
    first = touched[0].law.states[0]
    pressed = _unit(system, first)
    output = loop.output(system.order)
    rows = list(force_rows(output, system.states, touched))
    velocity = [float(x) for x in output]
    deflection = pressed if first == _DEFLECTION else None
    return _outputs(designed, system, rows, [velocity], deflection, pressed)


def _following_positions(designed: Designed, system: SwitchedSystem) -> Outputs | str:
    """Return what a loop shows in which the motion loop follows a position."""
    from nrs_design.loop.free_motion import force_rows

    plant, motion = designed.plant, designed.design.motion
    touched = plant.among(designed.design.contacts)
    if not all(law.is_spring or law.remembers for e in touched for law in e.corners):
        return "a command moves the axis at once, and the torque of a damper with it"
    joint = Joint.of(plant, motion)
    loop = (
        realize(plant.motion_loop(motion.Kp, motion.Kd)) if joint is None else joint.nominal.placed
    )
    position = loop.output(system.order)
    rows = list(force_rows(zero(system.order), system.states, touched, position))
    deflection = [float(x) for x in position]
    velocity = [
        [
            sum(c * a for c, a in zip(deflection, column, strict=True))
            for column in zip(*A, strict=True)
        ]
        for A in (mode.A.floats() for mode in system.modes)
    ]
    rest, command = loop.pressed
    pressed = [*map(float, rest), *[0.0] * (system.order - loop.order)]
    if _REFERENCE in system.states:
        pressed[system.states.index(_REFERENCE)] = float(command)
    return _outputs(designed, system, rows, velocity, deflection, pressed)


def _unit(system: SwitchedSystem, name: str) -> list[float]:
    return [float(state == name) for state in system.states]


def _outputs(
    designed: Designed,
    system: SwitchedSystem,
    forces: Sequence[RationalMatrix],
    velocity: Sequence[Sequence[float]],
    deflection: Sequence[float] | None,
    pressed: Sequence[float],
) -> Outputs:
    import numpy as np

    from nrs_design.simulation.release import Outputs

    limits = designed.spec.limits
    free = [i for i, mode in enumerate(system.modes) if FREE in mode.name.split("/")[1:]]
    return Outputs(
        np.array([row.floats()[0] for row in forces]),
        np.array(velocity),
        None if deflection is None else np.array(deflection),
        np.array(pressed),
        limits.torque.si,
        limits.velocity.si,
        tuple(i for i, name in enumerate(system.states) if name.endswith("[N*m]")),
        tuple(free),
    )
