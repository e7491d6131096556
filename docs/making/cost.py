"""Figures of the cost of an impedance design, computed by the package."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nrs_design.design.impedance_optimum import (
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
    stabilizes,
)
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLUE, ORANGE, GREY = "#0b5394", "#b45309", "#555555"


def problem_of(spec: Path, controller: str) -> ImpedanceProblem:
    """Return what the package minimizes for a controller of a spec."""
    designed = run_design(read_spec(spec))
    assert designed is not None
    (found,) = [one for one in run_analysis(designed).impedance if one.name == controller]
    return found.problem


def cost_figures(spec: Path) -> dict[str, bytes]:
    """Draw the landscape and the two parts of the cost, as SVG by file name."""
    problem = problem_of(spec, "insertion")
    return {
        "cost-landscape.svg": _svg(_landscape(problem)),
        "cost-parts.svg": _svg(_parts(problem)),
        "cost-weights.svg": _svg(_weights(problem)),
    }


def _figure() -> tuple[Figure, Any]:
    from nrs_design.plotting import Figure

    figure = Figure(figsize=(6, 4), layout="constrained")
    return figure, figure.add_subplot()


def _svg(figure: Figure) -> bytes:
    import matplotlib as mpl

    buffer = io.BytesIO()
    # The same drawing makes the same bytes.
    with mpl.rc_context({"svg.hashsalt": "nrs-design", "svg.fonttype": "path", "font.size": 11}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def _in_decimals(axis: Any, values: list[float]) -> None:
    axis.set_ticks(values, [f"{value:g}" for value in values])
    axis.set_ticks([], minor=True)


def _landscape(problem: ImpedanceProblem) -> Figure:
    figure, axes = _figure()
    Mt, Bt = np.meshgrid(np.geomspace(0.01, 1, 120), np.geomspace(0.3, 20, 160))
    costs = impedance_cost(problem, Mt, Bt)
    stable = stabilizes(problem.loop, Mt, Bt)
    drawn = axes.contourf(
        Mt,
        Bt,
        np.where(stable, costs, np.nan),
        np.arange(0.1, 1.01, 0.05),
        cmap="Blues",
        extend="max",
    )
    figure.colorbar(drawn, label="cost J")
    axes.contourf(Mt, Bt, stable, [-0.5, 0.5], colors=["#dddddd"])
    optimum = optimize_impedance(problem)
    axes.plot([optimum.Mt], [optimum.Bt], "o", color=ORANGE, ms=9, clip_on=False, zorder=5)
    said = f"minimum {optimum.cost:.3f} at Mt = {optimum.Mt:.3g}, Bt = {optimum.Bt:.3g}"
    axes.annotate(said, (optimum.Mt, optimum.Bt), (12, -4), textcoords="offset points")
    axes.text(0.97, 0.05, "not stable", transform=axes.transAxes, ha="right", color=GREY)
    axes.set(
        xscale="log", yscale="log", xlabel="virtual mass Mt in kg m²", ylabel="Bt in N m s/rad"
    )
    _in_decimals(axes.xaxis, [0.01, 0.03, 0.1, 0.3, 1])
    _in_decimals(axes.yaxis, [0.5, 1, 2, 5, 10, 20])
    return figure


def _parts(problem: ImpedanceProblem) -> Figure:
    figure, axes = _figure()
    Bt = np.geomspace(0.3, 20, 400)
    mass = np.full_like(Bt, problem.mass_bounds[0])
    stable = stabilizes(problem.loop, mass, Bt)
    parts = {
        "displayed impedance": (1.0, 0.0, BLUE, "--"),
        "sensitivity": (0.0, 1.0, GREY, ":"),
        "cost: half of each": (0.5, 0.5, ORANGE, "-"),
    }
    for label, (displayed, robust, colour, line) in parts.items():
        weighted = replace(problem, weight_displayed=displayed, weight_sensitivity=robust)
        values = np.where(stable, impedance_cost(weighted, mass, Bt), np.nan)
        axes.plot(Bt, values, line, color=colour, label=label, lw=2)
    axes.set(
        xscale="log", xlabel="Bt in N m s/rad, with Mt = 0.01 kg m²", ylabel="part of the cost"
    )
    _in_decimals(axes.xaxis, [0.5, 1, 2, 5, 10, 20])
    axes.set_ylim(0, 1)
    axes.legend(frameon=False)
    return figure


def _weights(problem: ImpedanceProblem) -> Figure:
    figure, axes = _figure()
    shares = np.linspace(0.02, 0.98, 33)
    found = [
        optimize_impedance(
            replace(problem, weight_displayed=share, weight_sensitivity=1 - share)
        ).Bt
        for share in shares
    ]
    axes.plot(shares, found, "o-", color=BLUE, ms=4)
    axes.axhline(problem.desired, color=GREY, lw=1, ls="--")
    axes.text(0.02, problem.desired + 0.03, "Zdes", color=GREY)
    axes.set(xlabel="weight of the displayed impedance (the other one: 1 minus it)")
    axes.set_ylabel("best Bt in N m s/rad")
    return figure
