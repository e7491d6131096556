"""``nrs-design compare-methods``: the searches for a common quadratic function, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.options import Budget, Memory, SpecFile
from nrs_design.cli.printing import progress, say
from nrs_design.cli.tables import print_table
from nrs_design.search.method import Method

if TYPE_CHECKING:
    from nrs_design.pipeline.certification import Result

METHODS = (Method.LMI, Method.GRADIENT)


@command("compare-methods")
def compare_methods(spec: SpecFile, budget: Budget = None, memory: Memory = None) -> Answer:
    """Look for a common quadratic function by LMI and by the Liberzon-Tempo gradient iteration.

    Each function is checked exactly; that an iteration ends is no evidence. Exit code 0 if one
    method proved stability, 1 if a mode was refuted, 3 otherwise.

    Example: nrs-design compare-methods specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.pipeline.certification import Overrides, certify_design, search_limits
    from nrs_design.pipeline.runs import run_design

    loaded = take_spec(spec)
    limits = search_limits(loaded.spec, Overrides(budget=budget, memory=memory))
    found = {}
    with progress(f"comparing on {loaded.spec.name}") as step:
        designed = run_design(loaded, step)
        for method in METHODS:
            step(str(method))
            found[method] = certify_design(loaded, designed, method=method, limits=limits)
    verdicts = {str(result.certification.verdict) for result in found.values()}
    best = next((v for v in ("refuted", "proved") if v in verdicts), "inconclusive")

    def show() -> None:
        columns = ("method", "verdict", "proved rate", "search", "time\nms")
        rows = [[str(method), *_cells(method, result)] for method, result in found.items()]
        print_table(loaded.spec.name, columns, rows)
        say("Rates are proved.")

    return Answer(lambda: _facts(found), show, exit_codes.VERDICT_CODES[best])


def _cells(method: Method, result: Result) -> tuple[str, ...]:
    """Write verdict, proved rate, how the search of the method ended, and its time."""
    from nrs_design.proof.evidence.fields import rate_words

    found = result.certification
    rate = None if found.evidence is None else found.evidence.proved_rate(found.system)
    ends = [attempt.outcome for attempt in found.attempts if method in attempt.step]
    seconds = sum(attempt.seconds for attempt in found.attempts)
    rate_text = "none" if rate is None else rate_words(rate, found.system.time)
    return str(found.verdict), rate_text, "; ".join(ends) or "not needed", f"{1e3 * seconds:.1f}"


def _facts(results: dict[Method, Result]) -> dict[str, Any]:
    from nrs_design.api.proof_facts import certification_facts

    runs = [
        {**certification_facts(result, None), "method": str(method)}
        for method, result in results.items()
    ]
    return {"runs": runs}
