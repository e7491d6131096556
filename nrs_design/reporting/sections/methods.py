"""The gradient iteration beside the LMI: what each found, and how the iteration went."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.proof.evidence.fields import rate_words
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.methods import draw_histories
from nrs_design.reporting.formatting import number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nrs_design.search.method_run import MethodRun

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
    """Put the runs of a comparison side by side.

    Parameters
    ----------
    runs : sequence of MethodRun
        As `nrs_design.pipeline.run_comparison` gives them.
    times : bool
        Add how long each took; that differs from run to run.
    """
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
