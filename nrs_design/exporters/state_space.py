"""Plant, controllers and closed loops as ``StateSpace`` objects of python-control."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nrs_design.pipeline.design import Designed, run_linear_parts
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem

if TYPE_CHECKING:
    from nrs_design.design.linear_parts import LinearPart


@dataclass(frozen=True, slots=True)
class StateSpaces:
    """The parts of one robot axis in continuous time, at nominal values, in SI units."""

    actuator: Any  # From the command, in rpm or V as the spec says, to the position in rad
    # From the commanded velocity in rad/s to the velocity, and likewise for positions.
    motion_loop: Any
    # By name: from the interaction force in N m at the input of the law to its command for the
    # motion loop, in rad/s or, for position commands, in rad.
    controllers: Mapping[str, Any]


def design_state_spaces(designed: Designed) -> StateSpaces:
    """Return the parts of a design; a filter of the force sensor is in none of them."""
    parts = run_linear_parts(designed)
    return StateSpaces(
        _make_part_space(parts.actuator),
        _make_part_space(parts.motion_loop),
        {part.name: _make_part_space(part) for part in parts.controllers},
    )


def mode_state_spaces(system: SwitchedSystem) -> dict[str, Any]:
    """Return every mode of a system by its name.

    Inputs are the disturbances of the system, if it has any, outputs its states; in discrete time
    dt is the sample time in s, or True where a step has no length.
    """
    return {
        mode.name: _make_mode_space(system, index, mode) for index, mode in enumerate(system.modes)
    }


def _make_mode_space(system: SwitchedSystem, index: int, mode: Mode) -> Any:
    n = len(mode.A.numerators)
    A = np.array(mode.A.floats())
    columns = [np.array(channel.columns[index].floats()) for channel in system.channels]
    B = np.hstack(columns) if columns else np.zeros((n, 0))
    dt: float | bool = 0
    if system.time is Time.DISCRETE:
        dt = True if system.sample_time is None else float(system.sample_time)
    return _state_space(mode.name, A, B, np.eye(n), np.zeros((n, B.shape[1])), dt)


def _make_part_space(part: LinearPart) -> Any:
    outputs = [name for name, _ in part.outputs]
    parts = part.A, part.B, part.C, part.D
    return _state_space(part.name, *parts, 0, inputs=[part.input[0]], outputs=outputs)


def _state_space(name: str, *matrices: Any, **labels: Any) -> Any:
    """Return the state space of A, B, C, D and dt."""
    from nrs_design.control_library import control

    # Points in names have a meaning of their own in python-control.
    label = name.replace(".", "_")
    return control.StateSpace(*matrices, remove_useless_states=False, name=label, **labels)
