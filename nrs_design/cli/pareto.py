"""``nrs-design pareto``: what a little more cost buys, proved."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.axis import unit
from nrs_design.cli.command import Answer, command, spec_facts
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.cli.reading import take_spec
from nrs_design.cli.tables import print_table
from nrs_design.design.objective import Objective
from nrs_design.proof.bounds import lower, lower_float, upper, upper_float

if TYPE_CHECKING:
    from nrs_design.pipeline.trade_off import TradeOffCurve, TradeOffPoint
    from nrs_design.spec import LoadedSpec

FREE, MOST_SHARES = "least", 24


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


@command("pareto")
def pareto(
    spec: SpecFile,
    objective: Annotated[
        Objective, typer.Option(help="What is to be as large as can be proved.")
    ] = Objective.STIFFNESS,
    above: Annotated[
        str,
        typer.Option(
            metavar="PERCENT", help="By how much the cost may be above its least: 1,2,5,10,20."
        ),
    ] = "1,2,5,10,20",
    figure: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the points as a PNG image.")
    ] = None,
) -> Answer:
    """Trade cost for stiffness or decay: the most that is proved for each cost, with its gains.

    Every point is rounded to gains that ship, and its certificate is checked exactly. Where Mt may
    be zero, designs without virtual masses and with them are two curves.

    Example: nrs-design pareto specs/neuroboscope/soft-tissue-sampled.nrs.yaml --above 2,5,10
    """
    from nrs_design.output import PNG, check_place, write_output
    from nrs_design.pipeline import run_analysis, run_interaction
    from nrs_design.pipeline.trade_off import run_trade_off

    shares = read_shares(above)
    if figure is not None:
        check_place(figure, PNG)
    loaded = take_spec(spec)
    with progress(f"trading cost for {objective} of {loaded.spec.name}") as step:
        designed = run_interaction(loaded, "has no gains to choose")
        curves = run_trade_off(designed, run_analysis(designed), objective, shares, step)
    if figure is not None:
        from nrs_design.reporting.figures.trade_off import draw_trade_off
        from nrs_design.reporting.images import to_png

        write_output(figure, to_png(draw_trade_off(curves, objective)), replaces=PNG)
        note(f"figure written to {figure}")
    return Answer(
        lambda: _facts(loaded, objective, curves), lambda: _print(loaded, objective, curves)
    )


def _facts(
    loaded: LoadedSpec, objective: Objective, curves: Sequence[TradeOffCurve]
) -> dict[str, Any]:
    return {
        **spec_facts(loaded),
        "objective": str(objective),
        "curves": [
            {
                "massless": curve.massless,
                "least_cost": curve.least_cost,
                "points": [_point(point) for point in curve.points],
            }
            for curve in curves
        ],
        "units": {"stiffness": unit("N*m/rad"), "decay_rate": "1/s", "force": unit("N*m")},
    }


def _point(point: TradeOffPoint) -> dict[str, Any]:
    certificate = point.result.certificate
    assert certificate is not None, "a point is proved"
    force = point.force
    return {
        "allowed_above": None if point.share is None else float(point.share),
        "cost": point.cost,
        "stiffness": {name: lower_float(high) for name, high in point.stiffness.items()},
        "decay_rate": lower_float(point.rate),
        "force": None if force is None else upper_float(force),
        "gains": {f"{name}.{gain}": text for (name, gain), text in point.gains.items()},
        "certificate_id": certificate.id,
        "text": point.result.loaded.text,
    }


def _print(loaded: LoadedSpec, objective: Objective, curves: Sequence[TradeOffCurve]) -> None:
    contacts = [*curves[0].points[0].stiffness] if curves[0].points else []
    bounded = any(point.force is not None for curve in curves for point in curve.points)
    for curve in curves:
        names = [key for point in curve.points[:1] for key in point.gains]
        columns = [
            "cost",
            "above\nleast",
            *(f"{name}: k up to\n{unit('N m/rad')}" for name in contacts),
            "decay\n1/s",
            *([f"force\n{unit('N m')}"] if bounded else []),
            *(f"{name}\n{gain}" for name, gain in names),
        ]
        rows = [
            [
                f"{point.cost:.4f}",
                FREE
                if point.share is None
                else f"{100 * (point.cost / curve.least_cost - 1):.1f} %",
                *(lower(high, 4) for high in point.stiffness.values()),
                lower(point.rate, 3),
                *([upper(point.force, 3) if point.force is not None else "–"] if bounded else []),
                *(text.split()[0] for text in point.gains.values()),
            ]
            for point in curve.points
        ]
        kind = "no virtual mass" if curve.massless else "with virtual mass"
        print_table(f"{loaded.spec.name}: {objective} for cost, {kind}", columns, rows)
        if not rows:
            say("nothing was proved at these costs")
    say("Proved for all stiffness up to k, and all else that the spec declares.")
    say("Cost: that of optimize at nominal values, of all controllers, in floating point.")
