"""Runs that look bad: below a proved bound, beside a proved rate, or without either."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from sys import float_info
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Illustration, Section
from nrs_design.reporting.figures.run import MOTION_STATES, draw_phase_plane, draw_run
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.admissible import active_norms, admissible_run
from nrs_design.simulation.norms import quadratic_norm
from nrs_design.simulation.rounds import norms_in_rounds, worst_rounds
from nrs_design.simulation.switched import (
    SwitchedRun,
    fine_step,
    norms,
    worst_direction,
    worst_switching,
)

if TYPE_CHECKING:
    from nrs_design.simulation.norms import Array, Norm

    Bound = tuple[str, Array]

# The bound falls by e^7, three decades, where that takes no more steps than are drawn.
_DECAY = 7.0
_STEPS = 4000
_FEWEST = 500
# Below this fraction of the start the run is cut: the rest would squeeze the bound flat.
_SMALL = 1e-6
# Modes times squared states that a run of so many steps can try in about a second.
_EFFORT = 200_000
_UNKNOWN_STEPS = 600
# A run that keeps rules tries every allowed switch at every step.
_RULED_MODES = 24
_RULED_STEPS = 1500
GREEDY = (
    "Simulated run from the slowest direction: at every step the adversary takes the mode after "
    "which the norm is largest. It is a bad run, not the worst one."
)
RULED = (
    "Simulated run that keeps the declared rules: the adversary stays, or switches when it may, "
    "whichever loses the least of the norm per time. It is a bad run, not the worst one."
)
_HOLDS = "The dashed line is the bound of the certificate, which holds for every switching signal."
PATH = "Path of the state, one color for each active mode."
EUCLIDEAN = "|x(t)| / |x(0)|, Euclidean norm [1]"
AGAINST = "Switching against the proved bound"
BESIDE = "Switching beside the proved rate"
_TITLE = "Simulated switching"


def simulated(*figures: Illustration) -> Section:
    """Return the section of a run that no evidence of instability asks for."""
    return Section(_TITLE, figures)


def witness(*blocks: Block) -> Section:
    """Return the section of a run that shows instability."""
    return Section("Simulated witness", blocks)


def bounded_run(
    system: SwitchedSystem,
    hardest: SwitchedSystem,
    norm: Norm,
    initial: Array,
    rate: float,
    label: str,
    note: str = "",
    levels: tuple[float, ...] = (1.0,),
) -> Section:
    """Let the greedy adversary run under arbitrary switching, and draw it below its bound.

    Parameters
    ----------
    system, hardest : SwitchedSystem
        All modes, and those that take part.
    norm : callable
        Root of the Lyapunov function.
    initial : ndarray, shape (n,)
        Where the run begins.
    rate : float
        The proved one.
    label : str
        Which norm it is, such as ``in the norm of Q``.
    note : str
        A sentence of the caption about the run, with a blank after it.
    levels : tuple of float
        Level curves to draw in the plane, relative to the start.
    """
    step, steps = horizon(hardest, rate)
    response = worst_switching(hardest, norm, initial, step, steps)
    response = until_small(response, norms(response, norm))
    run = Illustration(
        "run",
        AGAINST,
        f"{GREEDY} {note}{_HOLDS}{freely(system)}{some_modes(system, hardest)}",
        draw_run(
            response,
            norms(response, norm),
            bound_line(response, rate, system.time, "proved bound, "),
            hardest,
            f"|x(t)| / |x(0)| {label} [1]",
        ),
    )
    return simulated(run, *phase_plane(hardest, response, norm, levels))


def ruled_run(
    system: SwitchedSystem, functions: Mapping[str, Array], rate: float
) -> tuple[SwitchedSystem, SwitchedRun, Array]:
    """Let the adversary run that keeps the declared rules.

    Parameters
    ----------
    system : SwitchedSystem
        Modes and rules.
    functions : mapping
        A positive definite matrix for each mode, by name.
    rate : float
        The proved one.

    Returns
    -------
    SwitchedSystem, SwitchedRun, ndarray of shape (k,)
        The modes that take part, the run, and the norm of the active mode along it.
    """
    hardest = hardest_modes(system, None, _RULED_MODES)
    step, steps = horizon(hardest, rate)
    response = admissible_run(hardest, functions, step, min(steps, _RULED_STEPS))
    response = until_small(response, active_norms(hardest, response, functions))
    return hardest, response, active_norms(hardest, response, functions)


def unbounded_run(system: SwitchedSystem) -> Section:
    """Draw a bad run of a system of which nothing is proved."""
    if system.clock is not None:
        return _unbounded_rounds(system)
    arbitrary = system.switching.is_arbitrary
    hardest = hardest_modes(system, None, trials_per_step(system) if arbitrary else _RULED_MODES)
    step = fine_step(hardest)
    functions = euclidean(hardest)
    if arbitrary:
        norm, identity = quadratic_norm(np.eye(system.order)), np.eye(system.order)
        initial = worst_direction(hardest, identity)
        response = worst_switching(hardest, norm, initial, step, _UNKNOWN_STEPS)
    else:
        response = admissible_run(hardest, functions, step, _UNKNOWN_STEPS)
    run = Illustration(
        "run",
        "One bad run",
        f"{GREEDY if arbitrary else RULED} There is no bound: nothing is proved. Decay in this "
        "run is no sign of stability, and growth over a short time is no proof of instability."
        f"{some_modes(system, hardest)}",
        draw_run(response, active_norms(hardest, response, functions), None, hardest, EUCLIDEAN),
    )
    return simulated(run, *phase_plane(hardest, response, None))


def _unbounded_rounds(system: SwitchedSystem) -> Section:
    """Draw a bad run in kept contact of modes that take turns."""
    kept, norm = replace(system, contact=None), quadratic_norm(np.eye(system.order))
    norms = [norm] * (1 if system.clock is None else system.clock.length)
    response = worst_rounds(kept, norms, np.eye(system.order)[-1], _UNKNOWN_STEPS)
    run = Illustration(
        "run",
        "One bad run",
        "Simulated run in kept contact from a deflection: at every step the adversary takes the "
        "mode, of those whose turn it is, after which the Euclidean norm is largest. There is no "
        "bound: nothing is proved.",
        draw_run(response, norms_in_rounds(response, norms), None, kept, EUCLIDEAN),
    )
    return simulated(run)


def euclidean(system: SwitchedSystem) -> dict[str, Array]:
    """Return the identity as the function of every mode."""
    return {mode.name: np.eye(mode.A.shape[0]) for mode in system.modes}


def euclidean_norms(response: SwitchedRun) -> Array:
    """Return the norm of the states along a run, relative to the start."""
    values = np.linalg.norm(response.state, axis=1)
    return np.asarray(values / values[0])


def bound_line(response: SwitchedRun, rate: float, time: Time, label: str) -> Bound:
    """Return how a rate decays along the times of a run, with its label.

    Parameters
    ----------
    response : SwitchedRun
        With the times.
    rate : float
        The alpha in 1/s, or rho per step.
    time : Time
        Which of the two.
    label : str
        What stands before the formula.
    """
    if time is Time.CONTINUOUS:
        return f"{label}exp(-alpha t)", np.exp(-rate * response.time)
    return f"{label}rho^t", rate**response.time


def trials_per_step(system: SwitchedSystem) -> int:
    """Return how many modes a greedy run can try at every step."""
    return max(8, min(256, _EFFORT // system.order**2))


def until_small(response: SwitchedRun, values: Array) -> SwitchedRun:
    """Cut a run where it has come to rest for all that can be seen."""
    small = np.flatnonzero(values < _SMALL)
    if not len(small):
        return response
    end = max(int(small[0]), 2)
    return SwitchedRun(response.time[: end + 1], response.state[: end + 1], response.mode[:end])


def horizon(system: SwitchedSystem, claimed: float) -> tuple[float, int]:
    """Return step and number of steps in which the bound falls by three decades, if few enough."""
    rate = claimed if system.time is Time.CONTINUOUS else -math.log(claimed)
    # A contraction of 1 - 1e-21 is 1 in floating point.
    rate = max(rate, float_info.min)
    step = fine_step(system)
    steps = math.ceil(min(_DECAY / (rate * step), float(_STEPS)))
    if system.time is Time.CONTINUOUS and steps < _FEWEST:
        steps = _FEWEST
        step = _DECAY / rate / steps
    return step, max(steps, 10)


def phase_plane(
    system: SwitchedSystem,
    response: SwitchedRun,
    norm: Norm | None,
    levels: tuple[float, ...] = (),
) -> tuple[Illustration, ...]:
    """Draw a run of two states, with the level curves that it cannot leave, if there are any.

    Parameters
    ----------
    system : SwitchedSystem
        The modes.
    response : SwitchedRun
        The run.
    norm : Norm or None
        Whose level curve bounds it.
    levels : tuple of float
        Of the curves that are drawn.
    """
    inside = " It cannot leave the dashed level curve of V." if norm is not None else ""
    if len(levels) > 1:
        inside += " The dotted ones are level curves further in: no run crosses one outward."
    return plane(system, response, f"{inside}{jumps(system)}", norm, levels)


def plane(
    system: SwitchedSystem,
    response: SwitchedRun,
    more: str = "",
    norm: Norm | None = None,
    levels: tuple[float, ...] = (),
) -> tuple[Illustration, ...]:
    """Draw a run of two states with more words in its caption; nothing for other numbers.

    Parameters
    ----------
    system, response, norm, levels
        As for `phase_plane`.
    more : str
        Words for the end of the caption.
    """
    if system.order != 2 or not system.is_uniform:
        return ()
    return (
        Illustration(
            "phase-plane",
            "The same run in the plane of the two states",
            f"{PATH} {plane_axes(system)}{more}",
            draw_phase_plane(response, system, norm, levels),
        ),
    )


def plane_axes(system: SwitchedSystem) -> str:
    """Say what the axes of a plane of two states are."""
    first, second = system.states
    if system.states == MOTION_STATES:
        return (
            f"The axes are the two states themselves, no projection: {first} and {second} of the "
            f"motion loop G in controllable canonical form, {first}' = {second}, which have no "
            "unit of their own."
        )
    return (
        f"The axes are the two states themselves, no projection: {first} and {second} in the "
        "coordinates of the matrices that the spec gives."
    )


def jumps(system: SwitchedSystem) -> str:
    """Say how resets are drawn, if there are any."""
    return " A reset is drawn with the step before it." if system.switching.resets else ""


def freely(system: SwitchedSystem) -> str:
    """Say that the run needs no rules, if any are declared."""
    if system.switching.is_arbitrary:
        return ""
    return " The run switches freely, which is more than the spec allows."


def some_modes(system: SwitchedSystem, hardest: SwitchedSystem) -> str:
    """Say how many modes take part, if not all."""
    if len(hardest.modes) == len(system.modes):
        return ""
    return f" Only the {len(hardest.modes)} slowest modes take part."
