"""How fast each mode decreases a Lyapunov function: a table and a figure."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Illustration, Table
from nrs_design.reporting.evidence.offers import Form
from nrs_design.reporting.formatting import number
from nrs_design.reporting.style import BLUE, VERMILLION, legend, new_axes, row_labels, styled
from nrs_design.simulation.norms import Array, polynomial_norm, scaled_matrices
from nrs_design.simulation.rates import mode_rates
from nrs_design.simulation.switched import fine_step, transition_matrices

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# A page holds no more; those with the least slack are shown.
_LISTED = 24
_DIRECTIONS = 500
_EIGENVALUES = {
    Time.CONTINUOUS: "Half the smallest eigenvalue of -(A'Q + QA) relative to Q",
    Time.DISCRETE: "Root of the largest eigenvalue of A'QA relative to Q",
}
_SAMPLED = f"The slowest of {_DIRECTIONS} directions, in floating point"
_MEANS = {
    Time.CONTINUOUS: "the rate at which {norm} decays{least} in this mode.",
    Time.DISCRETE: "the factor by which {norm} shrinks{least} in a step of this mode.",
}
_IN_CONTACT = " Free motion has conditions of its own, on the other states."


def rate_blocks(
    system: SwitchedSystem, form: Form, claimed: Fraction, *, lost: bool
) -> tuple[Block, ...]:
    """Return the modes with the least slack as a table and as a figure.

    `lost`: the certificate covers the loss of contact, on which these rates say nothing.
    """
    quadratic, time = form.degree == 1, system.time
    norm = "the norm of Q" if quadratic else f"V^(1/{2 * form.degree})"
    if quadratic:
        rates = mode_rates(system, scaled_matrices(form.Q)[0])
        how, least = _EIGENVALUES[time], " at least"
    else:
        rates, how, least = sampled_rates(system, form), _SAMPLED, ""
    explained = f"{how}: {_MEANS[time].format(norm=norm, least=least)}{_IN_CONTACT * lost}"
    continuous = time is Time.CONTINUOUS
    order = np.argsort(rates if continuous else -rates, kind="stable")[:_LISTED]
    names = [system.modes[i].name for i in order]
    some = "" if len(names) == len(rates) else f" The {len(names)} modes with the least slack."
    border = "right of the claimed rate" if continuous else "left of the claimed contraction"
    return (
        _table(system, rates[order], names, claimed, norm),
        Illustration(
            "mode-rates",
            "Decrease in every mode",
            f"{explained} All lie {border}.{some}",
            _draw_mode_rates(names, rates[order], claimed, time, norm),
        ),
    )


def sampled_rates(system: SwitchedSystem, form: Form) -> Array:
    """Return the slowest decay of a polynomial's root in every mode, over sampled directions.

    In 1/s, or contraction per step; no slower than what holds for all directions.
    """
    norm, n = polynomial_norm(form.Q, form.degree, system.order), system.order
    directions = np.random.default_rng(0).standard_normal((_DIRECTIONS, n)) / norm(np.eye(n))
    directions /= norm(directions)[:, None]
    step = fine_step(system)
    kept = np.array([norm(directions @ M.T).max() for M in transition_matrices(system, step)])
    return kept if system.time is Time.DISCRETE else -np.log(kept) / step


def _table(
    system: SwitchedSystem, rates: Array, names: list[str], claimed: Fraction, norm: str
) -> Table:
    continuous = system.time is Time.CONTINUOUS
    rows = []
    for name, rate in zip(names, rates.tolist(), strict=True):
        slack = rate - float(claimed) if continuous else float(claimed) - rate
        rows.append((name, number(rate, 6), number(slack, 3)))
    unit, quantity = (" [1/s]", "Decay rate") if continuous else (" [1]", "Contraction")
    some = "" if len(rows) == len(system.modes) else f" ({len(rows)} with the least slack)"
    title = f"Rate of every mode alone{some}; claimed for all: {rate_words(claimed, system.time)}"
    return Table(title, ("Mode", f"{quantity} in {norm}{unit}", f"Slack{unit}"), tuple(rows))


@styled
def _draw_mode_rates(
    names: Sequence[str], rates: Array, claimed: Fraction, time: Time, norm: str
) -> Figure:
    """Draw every mode's own rate in a norm beside the claimed one."""
    continuous = time is Time.CONTINUOUS
    labels, row = row_labels(names)
    figure, axes = new_axes(1.0 + row * len(names))
    rows = np.arange(len(names))
    axes.plot(rates, rows, "o", color=BLUE, label="this mode alone")
    bound, label = float(claimed), f"claimed for all: {rate_words(claimed, time)}"
    axes.axvline(bound, color=VERMILLION, linestyle="--", label=label)
    axes.set_yticks(rows, labels, fontsize=9)
    axes.set_ylim(len(names) - 0.5, -0.5)
    low, high = min(float(rates.min()), bound), max(float(rates.max()), bound)
    room = 0.08 * (high - low) or 0.1 * abs(high)
    axes.set_xlim(low - room, high + room)
    quantity = f"Decay rate in {norm} [1/s]" if continuous else "Contraction per step [1]"
    axes.locator_params(axis="x", nbins=4)
    axes.set(xlabel=quantity, ylabel="Mode")
    legend(figure, axes)
    return figure
