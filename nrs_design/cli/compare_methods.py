"""``nrs-design compare-methods``: the gradient iteration beside the LMI."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.options import Budget, GradientSettings, Memory, SpecFile
from nrs_design.cli.printing import progress, say
from nrs_design.cli.tables import print_table
from nrs_design.search.gradient_settings import Gradient

if TYPE_CHECKING:
    from nrs_design.proof.system import SwitchedSystem
    from nrs_design.search.comparison import MethodRun
    from nrs_design.spec import LoadedSpec

COLUMNS = ("method", "coordinates", "order", "outcome", "updates", "proved rate", "condition of Q")


@command("compare-methods")
def compare_methods(
    spec: SpecFile,
    optimize_rate: Annotated[
        bool, typer.Option(help="Let every method look for the largest decay rate, too.")
    ] = False,
    settings: GradientSettings = None,
    budget: Budget = None,
    memory: Memory = None,
) -> Answer:
    """Look for a common quadratic function by LMI and by the Liberzon-Tempo gradient iteration.

    The iteration runs in three kinds of coordinates, with the modes in turn and at random. What
    any of them finds is checked exactly; that an iteration ends is no evidence. Exit code 0 if one
    of them proved stability, 1 if a mode was refuted, 3 otherwise.

    Example: nrs-design compare-methods specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.pipeline.certification import Overrides, search_limits
    from nrs_design.pipeline.runs import run_comparison

    loaded = take_spec(spec)
    gradient = Gradient.of_texts(settings or ())
    limits = search_limits(loaded.spec, Overrides(budget=budget, memory=memory), optimize_rate)
    limits = replace(limits, gradient=gradient)
    with progress(f"comparing on {loaded.spec.name}") as step:
        system, runs = run_comparison(loaded, limits, step)
    verdicts = [str(run.certification.verdict) for run in runs]
    best = next((v for v in ("refuted", "proved") if v in verdicts), "inconclusive")
    return Answer(
        lambda: _summary(loaded, system, runs),
        lambda: _print(loaded, system, runs),
        exit_codes.OF_VERDICT[best],
    )


def _summary(
    loaded: LoadedSpec, system: SwitchedSystem, runs: tuple[MethodRun, ...]
) -> dict[str, Any]:
    from nrs_design.api.proof_facts import rate_facts

    return {
        **loaded.facts,
        "time": str(system.time),
        "states": list(system.states),
        "modes": [mode.name for mode in system.modes],
        "runs": [
            {
                "method": str(run.method),
                "coordinates": run.coordinates and str(run.coordinates),
                "order": run.order and str(run.order),
                "verdict": str(run.certification.verdict),
                "outcome": run.outcome,
                "updates": run.updates,
                "seconds": round(run.seconds, 6),
                **rate_facts(run.certification),
                "condition": run.condition,
                "history": [list(map(list, history)) for history in run.histories],
            }
            for run in runs
        ],
    }


def _print(loaded: LoadedSpec, system: SwitchedSystem, runs: tuple[MethodRun, ...]) -> None:
    rows = [[*_cells(run), f"{1e3 * run.seconds:.1f}"] for run in runs]
    modes = len(system.modes)
    print_table(f"{loaded.spec.name}: {modes} modes", [*COLUMNS, "time\nms"], rows)
    say("Rates are proved; the condition number of Q is for the states of the modes.")


def _cells(run: MethodRun) -> tuple[str, ...]:
    """Write one run in `COLUMNS`."""
    from nrs_design.proof.evidence.fields import rate_words

    evidence, system = run.certification.evidence, run.certification.system
    rate = None if evidence is None else evidence.proved_rate(system)
    return (
        str(run.method),
        str(run.coordinates or ""),
        str(run.order or ""),
        run.outcome,
        "" if run.updates is None else str(run.updates),
        "none" if rate is None else rate_words(rate, system.time),
        "" if run.condition is None else f"{run.condition:.3g}",
    )
