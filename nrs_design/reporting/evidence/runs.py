"""Adversarial runs with a proved bound, with a proved rate, or without a proof."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from sys import float_info

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import ARBITRARY
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Paragraph, Section
from nrs_design.reporting.evidence.offers import Form
from nrs_design.reporting.evidence.words import rules_clause
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.greedy import greedy_run, relative_norms, slowest
from nrs_design.simulation.norms import Array, Norm, quadratic_norm, scaled_matrices
from nrs_design.simulation.rules import fitting_step
from nrs_design.simulation.switched import (
    SwitchedRun,
    all_modes,
    fine_step,
    single_mode_system,
    worst_direction,
)

Bound = tuple[str, Array]

# A run lasts until the bound has fallen by e^7, three decades, or has _STEPS steps.
_DECAY = 7.0
_STEPS = 4000
_FEWEST = 500
# A run ends below this fraction of the start: a longer axis would flatten the bound.
_SMALL = 1e-6
# Modes times squared states that a run evaluates in about a second.
_EFFORT = 200_000
_UNKNOWN_STEPS = 600
# A run that keeps rules tries every allowed switch at every step.
_RULED_MODES = 24
_RULED_STEPS = 1500
# Steps by which directions are compared.
_FIRST = 20
# States in contact that a run of rounds may begin at.
_DIRECTIONS = 200

_GREEDY = (
    "Simulated run: at every step the adversary takes the mode, of those that may be in force, "
    "after which the norm is largest. It is a bad run, not the worst one."
)
_BOUND_CAPTION = (
    "The dashed line is the bound of the certificate, which holds for every switching signal"
)
_SLOPE = (
    "The dashed line has the proved rate. The certificate says that every run that keeps the rules "
    "stays below such a line, up to one constant factor; so this run may lie above the line for a "
    "while."
)
_ACTIVE = (
    "Drawn is the root of V of the active mode, over its start. Where the next mode takes over, it "
    "may jump, but it stays below the dashed bound of the certificate, which holds for every "
    "signal that keeps the rules. In a norm that is the same in all modes, the bound holds with "
    "the factor c."
)
_RISES = " In a mode that must be left it may rise above the bound; at the next switch it is below."
_SECTION = "Simulated switching"
_UNBOUNDED = "One bad run"
_UNPROVED = (
    "There is no bound: nothing is proved. Decay in this run is no sign of stability, and growth "
    "over a short time is no proof of instability."
)
EUCLIDEAN = "|x(t)| / |x(0)|\nEuclidean norm [1]"
_AGAINST = "Switching against the proved bound"
_RATE_TITLE = "Switching beside the proved rate"
BOUND = "proved bound, "


@dataclass(frozen=True, eq=False)
class Greedy:
    """A run of the greedy adversary, and the norm in which it is drawn."""

    system: SwitchedSystem  # All modes, for the caption
    played: SwitchedSystem  # Modes that take part; without `contact` where it is kept
    norms: Norm | Sequence[Norm]  # A norm, or a norm for each clock state or mode
    initial: Array  # Shape (n,)
    rate: float | None = None  # Sets the length of the run; None for a fixed length

    def draw(self, text: str, label: str, line: str = "") -> Section:
        """Return the section of the run.

        `line` says which line has the rate, such as ``proved bound, ``; empty for none.
        """
        system, rate, norms = all_modes(self.played), self.rate, self.norms
        step, steps = horizon(system, rate)
        response = greedy_run(self.played, norms, self.initial, step, steps)
        if rate:
            response = until_small(response, relative_norms(response, norms))
        values = relative_norms(response, norms)
        bound = bound_line(response, rate, system.time, line) if rate and line else None
        caption = f"{_GREEDY} {text}"
        if system.switching.is_arbitrary and not self.system.switching.is_arbitrary:
            caption += " The run switches freely, which is more than the spec allows."
        if len(self.played.modes) < len(self.system.modes):
            caption += f" Only the {len(self.played.modes)} slowest modes take part."
        deflection = "" if self.played.contact is None else system.states[-1]
        title = {"": _UNBOUNDED, BOUND: _AGAINST}.get(line, _RATE_TITLE)
        figure = draw_run(response, values, bound, system, label, deflection)
        return Section(_SECTION, (Illustration("run", title, caption, figure),))


def bounded_run(greedy: Greedy, norm: str, note: str = "") -> Section:
    """Draw a greedy run below its bound; say in which norm."""
    played = greedy.played
    letter = "x" if played.clock is None and played.contact is None else "w"
    contact_note = " and any loss of contact" if played.contact is not None else ""
    text = f"{note}{_BOUND_CAPTION}{contact_note}{rules_clause(played)}."
    return greedy.draw(text, f"|{letter}(t)| / |{letter}(0)|\n{norm} [1]", BOUND)


def freely_switched(system: SwitchedSystem, Q: Array | None, limit: int) -> SwitchedSystem:
    """Return the slowest modes of a system, in kept contact, to be switched freely."""
    switching = system.switching if system.clock is not None else ARBITRARY
    return replace(hardest_modes(system, Q, limit), contact=None, switching=switching)


def slowest_in_a_round(system: SwitchedSystem, norms: Sequence[Norm]) -> Array:
    """Return the state in contact, among some, that keeps the most over a round."""
    rng, size = np.random.default_rng(0), len(norms)
    directions = rng.standard_normal((_DIRECTIONS, system.order)) / norms[0](np.eye(system.order))
    directions[:, -1] = np.abs(directions[:, -1])
    return slowest(system, norms, directions, 1.0, size)


def ruled_run(
    system: SwitchedSystem,
    forms: Sequence[Form] = (),
    rate: float | None = None,
    *,
    leaving: bool = False,
) -> Section:
    """Draw a run that obeys the declared rules, with its bound or slope if proved.

    In the norms of the forms if each mode has a quadratic one, else in the Euclidean. `leaving`:
    some modes must be left, in which a form may grow.
    """
    played = replace(hardest_modes(system, None, _RULED_MODES), contact=None)
    if not played.is_uniform:
        return Section(_SECTION, (Paragraph("No run is drawn: modes differ in size."),))
    # A form of several steps is of no mode alone.
    alike = {form.name: form for form in forms if form.degree == 1}
    quadratic = len(alike) == len(forms) and alike.keys() >= {mode.name for mode in system.modes}
    matrices = scaled_matrices(*(form.Q for form in alike.values())) if quadratic else []
    functions = dict(zip(alike, matrices, strict=False))
    text, label, line = _UNPROVED, EUCLIDEAN, ""
    if rate:
        text, line = _SLOPE, "slope of the proved bound, "
    if quadratic:
        text, line, label = (
            _ACTIVE + (_RISES if leaving else ""),
            BOUND,
            "Root of V of the active mode [1]",
        )
    Qs = [functions.get(mode.name, np.eye(system.order)) for mode in played.modes]
    norms = [quadratic_norm(Q) for Q in Qs]
    directions = [worst_direction(single_mode_system(played, k), Q) for k, Q in enumerate(Qs)]
    try:
        step, _ = horizon(played, rate)
        initial = slowest(played, norms, directions, step, _FIRST)
        return Greedy(system, played, norms, initial, rate).draw(text, label, line)
    except ValueError as error:
        return Section(_SECTION, (Paragraph(f"No run is drawn: {error}."),))


def unbounded_run(system: SwitchedSystem) -> Section:
    """Draw an adversarial run of a system without a proof."""
    if system.clock is None and not system.switching.is_arbitrary:
        return ruled_run(system)
    identity, played = np.eye(system.order), freely_switched(system, None, trials_per_step(system))
    norm, initial = quadratic_norm(identity), identity[-1]
    if system.clock is None:
        return Greedy(system, played, norm, worst_direction(played, identity)).draw(
            _UNPROVED, EUCLIDEAN
        )
    linear_system = replace(system, contact=None)
    return Greedy(linear_system, linear_system, [norm] * system.clock.length, initial).draw(
        _UNPROVED, EUCLIDEAN
    )


def bound_line(response: SwitchedRun, rate: float, time: Time, label: str) -> Bound:
    """Return how a rate, alpha in 1/s or rho per step, decays along a run, with its label."""
    if time is Time.CONTINUOUS:
        return f"{label}exp(-alpha t)", np.exp(-rate * response.time)
    return f"{label}rho^t", rate**response.time


def trials_per_step(system: SwitchedSystem) -> int:
    """Return how many modes a greedy run can try at every step."""
    return max(8, min(256, _EFFORT // system.order**2))


def until_small(response: SwitchedRun, values: Array) -> SwitchedRun:
    """Cut a run where it has visibly come to rest."""
    small = np.flatnonzero(values < _SMALL)
    if not len(small):
        return response
    end = max(int(small[0]), 2)
    turn = None if response.turn is None else response.turn[: end + 1]
    states = response.state[: end + 1]
    return SwitchedRun(response.time[: end + 1], states, response.mode[:end], turn)


def horizon(system: SwitchedSystem, rate: float | None) -> tuple[float, int]:
    """Return step and number of steps of a run; where switches are ruled, the step fits the rules.

    A bound falls by three decades in them, if they are few enough.
    """
    step, steps = fine_step(system), _UNKNOWN_STEPS
    if rate:
        decay = rate if system.time is Time.CONTINUOUS else -math.log(rate)
        # A contraction of 1 - 1e-21 is 1 in floating point.
        decay = max(decay, float_info.min)
        steps = math.ceil(min(_DECAY / (decay * step), float(_STEPS)))
        if system.time is Time.CONTINUOUS and steps < _FEWEST:
            steps = _FEWEST
            step = _DECAY / decay / steps
    if system.clock is None and not system.switching.is_arbitrary:
        step, steps = fitting_step(system, step), min(steps, _RULED_STEPS)
    return step, max(steps, 10)
