"""The gradient iteration beside the LMI: what each found, and how the iteration went."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from nrs_design.proof.evidence.fields import rate_words
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.style import color, legend, new_figure, styled
from nrs_design.search.gradient_settings import Order

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.search.method_run import History, MethodRun

COLUMNS = ("method", "coordinates", "order", "outcome", "updates", "proved rate", "condition of Q")
_TEXT = (
    "The same question put to the LMI and to the iteration of Liberzon and Tempo (thesis 5.21 to "
    "5.28). The iteration corrects Q, one mode at a time, until v = lambda_max(A'Q + QA + I) (in "
    "discrete time lambda_max(A'QA - Q + I)) is at most zero in all modes. Which states it works "
    "in decides whether that is soon, late or not within reach. That it ends is no evidence: "
    "every rate here has passed the exact check."
)
_CAPTION = (
    "Largest v over all modes against updates (of more than a hundred, some); a dot is the last "
    "value before an iteration ended with v <= 0, a cross is where it gave up. Each v is measured "
    "in the coordinates of its curve."
)


def methods_section(runs: Sequence[MethodRun], *, times: bool = False) -> Section:
    """Put the runs of a comparison side by side; with times, which differ from run to run."""
    rows = [("Method", "Outcome", "Proved rate", "Condition of Q", "Time [ms]")]
    for run in runs:
        seconds = number(1e3 * run.seconds, 3)
        rows.append((run.name, run.outcome, _rate(run), _condition(run), seconds))
    head, *body = (row if times else row[:-1] for row in rows)
    table = Table("One common quadratic function, searched in several ways", head, tuple(body))
    figure = Illustration(
        "methods", "Way of the gradient iteration", _CAPTION, draw_histories(runs)
    )
    drawn = (figure,) if any(run.histories for run in runs) else ()
    return Section("Gradient iteration beside LMI", (Paragraph(_TEXT), table, *drawn))


def cells_of(run: MethodRun) -> tuple[str, ...]:
    """Write one run in `COLUMNS`."""
    return (
        str(run.method),
        str(run.coordinates or ""),
        str(run.order or ""),
        run.outcome,
        "" if run.updates is None else str(run.updates),
        _rate(run),
        _condition(run),
    )


def _rate(run: MethodRun) -> str:
    evidence, system = run.certification.evidence, run.certification.system
    rate = None if evidence is None else evidence.proved_rate(system)
    return "none" if rate is None else rate_words(rate, system.time)


def _condition(run: MethodRun) -> str:
    return "" if run.condition is None else f"{run.condition:.3g}"


TITLES = {Order.ROUND_ROBIN: "Modes in turn", Order.RANDOM: "Modes at random"}


@styled
def draw_histories(runs: Sequence[MethodRun]) -> Figure:
    """Draw one curve for every run of the iteration: a panel for each order of the modes.

    The LMI is left out. Of a family in blocks, the longest way is drawn.
    """
    drawn = [run for run in runs if run.histories]
    orders = list(dict.fromkeys(run.order for run in drawn if run.order))
    coordinates = list(dict.fromkeys(run.coordinates for run in drawn))
    figure = new_figure(0.9 + 2.1 * len(orders))
    panels = figure.subplots(len(orders), sharex=True, sharey=True, squeeze=False)[:, 0]
    for axes, order in zip(panels, orders, strict=True):
        axes.set_title(TITLES[order], fontsize=10)
        axes.set(xscale="log", yscale="log", ylabel="Largest v [1]")
        for run in drawn:
            if run.order == order:
                look = color(coordinates.index(run.coordinates))
                _draw_history(axes, max(run.histories, key=len), look, str(run.coordinates))
    panels[-1].set_xlabel("Update, the start being 1 [1]")
    legend(figure, panels[0], columns=3)
    return figure


def _draw_history(axes: Axes, history: History, look: str, label: str) -> None:
    """Draw v where it is above zero, and mark how the iteration ended."""
    above = [(1 + updates, v) for updates, v in history if v > 0]
    steps, values = zip(*above, strict=True) if above else ((), ())
    axes.plot(steps, values, color=look, label=label, linewidth=1.0)
    ended = history[-1][1] <= 0
    axes.plot(steps[-1:], values[-1:], "o" if ended else "X", color=look, markersize=7, zorder=3)
