"""``nrs-design certify-switching``: prove or refute stability under switching."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, Together, command
from nrs_design.cli.facts import (
    blocked_facts,
    certification_facts,
    margins_facts,
    radius_facts,
)
from nrs_design.cli.gradient_options import (
    GradientCoordinates,
    MaxUpdates,
    Radius,
    Relaxation,
    Seed,
    StartMode,
    UpdateOrder,
)
from nrs_design.cli.options import Budget, LoopCoordinates, MaxDegree, Memory, SpecFile, Verbose
from nrs_design.cli.printing import note, progress, say, wants_json, wants_text
from nrs_design.cli.reading import take_spec
from nrs_design.proof.text import exact_text
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order
from nrs_design.search.method import Method

if TYPE_CHECKING:
    from nrs_design.pipeline import Result
    from nrs_design.pipeline.radius import RadiusBounds
    from nrs_design.pipeline.subsets import Subset


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


def _together(axes: Sequence[Mapping[str, Any]]) -> Together:
    """Say what the certificates of the axes of an arm show of all at once; each is read again."""
    from nrs_design.certificates.together import rate_together
    from nrs_design.certificates.verify import verify
    from nrs_design.proof.bounds import at_least, at_most

    files = [axis["certificate"] for axis in axes]
    checked = [verify(Path(file)) for file in files if file is not None]
    held = [item.certificate for item in checked if item and item.certificate is not None]
    rate = rate_together(held) if len(held) == len(axes) else None
    if rate is None:
        return None, {"together": None}
    period = held[0].system.sample_time
    assert period is not None
    line = (
        f"together: PROVED: all {len(axes)} axes, through an arm of the stated mobility, taken on "
        f"trust: rho {at_most(rate)} per step, alpha {at_least((1 - rate) / period, '1/s')}"
    )
    return line, {"together": {"verdict": "proved", "rate": exact_text(rate)}}


@command("certify-switching", each_axis=True, together=_together)
def certify_switching(
    spec: SpecFile,
    out: Annotated[
        Path | None, typer.Option(help="Certificate file; default reports/NAME.cert.json.")
    ] = None,
    method: Annotated[Method, typer.Option(help="One rung of the ladder, or all.")] = Method.AUTO,
    coordinates: LoopCoordinates = None,
    optimize_rate: Annotated[
        bool, typer.Option(help="Look for the largest provable decay rate.")
    ] = True,
    max_degree: MaxDegree = None,
    budget: Budget = None,
    memory: Memory = None,
    margin: LargestBox = False,
    shortest_dwell: ShortestDwell = False,
    relaxation: Relaxation = 1.0,
    radius: Radius = 1.0,
    start_mode: StartMode = None,
    order: UpdateOrder = Order.ROUND_ROBIN,
    seed: Seed = 0,
    max_updates: MaxUpdates = 20_000,
    gradient_coordinates: GradientCoordinates = Coordinates.MEAN_NORM,
    verbose: Verbose = False,
) -> Answer:
    """Prove or refute exponential stability under the declared switching; keep the certificate.

    Example: nrs-design certify-switching specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.output import CERTIFICATE, check_place
    from nrs_design.ownership import check_certificate
    from nrs_design.pipeline import Overrides, find_relief, run_certification, search_limits
    from nrs_design.pipeline.margins import run_proof_margins
    from nrs_design.pipeline.subsets import find_subsets

    loaded = take_spec(spec)
    path = out or Path("reports") / f"{loaded.spec.name}.cert.json"
    check_certificate(spec, path)
    check_place(path, CERTIFICATE)
    history: list[tuple[int, float]] = []
    gradient = Gradient(
        relaxation, radius, start_mode, order, seed, max_updates, gradient_coordinates
    )
    if method is Method.GRADIENT and wants_json():
        gradient = replace(gradient, tell=lambda updates, v: history.append((updates, v)))
    limits = search_limits(loaded.spec, Overrides(max_degree, budget, memory), optimize_rate)
    limits = replace(limits, gradient=gradient)
    with progress(f"certifying {loaded.spec.name}") as step:
        result = run_certification(
            loaded,
            method=method,
            coordinates=None if coordinates is None else str(coordinates),
            limits=limits,
            progress=step,
        )
    # Write and print the proof before looking for margins, which takes minutes.
    written = _write(result, path)
    if wants_text():
        _print(result, verbose=verbose)
    asked = {"margin": margin, "shortest_dwell": shortest_dwell}
    blocked = None
    # One rung alone may be at a loss for what others prove.
    if method is Method.AUTO and str(result.certification.verdict) == "inconclusive":
        from nrs_design.pipeline.blocked import find_blocked

        with progress(f"why {loaded.spec.name} is not proved", lines=True) as step:
            blocked = find_blocked(result, limits, step)
    what = "margins" if any(asked.values()) else "what else is proved"
    with progress(f"{what} of {loaded.spec.name}", lines=True) as step:
        margins = run_proof_margins(result, limits, step, **asked)
        parts = find_subsets(result, limits, step)
    growth = None
    if result.certification.system.time == "discrete":
        from nrs_design.pipeline.radius import bound_radius

        growth = bound_radius(result.certification, limits)
    relief = find_relief(result)
    steps = _next_steps(result, **asked)

    def facts() -> dict[str, Any]:
        more: dict[str, Any] = {"gradient_history": history} if history else {}
        more |= {"relief": list(relief), "next_steps": list(steps)}
        return (
            certification_facts(result, written)
            | radius_facts(growth)
            | margins_facts(margins)
            | more
            | _parts_facts(parts)
            | ({} if blocked is None else blocked_facts(blocked, loaded.path))
        )

    def show() -> None:
        if growth is not None:
            say(f"  {_growth_words(growth)}")
        for line in relief:
            say(f"  {line}")
        if any(asked.values()):
            # Reports are slow to load, and a bare proof says nothing that only they can.
            from nrs_design.reporting.margins import margin_lines

            for line in margin_lines(margins, loaded):
                say(f"  {line}")
        _print_parts(parts)
        if blocked is not None:
            from nrs_design.pipeline.blocked import blocked_lines

            for line in blocked_lines(blocked, loaded.path):
                say(f"  {line}")
        for line in steps:
            say(f"next: {line}")

    return Answer(facts, show, exit_codes.OF_VERDICT[str(result.certification.verdict)])


def _growth_words(radius: RadiusBounds) -> str:
    """Say between which numbers the largest growth per step is, and how each is shown."""
    from nrs_design.proof.bounds import rounded_down, rounded_up

    low, high = "no word was found that shows how much it is at least", "no upper bound was found"
    if radius.lower is not None and radius.word is not None:
        signal = ", ".join(
            name + (f" {count} times" if count > 1 else "") for name, count in radius.word
        )
        low = f"at least {rounded_down(radius.lower)}, by {signal}, and again"
    if radius.upper is not None:
        high = f"at most {rounded_up(radius.upper)} ({radius.method})"
    if radius.gap is not None:
        high += f"; {rounded_up(100 * radius.gap)} % apart"
    return f"growth per step, rho: {low}; {high}"


def _write(result: Result, path: Path) -> Path | None:
    """Write the certificate, if there is one; return where it is."""
    from nrs_design.certificates.certificate import dump
    from nrs_design.output import CERTIFICATE, write_output
    from nrs_design.ownership import origin_of

    if result.certificate is None:
        return None
    origin = origin_of(result.loaded.path, path)
    write_output(path, dump(result.certificate, origin), replaces=CERTIFICATE)
    note(f"certificate written to {path}")
    return path


def _next_steps(result: Result, **asked: bool) -> tuple[str, ...]:
    if str(result.certification.verdict) == "proved":
        return ()
    from nrs_design.reporting.next_steps import next_steps

    return next_steps(result, **asked, spec=result.loaded.path)


def _parts_facts(parts: tuple[Subset, ...] | None) -> dict[str, Any]:
    if parts is None:
        return {}
    found = [{"left_out": p.left_out, "claim": p.claim or None, "needs": p.needs} for p in parts]
    return {"subsets": found}


def _print_parts(parts: tuple[Subset, ...] | None) -> None:
    if parts is None:
        return
    from nrs_design.pipeline.subsets import PARTS_TITLE, subset_lines

    say(f"  {PARTS_TITLE}:")
    for line in subset_lines(parts):
        say(f"  {line}")


def _print(result: Result, *, verbose: bool) -> None:
    from nrs_design.certificates.goals import certified_goals

    certification = result.certification
    name = result.loaded.spec.name
    verdict = str(certification.verdict)
    refuted = certification.refuted_in
    aside = f"common quadratic function: {certification.common_quadratic}"
    beside = aside if refuted is None else f"refuted {refuted}; {aside}"
    say(f"{name}: {verdict.upper()} ({beside})", verdict=verdict)
    for statement in certification.statements:
        say(f"  {statement.claim(certification.system)}")
    if certification.evidence is None:
        say(f"  {_open_words(refuted)}")
    everything = verbose or certification.evidence is None
    for attempt in certification.attempts:
        # A bound that was wanted and not found must be visible.
        sought = attempt.step.startswith(
            ("bound on ", "constant force", "decay under", "limits of")
        )
        missing = sought and attempt.outcome != "found"
        if everything or missing:
            # Steps that were skipped took no time.
            took = f" ({attempt.work:.2g} of work, {attempt.seconds:.2g} s)"
            took = took if attempt.seconds else ""
            say(f"  {attempt.step}: {attempt.outcome}{took}")
    for goal in certified_goals(result.loaded.spec, result.certificate):
        ends = "met" if goal.met else "NOT PROVED"
        say(f"  goal {goal.key}, {goal.wanted}: {ends}: {goal.said}")
    say("  modes: " + ", ".join(_shortened([m.name for m in certification.system.modes])))
    say("  taken for granted (nrs-design report says how to test each):")
    for assumption in certification.granted:
        say(f"    - {assumption}")


def _open_words(refuted: str | None) -> str:
    if refuted is None:
        return "Neither a proof nor a refutation was found; this is not a statement of stability."
    return (
        f"Refuted {refuted}; where contact may be lost, neither a proof nor a refutation was found."
    )


def _shortened(names: list[str], limit: int = 12) -> list[str]:
    return names if len(names) <= limit else [*names[:limit], f"and {len(names) - limit} more"]
