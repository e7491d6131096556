"""Evidence for a constant parameter: forms at both ends, their rate over it, and a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.norms import matrix_blocks
from nrs_design.reporting.evidence.page import AbstractPage
from nrs_design.reporting.evidence.runs import Greedy, bounded_run, trials_per_step
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.reporting.style import INK, curve, legend, new_axes, styled
from nrs_design.simulation.norms import Array, modes_at, quadratic_norm, scaled_matrices
from nrs_design.simulation.rates import mode_rates
from nrs_design.simulation.switched import worst_direction

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_POINTS = 61
_LISTED = 24
_DRAWN = 8
# Values of the parameter at which a run may be simulated.
_VALUES = 21
_CURVES = (
    "Half the smallest eigenvalue of the decrease relative to Q, both at the same value of the "
    "parameter: the rate at which the norm of Q decays at least. All curves lie above the claimed "
    "rate, over the whole range."
)


class ParameterPage(AbstractPage):
    """Q at both ends of the parameter, and the rate of every mode over it."""

    name = "quadratic function of a constant parameter"

    def meaning(self) -> tuple[str, ...]:
        """Say that the parameter must be constant, and that switching is free."""
        return (
            f"{words.free_bound(self.system)} Which norm |x| is, depends on the value of the "
            "parameter.",
            "The parameter must be constant: one value in all modes and at all times. Which value "
            "it is, need not be known. The decrease is a polynomial of degree two in the "
            "parameter, so three matrices decide for all values between the ends.",
            *words.unneeded_rules(self.system),
            words.decision(self.system),
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered, for the other parameters while they change."""
        how = "however fast they change, the constant one excepted"
        return (words.all_corners(self.system, self.evidence, how),)

    def limits(self) -> tuple[str, ...]:
        """Name the parameter that changes."""
        return ("A parameter that changes while the system moves, however slowly.",)

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show Q at both ends, and the decay rate of every mode over the parameter."""
        text = (
            "The certificate holds Q at both ends of the parameter's range; between them Q is "
            f"affine. It is written with denominator 2^{self.offer.denominator_log2}; here both "
            "ends are divided by the largest entry."
        )
        matrices = matrix_blocks(self.offer.forms, self.system.states)
        return (Section(EVIDENCE, (Paragraph(text), *matrices, *self._rates())),)

    def run(self) -> Section:
        """Draw a run at the value of the parameter where the decay is slowest."""
        values = np.linspace(0.0, 1.0, _VALUES)
        _, rates = parameter_rates(self.system, self._ends, values)
        p = float(values[rates.min(axis=1).argmin()])
        Q, fixed = _between(self._ends, p), modes_at(self.system, Fraction(p))
        hardest = replace(hardest_modes(fixed, Q, trials_per_step(fixed)), contact=None)
        initial, rate = worst_direction(hardest, Q), float(self._rate)
        return bounded_run(
            Greedy(fixed, hardest, quadratic_norm(Q), initial, rate),
            "in the norm of Q(p)",
            f"The parameter stays at {p:.3g} of its range (0 low end, 1 high end), where the "
            "decay is slowest.",
        )

    @property
    def _ends(self) -> list[Array]:
        return scaled_matrices(*(form.Q for form in self.offer.forms))

    @property
    def _rate(self) -> Fraction:
        rate = self.evidence.proved_rate(self.system)
        assert rate is not None  # it shows stability
        return rate

    def _rates(self) -> tuple[Table, Illustration]:
        """Return the rates of the slowest modes as a table and as curves."""
        values = np.linspace(0.0, 1.0, _POINTS)
        names, rates = parameter_rates(self.system, self._ends, values)
        slowest = np.argsort(rates.min(axis=0), kind="stable")
        drawn = np.sort(slowest[:_DRAWN])
        some = f" The {_DRAWN} slowest of {len(names)} modes." if len(names) > _DRAWN else ""
        curves = _draw_parameter_rates(
            [names[i] for i in drawn], values, rates[:, drawn], self._rate
        )
        rows = tuple(
            (
                names[i],
                number(float(rates[:, i].min()), 6),
                number(float(values[rates[:, i].argmin()]), 3),
            )
            for i in slowest[:_LISTED]
        )
        claimed = rate_words(self._rate, self.system.time)
        columns = ("Mode", "Smallest decay rate [1/s]", "At the parameter [0 low, 1 high]")
        title = f"Slowest decay over the parameter; claimed: {claimed}"
        figure = Illustration(
            "parameter-rates", "Decrease over the parameter", f"{_CURVES}{some}", curves
        )
        return Table(title, columns, rows), figure


def parameter_rates(
    system: SwitchedSystem, ends: list[Array], values: Array
) -> tuple[list[str], Array]:
    """Return how fast the norm of Q(p) decays in every mode, over the parameter p."""
    names = [mode.name for mode in modes_at(system, Fraction(0)).modes]
    rates = [mode_rates(modes_at(system, Fraction(float(p))), _between(ends, p)) for p in values]
    return names, np.array(rates)


def _between(ends: list[Array], p: float) -> Array:
    low, high = ends
    return (1 - p) * low + p * high


@styled
def _draw_parameter_rates(
    names: Sequence[str], values: Array, rates: Array, claimed: Fraction
) -> Figure:
    """Draw every mode's decay rate over a constant parameter beside the claimed one."""
    figure, axes = new_axes(3.9)
    for index, name in enumerate(names):
        axes.plot(values, rates[:, index], label=name, **curve(index, len(names), len(values)))
    label = f"claimed for all: {rate_words(claimed, Time.CONTINUOUS)}"
    axes.axhline(float(claimed), color=INK, linestyle="--", linewidth=1.3, label=label)
    axes.set(
        xlabel="Place in the parameter's range, 0 low end, 1 high end [1]",
        ylabel="Decay rate in the norm of Q [1/s]",
        xlim=(0, 1),
        ylim=(0, 1.15 * float(rates.max())),
    )
    legend(figure, axes)
    return figure
