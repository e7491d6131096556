"""A run that looks bad: under its proved bound, or growing where stability is refuted."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.certificates.evidence import AbstractEvidence, CommonQuadratic, UnstableMode
from nrs_design.reporting.document import Illustration, Section
from nrs_design.reporting.figures.run import draw_phase_plane, draw_run
from nrs_design.reporting.sections.modes import hardest_modes, scaled_matrix
from nrs_design.simulation.switched import (
    TimeResponse,
    fine_step,
    norms,
    unstable_run,
    worst_direction,
    worst_switching,
)
from nrs_design.switched.system import SwitchedSystem, Time

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.simulation.switched import Array

# The bound falls by e^7, three decades, where that takes no more steps than are drawn.
_DECAY = 7.0
_STEPS = 4000
_FEWEST = 500
# Below this fraction of the start the run is cut: the rest would squeeze the bound flat.
_SMALL = 1e-6
# Modes times squared states that a run of so many steps can try in about a second.
_EFFORT = 200_000
_UNKNOWN_STEPS = 600
_GREEDY = (
    "Simulated run from the slowest direction: at every step the adversary takes the mode after "
    "which the norm is largest. It is a bad run, not the worst one."
)


def run_section(system: SwitchedSystem, evidence: AbstractEvidence | None) -> Section:
    """Simulate one run and draw it.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    evidence : CommonQuadratic, UnstableMode or None
        Decides what is shown: a run under its bound, a run that grows, or a run alone.
    """
    if isinstance(evidence, UnstableMode):
        return Section("Simulated witness", _witness(system, evidence))
    if isinstance(evidence, CommonQuadratic):
        return Section("Simulated switching", _bounded(system, evidence))
    return Section("Simulated switching", _unbounded(system))


def _bounded(system: SwitchedSystem, evidence: CommonQuadratic) -> tuple[Illustration, ...]:
    Q, rate = scaled_matrix(evidence), float(evidence.rate)
    hardest = hardest_modes(system, Q, _affordable(system))
    continuous = system.time is Time.CONTINUOUS
    step, steps = _horizon(hardest, rate if continuous else -math.log(rate))
    response = worst_switching(hardest, Q, worst_direction(hardest, Q), step, steps)
    response = _until_small(response, Q)
    bound = (
        ("proved bound, exp(-alpha t)", np.exp(-rate * response.time))
        if continuous
        else ("proved bound, rho^t", rate**response.time)
    )
    run = Illustration(
        "run",
        "Switching against the proved bound",
        f"{_GREEDY} The dashed line is the bound of the certificate, which holds for every "
        f"switching signal.{_some(system, hardest)}",
        _draw(hardest, response, Q, bound, "|x(t)| / |x(0)| in the norm of Q [1]"),
    )
    return (run, *_phase_plane(hardest, response, Q))


def _unbounded(system: SwitchedSystem) -> tuple[Illustration, ...]:
    hardest = hardest_modes(system, None, _affordable(system))
    identity = np.eye(system.order)
    initial = worst_direction(hardest, identity)
    response = worst_switching(hardest, identity, initial, fine_step(hardest), _UNKNOWN_STEPS)
    run = Illustration(
        "run",
        "One bad run",
        f"{_GREEDY} There is no bound: nothing is proved. Decay in this run is no sign of "
        "stability, and growth over a short time is no proof of instability."
        f"{_some(system, hardest)}",
        _draw(hardest, response, identity, None, "|x(t)| / |x(0)|, Euclidean norm [1]"),
    )
    return (run, *_phase_plane(hardest, response, None))


def _witness(system: SwitchedSystem, evidence: UnstableMode) -> tuple[Illustration, ...]:
    index = next(i for i, mode in enumerate(system.modes) if mode.name == evidence.mode)
    response = unstable_run(system, index)
    identity = np.eye(system.order)
    growth = _growth(system, index, response)
    run = Illustration(
        "run",
        f"Staying in mode {evidence.mode}",
        f"Simulated from the eigenvector of the eigenvalue {evidence.eigenvalue}: the state does "
        "not decay. No other mode is used, which the switching allows.",
        _draw(system, response, identity, growth, "|x(t)| / |x(0)|, Euclidean norm [1]"),
    )
    return (run, *_phase_plane(system, response, None))


def _growth(system: SwitchedSystem, index: int, response: TimeResponse) -> tuple[str, Array]:
    """Return how the worst eigenvalue of a mode grows by itself, with its label."""
    values = np.linalg.eigvals(np.array(system.modes[index].A.floats()))
    if system.time is Time.CONTINUOUS:
        rate = float(values.real.max())
        return f"the eigenvalue alone, exp({rate:.4g} t)", np.exp(rate * response.time)
    factor = float(np.abs(values).max())
    return f"the eigenvalue alone, {factor:.4g}^t", factor**response.time


def _affordable(system: SwitchedSystem) -> int:
    return max(8, min(256, _EFFORT // system.order**2))


def _until_small(response: TimeResponse, Q: Array) -> TimeResponse:
    """Cut a run where it has come to rest for all that can be seen."""
    small = np.flatnonzero(norms(response, Q) < _SMALL)
    if not len(small):
        return response
    end = max(int(small[0]), 2)
    return TimeResponse(response.time[: end + 1], response.state[: end + 1], response.mode[:end])


def _horizon(system: SwitchedSystem, rate: float) -> tuple[float, int]:
    """Return step and number of steps in which the bound falls by three decades, if few enough."""
    step = fine_step(system)
    steps = math.ceil(min(_DECAY / (rate * step), float(_STEPS)))
    if system.time is Time.CONTINUOUS and steps < _FEWEST:
        steps = _FEWEST
        step = _DECAY / rate / steps
    return step, max(steps, 10)


def _draw(
    system: SwitchedSystem,
    response: TimeResponse,
    Q: Array,
    bound: tuple[str, Array] | None,
    label: str,
) -> Figure:
    return draw_run(response, norms(response, Q), bound, system, label)


def _phase_plane(
    system: SwitchedSystem, response: TimeResponse, Q: Array | None
) -> tuple[Illustration, ...]:
    if system.order != 2:
        return ()
    inside = " It cannot leave the dashed ellipse, a level set of V." if Q is not None else ""
    return (
        Illustration(
            "phase-plane",
            "The same run in the plane of the two states",
            f"Path of the state, one color for each active mode.{inside}",
            draw_phase_plane(response, Q, system),
        ),
    )


def _some(system: SwitchedSystem, hardest: SwitchedSystem) -> str:
    if len(hardest.modes) == len(system.modes):
        return ""
    return f" Only the {len(hardest.modes)} slowest modes take part."
