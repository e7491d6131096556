"""``nrs-design certify-switching``: prove or refute stability under switching."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.certification_summary import certification_summary
from nrs_design.cli.gradient_options import (
    GradientCoordinates,
    MaxUpdates,
    Radius,
    Relaxation,
    Seed,
    StartMode,
    UpdateOrder,
)
from nrs_design.cli.margins_summary import margins_summary
from nrs_design.cli.options import (
    Budget,
    Json,
    LoopCoordinates,
    MaxDegree,
    Memory,
    Quiet,
    SpecFile,
    Verbose,
)
from nrs_design.cli.printing import note, print_json, progress, say
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order
from nrs_design.search.method import Method

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nrs_design.pipeline import Result
    from nrs_design.pipeline.margins import ProofMargins
    from nrs_design.pipeline.subsets import Subset
    from nrs_design.search.certification import Limits


LargestBox = Annotated[
    bool,
    typer.Option(
        "--margin",
        help="Find the largest box of ranges with a proof, the smallest refuted; the same for "
        "delay and period of a sampled loop, and for what disturbs. Takes minutes: each value is "
        "searched for 10 s at most.",
    ),
]
Subsets = Annotated[
    bool,
    typer.Option(
        "--subsets",
        help="Where not all is proved, find what is with as little left out as possible: ranges, "
        "ages of the force sample, loss of contact.",
    ),
]
ShortestDwell = Annotated[
    bool, typer.Option("--shortest-dwell", help="Find the shortest dwell time with a proof.")
]


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
    subsets: Subsets = False,
    relaxation: Relaxation = 1.0,
    radius: Radius = 1.0,
    start_mode: StartMode = None,
    order: UpdateOrder = Order.ROUND_ROBIN,
    seed: Seed = 0,
    max_updates: MaxUpdates = 20_000,
    gradient_coordinates: GradientCoordinates = Coordinates.MEAN_NORM,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Prove or refute exponential stability under the declared switching; keep the certificate.

    Example: nrs-design certify-switching specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.output import CERTIFICATE, check_place
    from nrs_design.ownership import check_certificate
    from nrs_design.pipeline import Overrides, run_certification, search_limits
    from nrs_design.spec import read_spec

    loaded = read_spec(spec)
    path = out or Path("reports") / f"{loaded.spec.name}.cert.json"
    check_certificate(spec, path)
    check_place(path, CERTIFICATE)
    history: list[tuple[int, float]] = []
    gradient = Gradient(
        relaxation, radius, start_mode, order, seed, max_updates, gradient_coordinates
    )
    if method is Method.GRADIENT and as_json:
        gradient = replace(gradient, tell=lambda updates, v: history.append((updates, v)))
    limits = search_limits(loaded.spec, Overrides(max_degree, budget, memory), optimize_rate)
    limits = replace(limits, gradient=gradient)
    with progress(f"certifying {loaded.spec.name}", quiet=quiet) as step:
        result = run_certification(
            loaded,
            method=method,
            coordinates=None if coordinates is None else str(coordinates),
            limits=limits,
            progress=step,
        )
    # What is shown is kept, and told, before the margins: those take minutes.
    written = _write(result, path, quiet=quiet or as_json)
    if not quiet and not as_json:
        _print(result, verbose=verbose)
    asked = _Asked(margin, shortest_dwell, subsets)
    more = _look_further(result, limits, asked, quiet=quiet)
    if as_json:
        content = certification_summary(result, written) | margins_summary(more.margins)
        content |= {"gradient_history": history} if history else {}
        print_json("certify-switching", content | _help_summary(result, more))
    elif not quiet:
        _print_help(result, more)
    raise typer.Exit(exit_codes.OF_VERDICT[str(result.certification.verdict)])


@dataclass(frozen=True, slots=True)
class _Asked:
    """What is to be looked for beside the proof."""

    margin: bool
    shortest_dwell: bool
    subsets: bool

    @property
    def margins(self) -> bool:
        return self.margin or self.shortest_dwell


@dataclass(frozen=True, slots=True)
class _More:
    """What was found beside the proof, and what to do next."""

    asked: _Asked
    margins: ProofMargins
    parts: tuple[Subset, ...] | None
    steps: tuple[str, ...]


def _look_further(result: Result, limits: Limits, asked: _Asked, *, quiet: bool) -> _More:
    from nrs_design.pipeline.margins import run_proof_margins
    from nrs_design.pipeline.subsets import find_subsets, run_subsets

    what = "margins" if asked.margins else "what else is proved"
    with progress(f"{what} of {result.loaded.spec.name}", quiet=quiet, lines=True) as step:
        margins = run_proof_margins(
            result, limits, step, margin=asked.margin, shortest_dwell=asked.shortest_dwell
        )
        look = run_subsets if asked.subsets else find_subsets
        parts = look(result, limits, step)
    return _More(asked, margins, parts, _next_steps(result, asked, parts))


def _write(result: Result, path: Path, *, quiet: bool) -> Path | None:
    """Write the certificate, if there is one; return where it is."""
    from nrs_design.certificates.certificate import dump
    from nrs_design.output import CERTIFICATE, write_output
    from nrs_design.ownership import origin_of

    if result.certificate is None:
        return None
    origin = origin_of(result.loaded.path, path)
    write_output(path, dump(result.certificate, origin), replaces=CERTIFICATE)
    note(f"certificate written to {path}", quiet=quiet)
    return path


def _help_summary(result: Result, more: _More) -> dict[str, Any]:
    """Return what ``--json`` prints about what would help."""
    from nrs_design.pipeline import find_relief

    told: dict[str, Any] = {"relief": list(find_relief(result)), "next_steps": list(more.steps)}
    if more.parts is not None:
        told["subsets"] = [
            {"left_out": p.left_out, "claim": p.claim or None, "needs": p.needs} for p in more.parts
        ]
        told["subsets_without"] = list(_unlooked(result))
    return told


def _print_help(result: Result, more: _More) -> None:
    from nrs_design.pipeline import find_relief

    for line in (*find_relief(result), *_margin_lines(result, more)):
        say(f"  {line}")
    _print_subsets(result, more.parts)
    for line in more.steps:
        say(f"next: {line}")


def _margin_lines(result: Result, more: _More) -> Iterator[str]:
    # Reports are slow to load, and a bare proof says nothing that only they can.
    if more.asked.margins:
        from nrs_design.reporting.margins import margin_lines

        yield from margin_lines(more.margins, result.loaded)


def _next_steps(result: Result, asked: _Asked, parts: tuple[Subset, ...] | None) -> tuple[str, ...]:
    if str(result.certification.verdict) == "proved":
        return ()
    from nrs_design.reporting.next_steps import next_steps

    return next_steps(
        result,
        margin=asked.margin,
        shortest_dwell=asked.shortest_dwell,
        subsets=parts is not None,
        spec=result.loaded.path,
    )


def _print_subsets(result: Result, parts: tuple[Subset, ...] | None) -> None:
    if parts is None or (not parts and str(result.certification.verdict) == "proved"):
        return
    from nrs_design.pipeline.subsets import parts_title, subset_lines

    say(f"  {parts_title(result)}:")
    for line in subset_lines(parts):
        say(f"  {line}")
    if unlooked := " and ".join(_unlooked(result)):
        say(f"  decided without {unlooked}: no bound under them was looked at")


def _unlooked(result: Result) -> tuple[str, ...]:
    """Return what the list of parts is decided without: the bounds of a proof are in it."""
    proved = str(result.certification.verdict) == "proved"
    return ("disturbances",) if result.certification.system.channels and not proved else ()


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
        # What was looked for and is missing must not look like something that nobody wanted.
        sought = attempt.step.startswith(("bound on ", "constant force", "decay under"))
        missing = sought and attempt.outcome != "found"
        if everything or missing:
            # What was not looked for took no time.
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
