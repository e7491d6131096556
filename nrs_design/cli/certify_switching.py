"""``nrs-design certify-switching``: prove or refute stability under switching."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.goals import print_goal, print_granted
from nrs_design.cli.options import Budget, MaxDegree, Memory, SpecFile
from nrs_design.cli.printing import note, progress, say, wants_details, wants_text
from nrs_design.facts.certification import (
    blocked_facts,
    certification_facts,
    margins_facts,
)
from nrs_design.search.method import Method

if TYPE_CHECKING:
    from nrs_design.pipeline.certification import Result
    from nrs_design.search.certification import Certification


LargestBox = Annotated[
    bool,
    typer.Option(
        "--margin",
        help="Find the largest box of ranges with a proof, the smallest refuted; the same for "
        "delay and period of a sampled loop, for what disturbs, and for missed deadlines. Takes "
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
    from nrs_design.output import CERTIFICATE, check_place
    from nrs_design.ownership import check_certificate
    from nrs_design.pipeline.certification import Overrides, find_relief, search_limits
    from nrs_design.pipeline.margins import run_proof_margins
    from nrs_design.pipeline.runs import run_certification

    loaded = take_spec(spec)
    if out is not None:
        check_certificate(spec, out)
        check_place(out, CERTIFICATE)
    limits = search_limits(loaded.spec, Overrides(max_degree, budget, memory), optimize_rate)
    with progress(f"certifying {loaded.spec.name}") as step:
        result = run_certification(loaded, method=method, limits=limits, progress=step)
    # Write and print the proof before looking for margins, which takes minutes.
    written = _write(result, out)
    if wants_text():
        _print(result)
    asked = {"margin": margin, "shortest_dwell": shortest_dwell}
    blocked = None
    # One rung alone may be at a loss for what others prove.
    if method is Method.AUTO and str(result.certification.verdict) == "inconclusive":
        from nrs_design.pipeline.blocked import find_blocked

        with progress(f"why {loaded.spec.name} is not proved") as step:
            blocked = find_blocked(result, limits, step)
    with progress(f"margins of {loaded.spec.name}", lines=True) as step:
        margins = run_proof_margins(result, limits, step, **asked)
    relief = find_relief(result)
    steps = _next_steps(result, **asked)

    def facts() -> dict[str, Any]:
        return (
            certification_facts(result, written)
            | margins_facts(margins)
            | {"relief": list(relief), "next_steps": list(steps)}
            | ({} if blocked is None else blocked_facts(blocked, loaded.path))
        )

    def show() -> None:
        found = blocked is not None and blocked.proved
        for line in relief if wants_details() or not found else ():
            say(f"  {line}")
        if any(asked.values()):
            # Reports are slow to load, and a bare proof says nothing that only they can.
            from nrs_design.reporting.remedies import margin_lines

            for line in margin_lines(margins):
                say(f"  {line}")
        if blocked is not None:
            from nrs_design.pipeline.blocked import blocked_lines

            for line in blocked_lines(blocked, loaded.path):
                say(f"  {line}")
        # The most promising comes first; what would be proved is a better one.
        for line in steps if wants_details() else steps[: 0 if found or relief else 1]:
            say(f"next: {line}")

    return Answer(facts, show, exit_codes.OF_VERDICT[str(result.certification.verdict)])


def _write(result: Result, path: Path | None) -> Path | None:
    """Write the certificate, if there is one and it is asked for; return where it is."""
    from nrs_design.ownership import write_certificate

    if result.certificate is None or path is None:
        return None
    write_certificate(result.certificate, result.loaded.path, path)
    note(f"certificate written to {path}")
    return path


def _next_steps(result: Result, **asked: bool) -> tuple[str, ...]:
    if str(result.certification.verdict) == "proved":
        return ()
    from nrs_design.reporting.remedies import next_steps

    return next_steps(result, **asked, spec=result.loaded.path)


def _print(result: Result) -> None:
    from nrs_design.certificates.goals import certified_goals

    certification = result.certification
    system, verdict = certification.system, str(certification.verdict)
    say(f"{result.loaded.spec.name}: {verdict.upper()}{_after(certification)}", verdict=verdict)
    for statement, short in result.briefs:
        say(f"  {statement.claim(system) if wants_details() else short}")
    for attempt in certification.attempts:
        # A bound that was wanted and not found must be visible.
        sought = attempt.step.startswith(("bound on ", "decay under"))
        if wants_details() or (sought and attempt.outcome != "found"):
            # Steps that were skipped took no time.
            took = f" ({attempt.work:.2g} of work, {attempt.seconds:.2g} s)"
            took = took if attempt.seconds else ""
            say(f"  {attempt.step}: {attempt.outcome}{took}")
    for goal in certified_goals(result.loaded.spec, result.certificate):
        print_goal(goal, "  ")
    print_granted(result)


def _after(certification: Certification) -> str:
    """Say beside the verdict what it leaves open."""
    refuted = certification.refuted_in
    if refuted is not None:
        return f" (refuted {refuted}; open where contact may be lost)"
    return "" if certification.evidence is not None else ": no proof, and no signal that grows"
