"""Impedance control: gains, margins, and what is displayed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from nrs_design.design.laws.law import AbstractControllerAnalysis
from nrs_design.design.measures import (
    COST_MEANING,
    IMPEDANCE_ERROR,
    LIMIT_MEANING,
    MEANING,
    SENSITIVITY_PEAK,
)
from nrs_design.models.axis import labelled
from nrs_design.proof.bounds import lower, upper
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.style import INK, MUTED, color, curve, legend, marker, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.design.analysis import ImpedanceAnalysis
    from nrs_design.design.loops import Loops
    from nrs_design.design.passivity import PassiveBand
    from nrs_design.design.transfer import FloatArray
    from nrs_design.pipeline.design import Designed
    from nrs_design.spec import LoadedSpec

T = TypeVar("T", bound=AbstractControllerAnalysis)
# These units hold for rotary and prismatic axes.
_FREQUENCIES = ("Closed-loop poles [rad/s]", "Natural frequency [rad/s]")
# More controllers than these make a table too wide for a page, or a figure too full.
_COLUMNS = 4
CURVES = 6

_PASSIVE = (
    "Passive: the admittance from the torque of a hand to the velocity of the tool, as it is "
    "assembled: with the load of the motor, the filter and the spring, wherever the numbers of the "
    "motor are in their ranges, each of them constant. Decided by rigorous isolation of roots. "
    "Where a frequency is named near which it is not passive, that is shown at one corner of the "
    "ranges."
)
_SUDDEN = (
    "Viscoelastic contact: the stiffness is that which a sudden motion meets, and up to the "
    "stiffness limit all parameters of the law grow in proportion to it."
)


def _limit(value: float | None) -> str:
    """Return a stiffness limit as text, rounded down; an empty text for None."""
    if value is None:
        return ""
    if math.isnan(value):
        return "not computed"
    return "unlimited" if math.isinf(value) else lower(Fraction(value), 4)


_IMPEDANCE_ROWS: tuple[tuple[str, Callable[[ImpedanceAnalysis], str]], ...] = (
    ("Desired impedance [N·m·s/rad]", lambda item: number(item.problem.desired, 5)),
    ("Nominal stiffness [N·m/rad]", lambda item: number(item.problem.loop.contact.stiffness, 6)),
    (
        "Stiffness beside the damper [N·m/rad]",
        lambda item: _format_parameter(item, "parallel_stiffness"),
    ),
    ("Nominal damping [N·m·s/rad]", lambda item: _format_parameter(item, "damping", "0")),
    ("Mt as shipped [kg·m²]", lambda item: number(item.Mt, 6)),
    ("Bt as shipped [N·m·s/rad]", lambda item: number(item.Bt, 6)),
    (
        "Kt as given [N·m/rad]",
        lambda item: (item.problem.loop.Kt and number(item.problem.loop.Kt, 6)) or "",
    ),
    ("Cost as shipped [1]", lambda item: number(item.cost, 5)),
    ("k limit [N·m/rad], worst", lambda item: _limit(item.lowest_limit)),
    ("k limit at the lever arm [N/m], worst", lambda item: _limit(item.limit_at_arm)),
    ("Displayed admittance passive up to [Hz], exact", lambda item: _passive(item.band)),
    ("Not passive near [Hz], exact", lambda item: _not_passive(item.band)),
)


def impedance_section(designed: Designed, items: tuple[ImpedanceAnalysis, ...]) -> Section:
    """Show cost, margins and curves of the impedance controllers."""
    plotted = tuple(item for item in items if item.requirement.axis is not None)[:CURVES]
    omission = "" if len(plotted) == len(items) else f" The first {CURVES} controllers are drawn."
    title = "Impedance controllers: gains, and the worst over the ranges"
    tables = controller_tables(designed.loaded, title, _IMPEDANCE_ROWS, items)
    meanings = (MEANING[0], LIMIT_MEANING, MEANING[-1], COST_MEANING)
    paragraphs = [Paragraph(" ".join(meanings))]
    if any(item.band for item in items):
        paragraphs.append(Paragraph(_PASSIVE))
    if any(item.problem.loop.contact.has_memory for item in items):
        paragraphs.append(Paragraph(_SUDDEN))
    figures = _figures(plotted, omission) if plotted else ()
    return Section("Impedance control", (*paragraphs, *tables, *figures))


def _figures(
    plotted: Sequence[ImpedanceAnalysis], omission: str
) -> tuple[Illustration, Illustration]:
    displayed = Illustration(
        "displayed-impedance",
        "Displayed and desired impedance",
        "Magnitude of the impedance that the operator feels in nominal contact, of the loop that "
        "is proved at its nominal values (solid; a sampled law with a spring has no curve), and "
        "the desired one (dashed); the dotted line is the bandwidth of the motion. Shaded: what "
        f"the goal allows up to there, or what is usual.{omission}",
        _draw_displayed_impedance(plotted),
    )
    sensitivity = Illustration(
        "sensitivity",
        "Sensitivity",
        "Magnitude of 1/(1 + L) with the open loop L, at the corner of the ranges where its peak "
        "is largest; the marker is that peak Ms. A value above 1 (gray line) amplifies "
        f"disturbances of that frequency.{omission}",
        _draw_sensitivity(plotted),
    )
    return displayed, sensitivity


def _passive(band: PassiveBand | None) -> str:
    if band is None:
        return ""
    if band.passive is None:
        return "every frequency"
    return lower(band.passive * Fraction(1000, 6284), 4)


def _not_passive(band: PassiveBand | None) -> str:
    """Write a frequency at which it is not passive; rounded, so near it."""
    if band is None or band.broken is None:
        return ""
    return upper(band.broken * Fraction(1000, 6283), 4)


def _format_parameter(item: ImpedanceAnalysis, key: str, default: str = "") -> str:
    """Write a parameter of the nominal contact, if its law has it."""
    value = item.problem.loop.contact.spec_fields().get(key)
    return number(float(value), 5) if value is not None else default


def controller_tables(
    loaded: LoadedSpec,
    title: str,
    rows: Sequence[tuple[str, Callable[[T], str]]],
    items: Sequence[T],
) -> list[Table]:
    """Make tables with a row for each quantity that some controller has, and a column for each.

    Every number leads to its controller in the spec.
    """
    tables = []
    for start in range(0, len(items), _COLUMNS):
        group = items[start : start + _COLUMNS]
        cells = [
            (
                label if label in _FREQUENCIES else labelled(label),
                *(linked(loaded, value(item), "controllers", item.name) for item in group),
            )
            for label, value in rows
            if any(map(value, items))
        ]
        tables.append(Table(title, ("", *(item.name for item in group)), tuple(cells)))
    return tables


_POINTS = 400


@styled
def _draw_displayed_impedance(items: Sequence[ImpedanceAnalysis]) -> Figure:
    """Draw the magnitudes of displayed and desired impedance."""
    figure, axes = new_axes(3.9)
    omega = _frequencies(items)
    for index, item in enumerate(items):
        nominal = item.requirement.nominal[0]
        response = item.requirement.displayed(nominal, item.Mt, item.Bt, omega)
        if response is not None:
            look = curve(index, len(items), len(omega))
            axes.loglog(omega, np.abs(response), label=f"{item.name}, displayed", **look)
        desired, factor = float(item.problem.desired), band_factor(item)
        tint, dashes = color(index), (0, (5, 3))
        label = f"{item.name}, desired"
        axes.axhline(desired, color=tint, linestyle=dashes, linewidth=1.3, label=label)
        axes.fill_between(
            [omega[0], item.problem.bandwidth],
            desired / factor,
            desired * factor,
            color=tint,
            alpha=0.2,
            linewidth=0,
            label=f"{item.name}, within a factor of {factor:.3g}",
        )
    low = min(axes.get_ylim()[0], *(float(item.problem.desired) for item in items))
    axes.set_ylim(low, None)
    _finish(axes, items, labelled("Impedance magnitude [N·m·s/rad]"))
    legend(figure, axes)
    return figure


@styled
def _draw_sensitivity(items: Sequence[ImpedanceAnalysis]) -> Figure:
    """Draw the magnitude of the sensitivity where its peak Ms is worst, a curve a controller."""
    figure, axes = new_axes(3.9)
    omega = _frequencies(items)
    for index, item in enumerate(items):
        worst, loops = item.worst(SENSITIVITY_PEAK), _worst_loops(item)
        magnitude = np.abs(1 / (1 + loops.response(omega)[0]))
        peak, frequency = worst.value, float(loops.peak_frequency()[0])
        label = f"{item.name}, Ms = {worst.measure.text(peak)}"
        axes.loglog(omega, magnitude, label=label, **curve(index, len(items), len(omega)))
        if math.isfinite(frequency) and math.isfinite(peak):
            shape, tint = marker(index), color(index)
            axes.plot(frequency, peak, shape, color=tint, markeredgecolor=INK, markersize=8)
    axes.axhline(1.0, color=MUTED, linewidth=1.0)
    _finish(axes, items, "Sensitivity magnitude [1]")
    legend(figure, axes)
    return figure


def _worst_loops(item: ImpedanceAnalysis) -> Loops:
    """Return the open loop at the corner where Ms is worst."""
    corner = item.requirement.corner(item.worst(SENSITIVITY_PEAK).where)
    return item.requirement.loops(corner, np.array([item.Mt]), np.array([item.Bt]))


def band_factor(item: ImpedanceAnalysis) -> float:
    """Return the factor within which the displayed impedance must be: the goal, or the usual."""
    goals = (f.goal for f in item.achieved if f.measure is IMPEDANCE_ERROR and f.goal)
    return next(goals, IMPEDANCE_ERROR.doubtful or 2.0)


def _frequencies(items: Sequence[ImpedanceAnalysis]) -> FloatArray:
    """Return frequencies in rad/s from far below the bandwidth to beyond it and every peak."""
    bandwidth = items[0].problem.bandwidth
    peaks = [float(_worst_loops(item).peak_frequency()[0]) for item in items]
    highest = 10 * max([bandwidth, *(peak for peak in peaks if math.isfinite(peak))])
    period = _worst_loops(items[0]).period
    return np.geomspace(
        bandwidth / 100, min(highest, math.pi / (period or math.pi / highest)), _POINTS
    )


def _finish(axes: Axes, items: Sequence[ImpedanceAnalysis], ylabel: str) -> None:
    bandwidth = items[0].problem.bandwidth
    label = f"bandwidth {bandwidth / (2 * math.pi):.3g} Hz"
    axes.axvline(bandwidth, color=MUTED, linewidth=1.4, linestyle=":", label=label)
    axes.set(xlabel="Frequency [rad/s]", ylabel=ylabel, xlim=(bandwidth / 100, None))
