"""``nrs-design certify-switching``: prove or refute stability under switching."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.goals import print_granted
from nrs_design.cli.options import Budget, MaxDegree, Memory, SpecFile
from nrs_design.cli.printing import note, progress, say, wants_details, wants_text
from nrs_design.search.method import Method

if TYPE_CHECKING:
    from nrs_design.pipeline.blocked import Blocked
    from nrs_design.pipeline.certification import Result
    from nrs_design.pipeline.margins import ProofMargins
    from nrs_design.search.certification import Limits


LargestBox = Annotated[
    bool,
    typer.Option(
        "--margin",
        help="Find the largest box of ranges with a proof, the smallest refuted; the same for "
        "delay and period of a sampled loop, and for what disturbs. Takes "
        "minutes: each value is searched for 10 s at most.",
    ),
]
ShortestDwell = Annotated[
    bool, typer.Option("--shortest-dwell", help="Find the shortest dwell time with a proof.")
]


@command("certify-switching", each_axis=True)
def certify_switching(
    spec: SpecFile,
    out: Annotated[Path | None, typer.Option(help="Write the certificate to this file.")] = None,
    method: Annotated[Method, typer.Option(help="One rung of the ladder, or all.")] = Method.AUTO,
    optimize_rate: Annotated[
        bool, typer.Option(help="Look for the largest provable decay rate.")
    ] = True,
    max_degree: MaxDegree = None,
    budget: Budget = None,
    memory: Memory = None,
    margin: LargestBox = False,
    shortest_dwell: ShortestDwell = False,
) -> Answer:
    """Prove or refute exponential stability under the declared switching.

    `gate` writes certificates where it looks for them; --out writes one elsewhere.

    Example: nrs-design certify-switching specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.api.decision import Decision, Further
    from nrs_design.certificates.ownership import check_certificate
    from nrs_design.output import CERTIFICATE, check_place
    from nrs_design.pipeline.certification import Overrides, find_relief, search_limits
    from nrs_design.pipeline.runs import run_certification

    loaded = take_spec(spec)
    if out is not None:
        check_certificate(spec, out)
        check_place(out, CERTIFICATE)
    limits = search_limits(loaded.spec, Overrides(max_degree, budget, memory), optimize_rate)
    with progress(f"certifying {loaded.spec.name}") as step:
        result = run_certification(loaded, method=method, limits=limits, progress=step)
    verdict = str(result.certification.verdict)
    # Write and print the proof before looking for margins, which takes minutes.
    decision = Decision(result, _write(result, out))
    if wants_text():
        for line in decision.lines(verbose=wants_details()):
            say(line, verdict=verdict if verdict.upper() in line else "")
        print_granted(result)
    searches = {"margin": margin, "shortest_dwell": shortest_dwell}
    further = Further(
        # A single search method may miss a proof that the other methods find.
        blocked=_find_blocked(result, limits) if method is Method.AUTO else None,
        margins=_find_margins(result, limits, searches),
        relief=find_relief(result),
        steps=_next_steps(result, searches),
    )
    decision = replace(decision, further=further)

    def show() -> None:
        for line in further.lines(loaded, verbose=wants_details()):
            say(line)

    return Answer(decision.to_dict, show, exit_codes.VERDICT_CODES[verdict])


def _find_blocked(result: Result, limits: Limits) -> Blocked | None:
    if str(result.certification.verdict) != "inconclusive":
        return None
    from nrs_design.pipeline.blocked import find_blocked

    with progress(f"why {result.loaded.spec.name} is not proved") as step:
        return find_blocked(result, limits, step)


def _find_margins(result: Result, limits: Limits, searches: Mapping[str, bool]) -> ProofMargins:
    from nrs_design.pipeline.margins import run_proof_margins

    with progress(f"margins of {result.loaded.spec.name}", lines=True) as step:
        return run_proof_margins(result, limits, step, **searches)


def _next_steps(result: Result, searches: Mapping[str, bool]) -> tuple[str, ...]:
    if str(result.certification.verdict) == "proved":
        return ()
    from nrs_design.reporting.remedies import next_steps

    return next_steps(result, **searches, spec=result.loaded.path)


def _write(result: Result, path: Path | None) -> Path | None:
    """Write a certificate to the requested path; return the path, or None if nothing is written."""
    from nrs_design.certificates.ownership import write_certificate

    if result.certificate is None or path is None:
        return None
    write_certificate(result.certificate, result.loaded.path, path)
    note(f"certificate written to {path}")
    return path
