"""The points of `nrs-design pareto`, for people, for programs, and as a table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from nrs_design.axis import unit
from nrs_design.cli.printing import say
from nrs_design.cli.tables import print_table
from nrs_design.design.objective import Objective
from nrs_design.facts.spec import spec_facts
from nrs_design.pipeline.trade_point import TradeOffPoint, is_dominated
from nrs_design.proof.bounds import lower, lower_float, upper, upper_float

if TYPE_CHECKING:
    from nrs_design.pipeline.trade_off import TradeOffCurve
    from nrs_design.spec import LoadedSpec

    Given = Mapping[str, TradeOffPoint | None]

FREE, NONE = "least", "–"
CAPTIONS = {
    Objective.STIFFNESS: "stiffness for cost",
    Objective.DECAY_RATE: "decay rate for cost",
    Objective.DELAY: "cost for delay",
    Objective.PEAK_TORQUE: "bound on the force for cost",
    Objective.NOISE: "noise for cost",
}


def facts_of(
    loaded: LoadedSpec,
    objectives: Sequence[Objective],
    curves: Sequence[TradeOffCurve],
    given: Given,
) -> dict[str, Any]:
    """Return all points for JSON, in SI units.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec.
    objectives : sequence of Objective
        What cost was traded for.
    curves : sequence of TradeOffCurve
        What was found.
    given : mapping
        Designs beside, by the names of their files; None where nothing is proved.
    """
    every = [point for curve in curves for point in curve.points]

    def fact(point: TradeOffPoint) -> dict[str, Any]:
        certificate = point.result.certificate
        assert certificate is not None, "a point is proved"
        force, delay = point.force, point.delay
        return {
            "allowed_above": None if point.share is None else float(point.share),
            "cost": point.cost,
            "stiffness": {name: lower_float(high) for name, high in point.stiffness.items()},
            "decay_rate": lower_float(point.rate),
            "delay": None if delay is None else float(delay),  # As it is declared
            "force": None if force is None else upper_float(force),
            "noise": point.noise,
            "dominated": is_dominated(point, every, tuple(objectives)),
            "at_bounds": dict(point.at_bounds),
            "gains": {f"{name}.{gain}": text for (name, gain), text in point.gains.items()},
            "certificate_id": certificate.id,
            "text": point.result.loaded.text,
        }

    return {
        **spec_facts(loaded),
        "objectives": [*map(str, objectives)],
        "curves": [
            {
                "objective": str(curve.objective),
                "massless": curve.massless,
                "least_cost": curve.least_cost,
                "points": [fact(point) for point in curve.points],
            }
            for curve in curves
        ],
        "given": {name: None if one is None else fact(one) for name, one in given.items()},
        "goals_not_asked": [*_unasked(every)],
        "units": {
            "stiffness": unit("N*m/rad"),
            "decay_rate": "1/s",
            "delay": "s",
            "force": unit("N*m"),
            "noise": unit("rad/(s*N*m)"),
        },
    }


def table_text(
    curves: Sequence[TradeOffCurve], given: Given, objectives: Sequence[Objective]
) -> str:
    """Return all points as a table, in SI units.

    Parameters
    ----------
    curves, given, objectives
        As for `facts_of`.
    """
    every = [point for curve in curves for point in curve.points]
    rows: list[tuple[str, TradeOffPoint]] = [
        (f"{curve.objective}{', Mt = 0' if curve.massless else ''}", point)
        for curve in curves
        for point in curve.points
    ]
    rows += [(name, one) for name, one in given.items() if one is not None]
    gains = [*dict.fromkeys(key for _, point in rows for key in point.gains)]
    written = io.StringIO()
    out = csv.writer(written, lineterminator="\n")
    # As `nrs_design.output.PARETO` begins.
    out.writerow(
        [
            *("curve", "cost", "stiffness", "decay_rate", "delay", "force", "noise", "dominated"),
            *("certificate", *(f"{name}.{gain}" for name, gain in gains)),
        ]
    )
    for name, point in rows:
        stiffness, force = next(iter(point.stiffness.values()), None), point.force
        certificate = point.result.certificate
        out.writerow(
            [
                name,
                point.cost,
                None if stiffness is None else lower_float(stiffness),
                lower_float(point.rate),
                None if point.delay is None else float(point.delay),
                None if force is None else upper_float(force),
                point.noise,
                is_dominated(point, every, tuple(objectives)),
                None if certificate is None else certificate.id,
                *(point.gains.get(key) for key in gains),
            ]
        )
    return written.getvalue()


def show(
    loaded: LoadedSpec,
    objectives: Sequence[Objective],
    curves: Sequence[TradeOffCurve],
    given: Given,
) -> None:
    """Print a table for each curve, and what its columns mean.

    Parameters
    ----------
    loaded, objectives, curves, given
        As for `facts_of`.
    """
    every = [point for curve in curves for point in curve.points]
    shown = tuple(dict.fromkeys((*objectives, Objective.DECAY_RATE)))
    for curve in curves:
        kind = "no virtual mass" if curve.massless else "with virtual mass"
        caption = f"{loaded.spec.name}: {CAPTIONS[curve.objective]}, {kind}"
        named = [(_above(point, curve), point) for point in curve.points]
        _print(caption, "above\nleast", named, every, shown)
        if not named:
            say("nothing was proved at these costs")
    beside = [(name, one) for name, one in given.items() if one is not None]
    if beside:
        _print("given designs, as they declare their ranges", "design", beside, every, shown)
    for name, one in given.items():
        if one is None:
            say(f"{name}: nothing was proved of it")
    say("Proved for all stiffness up to k, and all else that the spec declares.")
    say("Cost: that of optimize at nominal values, of all controllers, in floating point.")
    if Objective.NOISE in shown:
        say("Noise: velocity by white noise in the force that the admittance takes, the largest of")
        say("the controllers, as standard deviations; in floating point.")
    for name, bound in dict.fromkeys(one for point in every for one in point.at_bounds):
        say(f"{name} is on its {bound} bound in some points: the cost has neither noise of the")
        say("sensor nor effort of the motor; look at both before you take one.")
    for goal in _unasked(every):
        say(f"The goal {goal} is not asked for here, and a point misses it.")


def _above(point: TradeOffPoint, curve: TradeOffCurve) -> str:
    if point.share is None:
        return FREE
    return f"{100 * (point.cost / curve.least_cost - 1):.1f} %"


def _unasked(points: Sequence[TradeOffPoint]) -> Iterator[str]:
    from nrs_design.pipeline.trade_off import unasked_goals

    return unasked_goals(points)


def _print(
    caption: str,
    heading: str,
    named: Sequence[tuple[str, TradeOffPoint]],
    every: Sequence[TradeOffPoint],
    shown: Sequence[Objective],
) -> None:
    """Print a table of points."""
    # A curve may have none, and all others have the same contacts.
    points = [*every, *(point for _, point in named)]
    contacts = [*points[0].stiffness] if points and Objective.STIFFNESS in shown else []
    bounded = any(point.force is not None for point in points)
    forces = bounded or Objective.PEAK_TORQUE in shown
    gains = [*dict.fromkeys(key for _, point in named for key in point.gains)]
    columns = [
        "cost",
        heading,
        *(f"{name}: k up to\n{unit('N m/rad')}" for name in contacts),
        "decay\n1/s",
        *(["delay\nms"] if Objective.DELAY in shown else []),
        *([f"force\n{unit('N m')}"] if forces else []),
        *([f"noise\n{unit('rad/(s N m)')}"] if Objective.NOISE in shown else []),
        *(f"{name}\n{gain}" for name, gain in gains),
    ]

    def row(name: str, point: TradeOffPoint) -> list[str]:
        delay, force, noise = point.delay, point.force, point.noise
        stiffness = point.stiffness
        return [
            f"{point.cost:.4f}",
            name,
            *(lower(stiffness[key], 4) if key in stiffness else NONE for key in contacts),
            lower(point.rate, 3),
            *([_number(delay, 1000)] if Objective.DELAY in shown else []),
            *([NONE if force is None else upper(force, 3)] if forces else []),
            *([NONE if noise is None else f"{noise:.3g}"] if Objective.NOISE in shown else []),
            *(point.gains[key].split()[0] if key in point.gains else NONE for key in gains),
        ]

    print_table(caption, columns, [row(*one) for one in named])


def _number(value: Fraction | None, factor: int) -> str:
    return NONE if value is None else lower(value * factor, 4)
