"""What a design achieves, and what its runs break."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.errors import DesignError, NrsDesignError
from nrs_design.pipeline.design import Designed, placed
from nrs_design.proof.bounds import upper
from nrs_design.spec import Doubt

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis


def run_analysis(designed: Designed) -> DesignAnalysis:
    """Compute what a design achieves; an unstable nominal loop is a `DesignError`."""
    from nrs_design.design.analysis import analyze_design

    with placed(designed.loaded):
        return analyze_design(designed.spec, designed.plant, designed.design)


def run_judgement(designed: Designed) -> DesignAnalysis:
    """Compute what a design achieves, with what its runs break of the limit of the torque."""
    found = run_analysis(designed)
    return replace(found, doubts=(*found.doubts, *_doubt_runs(designed)))


def judged_if_stable(
    designed: Designed | None, tell: Callable[[str], object] = lambda _: None
) -> DesignAnalysis | None:
    """Compute the same; None of no design, and where a nominal loop has no margins, as is told."""
    try:
        return None if designed is None else run_judgement(designed)
    except DesignError as error:
        tell(error.message)
        return None


def _doubt_runs(designed: Designed) -> Iterator[Doubt]:
    """Yield the runs whose torque is beyond the limit of the spec; what cannot be run has none."""
    from nrs_design.pipeline.scenarios import run_scenarios

    try:
        runs = tuple(run_scenarios(designed))
    except NrsDesignError:
        return
    limit, of = designed.spec.limits.torque, designed.spec.axis.unit("N*m")
    for one in runs:
        peak = one.metrics["peak_torque"]
        # A limit of the scenario itself is judged by the gate.
        if "torque" not in one.scenario.limits and peak > limit.si:
            text = f"simulated, {one.scenario.name}: a torque of {upper(Fraction(peak), 4)} {of}, "
            text += f"beyond limits.torque of {limit.text}"
            yield Doubt(("limits", "torque"), text, beyond=peak / limit.si)
