"""Adversarial runs: below a proved bound, beside a proved rate, or without either."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from sys import float_info

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Paragraph, Section
from nrs_design.reporting.evidence.offers import Form
from nrs_design.reporting.evidence.words import allowed
from nrs_design.reporting.figures.run import draw_phase_plane, draw_run
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.greedy import greedy_run, relative_norms, slowest
from nrs_design.simulation.norms import Array, Norm, quadratic_norm, scaled_matrices
from nrs_design.simulation.rules import fitting_step
from nrs_design.simulation.switched import SwitchedRun, all_modes, alone, fine_step, worst_direction

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
# Steps by which directions are compared.
_FIRST = 20
# States in contact that a run of rounds may begin at.
_DIRECTIONS = 200

_NOT_WORST = "It is a bad run, not the worst one."
GREEDY = (
    "Simulated run from the slowest direction: at every step the adversary takes the mode after "
    f"which the norm is largest. {_NOT_WORST}"
)
RULED = (
    "Simulated run that keeps the declared rules: at every step the adversary stays, or takes a "
    f"mode that may follow, after which the norm of that mode is largest. {_NOT_WORST}"
)
_BOUNCING = (
    "Simulated run from the slowest direction in contact: at every step the adversary takes the "
    f"possible mode after which the norm is largest. {_NOT_WORST}"
)
_ROUNDS = (
    "Simulated run: at every step the adversary takes the mode, of those that may be in force and "
    f"that contact allows, after which the norm of that step is largest. {_NOT_WORST}"
)
_HOLDS = "The dashed line is the bound of the certificate, which holds for every switching signal"
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
_BAD = "One bad run"
_UNPROVED = (
    "There is no bound: nothing is proved. Decay in this run is no sign of stability, and growth "
    "over a short time is no proof of instability."
)
_UNPROVED_ROUNDS = (
    "Simulated run in kept contact from a deflection: at every step the adversary takes the mode, "
    "of those that may be in force, after which the Euclidean norm is largest. There is no bound: "
    "nothing is proved."
)
EUCLIDEAN = "|x(t)| / |x(0)|\nEuclidean norm [1]"
AGAINST = "Switching against the proved bound"
BESIDE = "Switching beside the proved rate"
_BOUND = "proved bound, "
_PLANE = "The same run in the plane of the two states"
_PATH = (
    "Path of the state, one color for each active mode. The axes are the two states themselves, no "
    "projection. A reset is drawn with the step before it. Dashed, if it is proved: level curves "
    "of V. The path cannot leave that of all modes; the V of one mode decreases while that mode is "
    "active, unless the mode must be left."
)


def simulated(*blocks: Illustration) -> Section:
    """Return the section of a run that no evidence of instability asks for."""
    return Section(_SECTION, blocks)


def run_figures(
    title: str,
    caption: str,
    response: SwitchedRun,
    values: Array,
    system: SwitchedSystem,
    label: str = EUCLIDEAN,
    bound: Bound | None = None,
    *,
    norms: Mapping[str, Norm] | None = None,
    deflection: str = "",
) -> tuple[Illustration, ...]:
    """Draw a norm along a run, and where the system has two states, the path of the run.

    The path is among level curves of norms by mode, or of one for all by no name; where contact may
    be lost, or modes take turns, it is left out.
    """
    figure = draw_run(response, values, bound, system, label, deflection)
    run = Illustration("run", title, caption, figure)
    flat = system.order == 2 and system.is_uniform and not deflection and system.clock is None
    if not flat:
        return (run,)
    path = draw_phase_plane(response, system, norms or {})
    return run, Illustration("phase-plane", _PLANE, _PATH, path)


@dataclass(frozen=True, eq=False)
class Greedy:
    """A run of the greedy adversary, and the norm in which it is drawn."""

    system: SwitchedSystem  # All modes, for the caption
    played: SwitchedSystem  # Modes that take part; without `contact` where it is kept
    norms: Norm | Sequence[Norm]  # With a clock, one for each step of a round
    initial: Array  # Shape (n,)
    rate: float | None = None  # Sets the length of the run; None for a fixed length

    def draw(self, title: str, caption: str, label: str, line: str = "") -> Section:
        """Return the section of the run.

        `line` says which line has the rate, such as ``proved bound,``; empty for none.
        """
        system, rate, norms = all_modes(self.played), self.rate, self.norms
        step, steps = horizon(system, rate) if rate else (fine_step(system), _UNKNOWN_STEPS)
        response = greedy_run(self.played, norms, self.initial, step, steps)
        if rate:
            response = until_small(response, relative_norms(response, norms))
        values = relative_norms(response, norms)
        bound = bound_line(response, rate, system.time, line) if rate and line else None
        # Switching freely is more than declared rules allow.
        if not self.system.switching.is_arbitrary:
            caption += " The run switches freely, which is more than the spec allows."
        caption += some_modes(self.system, self.played)
        deflection = "" if self.played.contact is None else system.states[-1]
        inside = {"": norms} if callable(norms) and line == _BOUND else {}
        shown = (response, values, system, label, bound)
        return simulated(*run_figures(title, caption, *shown, norms=inside, deflection=deflection))


def bounded_run(greedy: Greedy, norm: str, note: str = "") -> Section:
    """Draw a greedy run below its bound; say in which norm."""
    played = greedy.played
    how, letter = GREEDY, "x"
    if played.clock is not None:
        how, letter = _ROUNDS, "w"
    elif played.contact is not None:
        how, letter = _BOUNCING, "w"
    lost = " and any loss of contact" if played.contact is not None else ""
    holds = f"{_HOLDS}{lost}{allowed(played)}."
    said = " ".join(text for text in (how, note, holds) if text)
    return greedy.draw(AGAINST, said, f"|{letter}(t)| / |{letter}(0)|\n{norm} [1]", _BOUND)


def slowest_in_a_round(system: SwitchedSystem, norms: Sequence[Norm]) -> Array:
    """Return the state in contact, among some, that keeps the most over a round."""
    rng, size = np.random.default_rng(0), len(norms)
    directions = rng.standard_normal((_DIRECTIONS, system.order)) / norms[0](np.eye(system.order))
    directions[:, -1] = np.abs(directions[:, -1])
    return slowest(system, norms, directions, 1.0, size)


def ruled_run(
    system: SwitchedSystem, forms: Sequence[Form], rate: float, *, leaving: bool
) -> Section:
    """Draw a run that keeps the declared rules, below its bound or beside its slope.

    In the norms of the forms if each mode has a quadratic one, else in the Euclidean. `leaving`:
    some modes must be left, in which a form may grow.
    """
    names = {form.name for form in forms}
    single = forms[0].degree == 1 and len(forms) == len(names)  # No form remembers steps
    of_modes = single and names >= {mode.name for mode in system.modes}
    title, said, label, line = BESIDE, _SLOPE, EUCLIDEAN, "slope of the proved bound, "
    functions: dict[str, Array] = {}
    if of_modes:
        title, said, line = AGAINST, _ACTIVE + _RISES * leaving, _BOUND
        label = "Root of V of the active mode [1]"
        matrices = scaled_matrices(*(form.Q for form in forms))
        functions = {form.name: Q for form, Q in zip(forms, matrices, strict=True)}
    return _kept_to_rules(system, functions, (title, f"{RULED} {said}", label), rate, line)


def _kept_to_rules(
    system: SwitchedSystem,
    functions: Mapping[str, Array],
    words: tuple[str, str, str],
    rate: float | None = None,
    line: str = "",
) -> Section:
    """Draw a greedy run that keeps the rules, in norms by mode, or the Euclidean one without.

    Title, caption and label are given.
    """
    title, caption, label = words
    hardest = replace(hardest_modes(system, None, _RULED_MODES), contact=None)
    if not hardest.is_uniform:
        return Section(_SECTION, (Paragraph("No run is drawn: modes differ in size."),))
    Qs = [functions.get(mode.name, np.eye(system.order)) for mode in hardest.modes]
    norms = [quadratic_norm(Q) for Q in Qs]
    step, steps = horizon(hardest, rate) if rate else (fine_step(hardest), _UNKNOWN_STEPS)
    try:
        step = fitting_step(hardest, step)
        directions = [worst_direction(alone(hardest, k), Q) for k, Q in enumerate(Qs)]
        initial = slowest(hardest, norms, directions, step, _FIRST)
        response = greedy_run(hardest, norms, initial, step, min(steps, _RULED_STEPS))
    except ValueError as error:
        return Section(_SECTION, (Paragraph(f"No run is drawn: {error}."),))
    values = relative_norms(response, norms)
    if rate:
        response = until_small(response, values)
        values = values[: len(response.time)]
    bound = bound_line(response, rate, system.time, line) if rate else None
    shown = (response, values, hardest, label, bound)
    inside = {name: quadratic_norm(Q) for name, Q in functions.items()}
    caption += some_modes(system, hardest)
    return Section(_SECTION, run_figures(title, caption, *shown, norms=inside))


def unbounded_run(system: SwitchedSystem) -> Section:
    """Draw an adversarial run of a system about which nothing is proved."""
    identity, kept = np.eye(system.order), replace(system, contact=None)
    if system.clock is not None:
        norms = [quadratic_norm(identity)] * system.clock.length
        return Greedy(kept, kept, norms, identity[-1]).draw(_BAD, _UNPROVED_ROUNDS, EUCLIDEAN)
    if system.switching.is_arbitrary:
        hardest = hardest_modes(kept, None, trials_per_step(system))
        greedy = Greedy(kept, hardest, quadratic_norm(identity), worst_direction(hardest, identity))
        return greedy.draw(_BAD, f"{GREEDY} {_UNPROVED}", EUCLIDEAN)
    return _kept_to_rules(kept, {}, (_BAD, f"{RULED} {_UNPROVED}", EUCLIDEAN))


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


def some_modes(system: SwitchedSystem, hardest: SwitchedSystem) -> str:
    """Say how many modes take part, if not all."""
    if len(hardest.modes) == len(system.modes):
        return ""
    return f" Only the {len(hardest.modes)} slowest modes take part."
