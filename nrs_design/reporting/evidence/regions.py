"""Ellipsoids: how far a disturbance pushes an output, or from where saturating signals decay."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from nrs_design.proof.bounds import lower, nearly, rounded_down, rounded_up
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.evidence.abstract import Bound
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.functions import matrix_tables
from nrs_design.reporting.evidence.offers import Offer, Page
from nrs_design.reporting.figures.run import BoundedSignal, draw_bounded_run, draw_run
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.titles import SATURATION
from nrs_design.simulation.greedy import greedy_run, relative_norms
from nrs_design.simulation.norms import clipped, quadratic_norm
from nrs_design.simulation.saturation import share_cut_off
from nrs_design.simulation.switched import SwitchedRun, all_modes
from nrs_design.simulation.worst_case import WorstRun, output_values, worst_against

_BOUND = (
    "From rest, the state does not leave the set V = w' Q w <= 1 while the disturbance keeps its "
    "bound, however it changes; from any other state, V comes down to 1."
)
_AGAINST = (
    "Simulated run from rest: an adversary chooses the modes and the sign of the largest "
    "disturbance at every step, and improves his choice a few times. It is a bad run, not the "
    "worst one; the shading covers the corners of the output. No run crosses the dashed lines."
)
_SATURATED = (
    "Wherever V = w' Q w <= 1, each signal is a mixture of its argument and of h w, which keeps "
    "its limit there; so the loop moves as a mixture of linear ones, in all of which V decreases. "
    "A higher limit leaves it such a mixture."
)
_FROM_REST = (
    "Simulated run from rest with the stated {start}, at the softest: at every step the adversary "
    "takes the possible mode after which V is largest. Signals are cut off at their limits: {cut}. "
    "It is a bad run, not the worst one; the root of V stays below the dashed bound. The run is no "
    "part of the proof."
)
_HELD = (
    "The certificate holds the matrix Q, one row h for each signal, the rate and the size of the "
    "start. Here Q is scaled."
)
# Time constants of the fastest motion in a step, and decisions of a run.
_SHARE, _STEPS = 0.1, 1500


def bound_page(system: SwitchedSystem, evidence: AbstractEvidence, _: Offer) -> Page:
    """Return the level that an output does not exceed, and a run that tries to reach it."""
    bound = evidence.bound(system)
    assert bound is not None  # it shows one
    between = ("What happens between two steps.",) if system.time is Time.DISCRETE else ()
    return Page(
        "bound on an output under a disturbance",
        (_BOUND, *words.unneeded_rules(system), words.decision(system)),
        (
            "Other disturbances beside those named, and larger ones.",
            "That the bound is reached: the largest possible value may be smaller.",
            *between,
        ),
        sections=lambda: (_bound_section(system, bound),),
    )


def _bound_section(system: SwitchedSystem, bound: Bound) -> Section:
    """Show the level beside the run that an adversary finds."""
    run, output, unit = worst_against(system, bound), bound.output, bound.output.unit
    found = float(np.abs(output_values(system, output, run.states)).max())
    rows = [
        ("Disturbance", f"|{item.name}| <= {rounded_down(item.bound, item.unit)}")
        for item in bound.channels
    ]
    rows.append((f"|{output.name}|, proved never to exceed", rounded_up(bound.level, unit)))
    rows.append((f"|{output.name}|, found by simulation", nearly(Fraction(found), unit)))
    if output.limit is not None:
        rows.append(("Limit of the spec", nearly(output.limit, unit)))
    per = "per step" if system.time is Time.DISCRETE else "1/s"
    text = (
        f"The certificate holds Q and the share a = {number(float(bound.share), 4)} {per}: V grows "
        "by at most a times 1 - V. What was found by simulation is no part of the proof."
    )
    table = Table("Bound and simulation", ("Quantity", "Value"), tuple(rows))
    title = f"Bound on {output.name} under {_acting(system, bound)}"
    return Section(title, (Paragraph(text), table, _against(system, bound, run)))


def _acting(system: SwitchedSystem, bound: Bound) -> str:
    every = len(bound.channels) == len(system.channels) > 1
    return "all disturbances at once" if every else ", ".join(item.name for item in bound.channels)


def _against(system: SwitchedSystem, bound: Bound, run: WorstRun) -> Illustration:
    """Draw an output along a run between its bounds."""
    output, acting = bound.output, _acting(system, bound)
    signal = BoundedSignal(
        f"{output.name.capitalize()} [{output.unit}]",
        output_values(system, output, run.states),
        None if output.limit is None else float(output.limit),
        np.full(len(run.time), float(bound.level)),
    )
    names = [mode.name for mode in all_modes(system).modes]
    unit = "steps" if system.time is Time.DISCRETE and system.sample_time is None else "s"
    response = SwitchedRun(run.time, run.states, run.mode)
    return Illustration(
        f"bound-{acting}-{output.name}".replace(" ", "-"),
        f"{output.name.capitalize()} under {acting}",
        _AGAINST,
        draw_bounded_run(response, [signal], names, unit),
    )


def saturation_page(system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer) -> Page:
    """Return the limits, the start, Q, and a run that begins at the stated size."""
    assert system.saturation is not None  # the evidence is about it
    start = system.saturation.start.name
    return Page(
        "decay from an ellipsoid although signals saturate",
        (_SATURATED, *words.unneeded_rules(system), words.decision(system)),
        (
            "Motions that begin outside of the ellipsoid: they may decay as well.",
            "Commands of a hand and disturbances while signals saturate.",
            f"That the {start} is within the limit of a spec: motions may begin beyond it.",
            "Lower limits, and other signals that saturate, such as the current of the motor.",
        ),
        sections=lambda: (_saturation_section(system, evidence, offer),),
    )


def _shown(system: SwitchedSystem, evidence: AbstractEvidence) -> tuple[Fraction, Fraction]:
    """Return the size of the start, and the rate of decay in 1/s."""
    level, rate = evidence.start_size, evidence.start_rate(system)
    assert level is not None  # it shows both
    assert rate is not None
    return level, rate


def _saturation_section(
    system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer
) -> Section:
    """Show limits, start and matrix, and a run."""
    assert system.saturation is not None
    start, (level, rate) = system.saturation.start, _shown(system, evidence)
    name, unit = start.name.capitalize(), start.unit
    # Of a lower limit nothing is claimed.
    rows = [
        (f"Limit of the {s.name}", rounded_up(s.limit, s.unit)) for s in system.saturation.signals
    ]
    rows.append((f"{name} at rest, proved", rounded_down(level, unit)))
    if start.wanted is not None:
        rows.append((f"{name} that is wanted", nearly(start.wanted, unit)))
    rows.append(("Rate of decay, proved", f"{lower(rate)} 1/s"))
    blocks: tuple[Block, ...] = (
        Paragraph(_HELD),
        Table("Decay although signals saturate", ("Quantity", "Value"), tuple(rows)),
        *matrix_tables(offer.forms, system.states),
        _saturated_run(system, evidence, offer),
    )
    return Section(SATURATION, blocks)


def _saturated_run(
    system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer
) -> Illustration:
    """Draw V along a run in which signals saturate."""
    assert system.saturation is not None
    (level, rate), (form,), start = _shown(system, evidence), offer.forms, system.saturation.start
    Q = np.ldexp(np.array(form.Q, dtype=float), -offer.denominator_log2)
    norm, drawn = quadratic_norm(Q), system
    if system.contact is not None:
        norm, drawn = clipped(norm), all_modes(system)
    states = [np.array(x.floats())[:, 0] for x in start.states]
    initial = float(level) * max(states, key=lambda x: float(x @ Q @ x))
    # A step of a sampled loop takes no less than the power of (1 - rate T) says.
    step, unit = 1.0, float(system.sample_time or 1)
    if system.time is Time.CONTINUOUS:
        fastest = max(np.abs(np.linalg.eigvals(mode.A.floats())).max() for mode in system.modes)
        step, unit = _SHARE / float(fastest), 1.0
    response = greedy_run(system, norm, initial, step, _STEPS)
    bound = (f"exp(-{lower(rate)} t)", np.exp(-float(rate) * response.time * unit))
    cut = ", ".join(
        f"the {name} for {number(100 * share, 2)} % of this run" if share else f"the {name} never"
        for name, share in share_cut_off(system, response).items()
    )
    values, label = relative_norms(response, norm), "root of V over its first value [1]"
    return Illustration(
        "saturated-run",
        "Run with signals that saturate",
        _FROM_REST.format(start=start.name, cut=cut),
        draw_run(response, values, bound, drawn, label),
    )
