"""Plant, controllers and closed loops as ``StateSpace`` objects of python-control."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from nrs_design.controllers.laws import CompliantLaw
from nrs_design.pipeline import Designed
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem

Rows = Sequence[Sequence[Fraction]]


@dataclass(frozen=True, slots=True)
class StateSpaces:
    """The parts of one robot axis in continuous time, at nominal values, in SI units.

    Parameters
    ----------
    actuator : control.StateSpace
        From the command, in rpm or V as the spec says, to the position in rad.
    motion_loop : control.StateSpace
        From the commanded velocity in rad/s to the velocity, and likewise for positions.
    controllers : mapping of str to control.StateSpace
        By name: from the force of the environment in N m, as the law gets it, to what the law adds
        to the command of the motion loop, in rad/s or, for laws that command a position, in rad.
    """

    actuator: Any
    motion_loop: Any
    controllers: Mapping[str, Any]


def design_state_spaces(designed: Designed) -> StateSpaces:
    """Return the parts of a design; a filter of the force sensor is in none of them."""
    plant, motion = designed.plant, designed.design.motion
    Km, tau = plant.actuator.gain, plant.actuator.time_constant
    loop = plant.motion_loop(motion.Kp, motion.Kd)
    return StateSpaces(
        _of_transfer((Km,), (tau, Fraction(1), Fraction(0)), "actuator", "speed", "position"),
        _of_transfer(loop.numerator, loop.denominator, "motion_loop", "command", "motion"),
        {item.name: _of_law(item.law, item.name) for item in designed.design.controllers},
    )


def mode_state_spaces(system: SwitchedSystem) -> dict[str, Any]:
    """Return every mode of a system by its name.

    Inputs are the disturbances of the system, if it has any, outputs its states; in discrete time
    dt is the sample time in s, or True where a step has no length.
    """
    return {mode.name: _of_mode(system, index, mode) for index, mode in enumerate(system.modes)}


def _of_mode(system: SwitchedSystem, index: int, mode: Mode) -> Any:
    n = len(mode.A.numerators)
    A = _array(mode.A.fractions())
    columns = [_array(channel.columns[index].fractions()) for channel in system.channels]
    B = np.hstack(columns) if columns else np.zeros((n, 0))
    dt: float | bool = 0
    if system.time is Time.DISCRETE:
        dt = True if system.sample_time is None else float(system.sample_time)
    return _state_space(A, B, np.eye(n), np.zeros((n, B.shape[1])), dt, name=_plain(mode.name))


def _of_law(law: CompliantLaw, name: str) -> Any:
    """Return a law; where it has a spring, the offset q that the spring acts on is a state."""
    own, spring = len(law.states), law.spring
    size = own + (spring != 0) + 1
    forms = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    force = list(forms[-1])
    if spring:
        force[own] -= spring
    command, rates = law.respond(force, forms[:own])
    if spring:
        rates = [*rates, [-entry for entry in command]]
    rows = np.zeros((size, size))
    rows[: len(rates)] = _array(rates) if rates else 0.0
    rows[-1] = _array([command])
    A, B, C, D = rows[:-1, :-1], rows[:-1, -1:], rows[-1:, :-1], rows[-1:, -1:]
    return _state_space(A, B, C, D, 0, name=_plain(name), inputs=["force"], outputs=[law.commands])


def _of_transfer(
    numerator: Sequence[Fraction],
    denominator: Sequence[Fraction],
    name: str,
    command: str,
    response: str,
) -> Any:
    """Return the controllable canonical form of a strictly proper transfer function."""
    n, leading = len(denominator) - 1, denominator[0]
    A, B, C = np.eye(n, k=1), np.zeros((n, 1)), np.zeros((1, n))
    A[-1] = [float(-c / leading) for c in reversed(denominator[1:])]
    B[-1] = 1.0
    C[0, : len(numerator)] = [float(c / leading) for c in reversed(numerator)]
    return _state_space(
        A, B, C, np.zeros((1, 1)), 0, name=name, inputs=[command], outputs=[response]
    )


def _state_space(A: Any, B: Any, C: Any, D: Any, dt: float | bool, **names: Any) -> Any:
    from nrs_design.control_library import control

    return control.StateSpace(A, B, C, D, dt, remove_useless_states=False, **names)


def _array(rows: Rows) -> Any:
    return np.array([[float(entry) for entry in row] for row in rows])


def _plain(name: str) -> str:
    """Return a name that python-control takes: it has its own use for points."""
    return name.replace(".", "_")
