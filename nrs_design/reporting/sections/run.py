"""A run that looks bad, under its proved bound where there is one."""

from __future__ import annotations

import math
from fractions import Fraction
from sys import float_info
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.certificates.evidence import (
    AbstractEvidence,
    BlockTriangular,
    CommonPolynomial,
    CommonQuadratic,
    ModePolynomial,
    ModeQuadratic,
    ParameterQuadratic,
)
from nrs_design.reporting.document import Illustration, Section
from nrs_design.reporting.figures.run import (
    MOTION_STATES,
    draw_mode_levels,
    draw_phase_plane,
    draw_run,
)
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.admissible import active_norms, admissible_run
from nrs_design.simulation.margins import parameter_rates
from nrs_design.simulation.norms import (
    function_at,
    mode_functions,
    modes_at,
    polynomial_norm,
    quadratic_norm,
    scaled_matrices,
)
from nrs_design.simulation.switched import (
    TimeResponse,
    fine_step,
    norms,
    sampled_direction,
    worst_direction,
    worst_switching,
)
from nrs_design.switched.system import SwitchedSystem, Time

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
_POLYNOMIAL_MODES = 32
_NESTED = (1.0, 0.75, 0.5, 0.25)
_GREEDY = (
    "Simulated run from the slowest direction: at every step the adversary takes the mode after "
    "which the norm is largest. It is a bad run, not the worst one."
)
_RULED = (
    "Simulated run that keeps the declared rules: the adversary stays, or switches when it may, "
    "whichever loses the least of the norm per time. It is a bad run, not the worst one."
)
_HOLDS = "The dashed line is the bound of the certificate, which holds for every switching signal."
PATH = "Path of the state, one color for each active mode."
_TITLE = "Switching against the proved bound"


def run_section(system: SwitchedSystem, evidence: AbstractEvidence | None) -> Section:
    """Simulate one run and draw it.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    evidence : AbstractEvidence or None
        Of stability: it decides which norm is drawn under which bound. None for a run alone.
    """
    if isinstance(evidence, CommonQuadratic):
        figures = _quadratic(system, evidence)
    elif isinstance(evidence, CommonPolynomial):
        figures = _polynomial(system, evidence)
    elif isinstance(evidence, ModeQuadratic):
        figures = _ruled(system, evidence)
    elif isinstance(evidence, ModePolynomial):
        figures = _ruled_beside(system, float(evidence.quadratic.rate))
    elif isinstance(evidence, ParameterQuadratic):
        figures = _at_parameter(system, evidence)
    elif isinstance(evidence, BlockTriangular):
        figures = _blocks(system, evidence)
    else:
        figures = _unbounded(system)
    return Section("Simulated switching", figures)


def _quadratic(system: SwitchedSystem, evidence: CommonQuadratic) -> tuple[Illustration, ...]:
    (Q,) = scaled_matrices(evidence.Q)
    hardest = hardest_modes(system, Q, _affordable(system))
    norm, initial = quadratic_norm(Q), worst_direction(hardest, Q)
    caption = f"{_GREEDY} {_HOLDS}{_freely(system)}{_some(system, hardest)}"
    response, run = _bounded(
        hardest, norm, initial, float(evidence.rate), "in the norm of Q", caption
    )
    return (run, *_phase_plane(hardest, response, norm, (1.0,)))


def _polynomial(system: SwitchedSystem, evidence: CommonPolynomial) -> tuple[Illustration, ...]:
    hardest = hardest_modes(system, None, min(_affordable(system), _POLYNOMIAL_MODES))
    norm = polynomial_norm(evidence, system.order)
    initial = sampled_direction(hardest, norm, fine_step(hardest))
    caption = f"{_GREEDY} {_HOLDS}{_freely(system)}{_some(system, hardest)}"
    label = f"in V^(1/{2 * evidence.degree})"
    response, run = _bounded(hardest, norm, initial, float(evidence.rate), label, caption)
    return (run, *_phase_plane(hardest, response, norm, _NESTED))


def _at_parameter(system: SwitchedSystem, evidence: ParameterQuadratic) -> tuple[Illustration, ...]:
    values = np.linspace(0.0, 1.0, 21)
    _, rates = parameter_rates(system, evidence, values)
    p = float(values[rates.min(axis=1).argmin()])
    Q, fixed = function_at(evidence, p), modes_at(system, Fraction(p))
    hardest = hardest_modes(fixed, Q, _affordable(fixed))
    caption = (
        f"{_GREEDY} The parameter stays at {p:.3g} of its range (0 low end, 1 high end), where "
        f"the decay is slowest. {_HOLDS}{_some(fixed, hardest)}"
    )
    norm, initial = quadratic_norm(Q), worst_direction(hardest, Q)
    label = "in the norm of Q(p)"
    response, run = _bounded(hardest, norm, initial, float(evidence.rate), label, caption)
    return (run, *_phase_plane(hardest, response, norm, (1.0,)))


def _bounded(
    system: SwitchedSystem, norm: Norm, initial: Array, rate: float, label: str, caption: str
) -> tuple[TimeResponse, Illustration]:
    """Let the greedy adversary run under arbitrary switching, and draw it below its bound."""
    step, steps = _horizon(system, rate)
    response = worst_switching(system, norm, initial, step, steps)
    response = _until_small(response, norms(response, norm))
    bound = _bound(response, rate, system.time, "proved bound, ")
    figure = draw_run(
        response, norms(response, norm), bound, system, f"|x(t)| / |x(0)| {label} [1]"
    )
    return response, Illustration("run", _TITLE, caption, figure)


def _ruled(system: SwitchedSystem, evidence: ModeQuadratic) -> tuple[Illustration, ...]:
    functions = mode_functions(evidence)
    hardest = hardest_modes(system, None, _RULED_MODES)
    step, steps = _horizon(hardest, float(evidence.rate))
    response = admissible_run(hardest, functions, step, min(steps, _RULED_STEPS))
    response = _until_small(response, active_norms(hardest, response, functions))
    bound = _bound(response, float(evidence.rate), system.time, "proved bound, ")
    run = Illustration(
        "run",
        _TITLE,
        f"{_RULED} Drawn is the root of V of the active mode, over its start. Where the next mode "
        "takes over, it may jump, but it stays below the dashed bound of the certificate, which "
        "holds for every signal that keeps the rules. In a norm that is the same in all "
        f"modes, the bound holds with the factor c.{_rises(evidence)}{_some(system, hardest)}",
        draw_run(
            response,
            active_norms(hardest, response, functions),
            bound,
            hardest,
            "Root of V of the active mode [1]",
        ),
    )
    if system.order != 2 or not system.is_uniform:
        return (run,)
    roots = {name: quadratic_norm(Q) for name, Q in functions.items()}
    return run, Illustration(
        "phase-plane",
        "The same run in the plane of the two states",
        f"{PATH} {plane_axes(system)} Dashed is a level curve of each mode's own function, all at "
        "one value. While a mode is active, its own function decreases"
        + (", except in a mode that must be left." if evidence.leaving else ".")
        + _jumps(system),
        draw_mode_levels(response, hardest, roots),
    )


def _ruled_beside(system: SwitchedSystem, rate: float) -> tuple[Illustration, ...]:
    """Draw a run that keeps the rules in the Euclidean norm, beside the slope of its bound."""
    hardest = hardest_modes(system, None, _RULED_MODES)
    functions = {mode.name: np.eye(mode.A.shape[0]) for mode in hardest.modes}
    step, steps = _horizon(hardest, rate)
    response = admissible_run(hardest, functions, step, min(steps, _RULED_STEPS))
    response = _until_small(response, active_norms(hardest, response, functions))
    run = Illustration(
        "run",
        "Switching beside the proved rate",
        f"{_RULED} The dashed line has the proved rate. The certificate says that every run that "
        "keeps the rules stays below such a line, up to one constant factor; so this run may lie "
        f"above the line for a while.{_some(system, hardest)}",
        draw_run(
            response,
            active_norms(hardest, response, functions),
            _bound(response, rate, system.time, "slope of the proved bound, "),
            hardest,
            "|x(t)| / |x(0)|, Euclidean norm [1]",
        ),
    )
    return (run, *_phase_plane(hardest, response, None))


def _blocks(system: SwitchedSystem, evidence: BlockTriangular) -> tuple[Illustration, ...]:
    hardest = hardest_modes(system, None, _affordable(system))
    rate = evidence.proved_rate(system)
    assert rate is not None
    norm = quadratic_norm(np.eye(system.order))
    step, steps = _horizon(hardest, float(rate))
    initial = worst_direction(hardest, np.eye(system.order))
    response = worst_switching(hardest, norm, initial, step, steps)
    response = _until_small(response, norms(response, norm))
    line = _bound(response, float(rate), system.time, "slope of the slowest block, ")
    run = Illustration(
        "run",
        "Switching beside the proved rate",
        f"{_GREEDY} The dashed line has the rate of the slowest block. The certificate says that "
        "every run decays at any slower rate, up to a constant factor; so the run may lie above "
        f"the line for a while.{_freely(system)}{_some(system, hardest)}",
        draw_run(
            response, norms(response, norm), line, hardest, "|x(t)| / |x(0)|, Euclidean norm [1]"
        ),
    )
    return (run, *_phase_plane(hardest, response, None))


def _unbounded(system: SwitchedSystem) -> tuple[Illustration, ...]:
    arbitrary = system.switching.is_arbitrary
    hardest = hardest_modes(system, None, _affordable(system) if arbitrary else _RULED_MODES)
    step = fine_step(hardest)
    functions = {mode.name: np.eye(mode.A.shape[0]) for mode in hardest.modes}
    if arbitrary:
        norm, identity = quadratic_norm(np.eye(system.order)), np.eye(system.order)
        initial = worst_direction(hardest, identity)
        response = worst_switching(hardest, norm, initial, step, _UNKNOWN_STEPS)
    else:
        response = admissible_run(hardest, functions, step, _UNKNOWN_STEPS)
    run = Illustration(
        "run",
        "One bad run",
        f"{_GREEDY if arbitrary else _RULED} There is no bound: nothing is proved. Decay in this "
        "run is no sign of stability, and growth over a short time is no proof of instability."
        f"{_some(system, hardest)}",
        draw_run(
            response,
            active_norms(hardest, response, functions),
            None,
            hardest,
            "|x(t)| / |x(0)|, Euclidean norm [1]",
        ),
    )
    return (run, *_phase_plane(hardest, response, None))


def _bound(response: TimeResponse, rate: float, time: Time, label: str) -> Bound:
    if time is Time.CONTINUOUS:
        return f"{label}exp(-alpha t)", np.exp(-rate * response.time)
    return f"{label}rho^t", rate**response.time


def _affordable(system: SwitchedSystem) -> int:
    return max(8, min(256, _EFFORT // system.order**2))


def _until_small(response: TimeResponse, values: Array) -> TimeResponse:
    """Cut a run where it has come to rest for all that can be seen."""
    small = np.flatnonzero(values < _SMALL)
    if not len(small):
        return response
    end = max(int(small[0]), 2)
    return TimeResponse(response.time[: end + 1], response.state[: end + 1], response.mode[:end])


def _horizon(system: SwitchedSystem, claimed: float) -> tuple[float, int]:
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


def _phase_plane(
    system: SwitchedSystem,
    response: TimeResponse,
    norm: Norm | None,
    levels: tuple[float, ...] = (),
) -> tuple[Illustration, ...]:
    if system.order != 2 or not system.is_uniform:
        return ()
    inside = " It cannot leave the dashed level curve of V." if norm is not None else ""
    if len(levels) > 1:
        inside += " The dotted ones are level curves further in: no run crosses one outward."
    return (
        Illustration(
            "phase-plane",
            "The same run in the plane of the two states",
            f"{PATH} {plane_axes(system)}{inside}{_jumps(system)}",
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


def _jumps(system: SwitchedSystem) -> str:
    return " A reset is drawn with the step before it." if system.switching.resets else ""


def _rises(evidence: ModeQuadratic) -> str:
    if not evidence.leaving:
        return ""
    return (
        " In a mode that must be left it may rise above the bound; at the next switch it is below."
    )


def _freely(system: SwitchedSystem) -> str:
    if system.switching.is_arbitrary:
        return ""
    return " The run switches freely, which is more than the spec allows."


def _some(system: SwitchedSystem, hardest: SwitchedSystem) -> str:
    if len(hardest.modes) == len(system.modes):
        return ""
    return f" Only the {len(hardest.modes)} slowest modes take part."
