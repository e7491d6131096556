"""``nrs-design pareto``: what a little more cost buys, proved."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress
from nrs_design.cli.reading import take_spec
from nrs_design.design.objective import Objective

if TYPE_CHECKING:
    from nrs_design.output import Output
    from nrs_design.pipeline.trade_point import TradeOffPoint

MOST_SHARES = 24
COST = "cost"


def read_shares(text: str) -> tuple[Fraction, ...]:
    """Read shares in percent for an option; raises `typer.BadParameter` on anything else."""
    try:
        shares = tuple(Fraction(part.strip()) / 100 for part in text.split(","))
    except (ValueError, ZeroDivisionError):
        shares = ()
    if not shares or not all(0 < share <= 10 for share in shares) or len(shares) > MOST_SHARES:
        raise typer.BadParameter(
            f"{text!r} are no shares: give up to {MOST_SHARES} numbers in percent, above 0 and at "
            "most 1000, such as 1,2,5,10"
        )
    return tuple(sorted(set(shares)))


def read_objectives(text: str) -> tuple[Objective, ...]:
    """Read what cost is traded for; raises `typer.BadParameter` on anything else."""
    names = dict.fromkeys(part.strip() for part in text.split(","))
    known = [*map(str, Objective)]
    unknown = next((name for name in names if name not in (COST, *known)), None)
    if unknown is not None or not set(names) - {COST}:
        what = "nothing but cost" if unknown is None else f"{unknown!r}, which is none"
        raise typer.BadParameter(f"{what}: give some of {', '.join(known)}, beside cost")
    return tuple(Objective(name) for name in names if name != COST)


@command("pareto")
def pareto(
    spec: SpecFile,
    objectives: Annotated[
        str,
        typer.Option(
            metavar="NAMES",
            help="What cost is traded for, each for itself: some of cost,stiffness,decay-rate,"
            "delay,peak-torque,noise.",
        ),
    ] = "cost,stiffness",
    above: Annotated[
        str,
        typer.Option(
            metavar="PERCENT", help="By how much the cost may be above its least: 1,2,5,10,20."
        ),
    ] = "1,2,5,10,20",
    given: Annotated[
        list[Path] | None,
        typer.Option(
            "--with",
            metavar="SPEC",
            help="Prove the design of this spec, too, and draw it in; may be repeated.",
        ),
    ] = None,
    figure: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the points as a PNG image.")
    ] = None,
    table: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Write a row for every point.")
    ] = None,
) -> Answer:
    """Trade cost for what can be proved: the best for each cost, with its gains.

    For each share that the cost may be above its least: the largest stiffness, the fastest decay,
    the least bound on the force, or the least noise; and for each age of the force the cheapest
    gains. Goals decay_rate, peak_torque, delay, and those of each controller, hold in every point.
    Every point is rounded to gains that ship, and its certificate is checked exactly. Where Mt may
    be zero, designs without virtual masses and with them are two curves.

    Example: nrs-design pareto specs/neuroboscope/soft-tissue-sampled.nrs.yaml --above 2,5,10
    """
    from nrs_design.cli.pareto_answer import facts_of, show, table_text
    from nrs_design.output import PARETO, PNG, check_place, write_outputs
    from nrs_design.pipeline import run_analysis, run_interaction
    from nrs_design.pipeline.trade_off import run_trade_off

    shares, wanted = read_shares(above), read_objectives(objectives)
    for path, kind in ((figure, PNG), (table, PARETO)):
        if path is not None:
            check_place(path, kind)
    loaded = take_spec(spec)
    with progress(f"trading cost for {', '.join(wanted)} of {loaded.spec.name}") as step:
        beside = {one.name: _given(one, step) for one in given or ()}
        designed = run_interaction(loaded, "has no gains to choose")
        curves = run_trade_off(designed, run_analysis(designed), wanted, shares, step)
    outputs: list[Output] = []
    if figure is not None:
        from nrs_design.reporting.figures.trade_off import draw_trade_off
        from nrs_design.reporting.images import to_png

        outputs.append((figure, to_png(draw_trade_off(curves, beside, wanted)), PNG))
    if table is not None:
        outputs.append((table, table_text(curves, beside, wanted), PARETO))
    write_outputs(outputs)
    for path in (figure, table):
        if path is not None:
            note(f"written: {path}")
    return Answer(
        lambda: facts_of(loaded, wanted, curves, beside),
        lambda: show(loaded, wanted, curves, beside),
    )


def _given(path: Path, step: Any) -> TradeOffPoint | None:
    """Return the design of a spec as it stands; None if nothing is proved of it."""
    from nrs_design.pipeline.design import interaction_of
    from nrs_design.pipeline.trade_point import given_point

    loaded = take_spec(path)
    interaction_of(loaded, "has no gains to be compared")
    step(f"design of {path.name}")
    return given_point(loaded)


Given = dict[str, "TradeOffPoint | None"]
Objectives = Sequence[Objective]
