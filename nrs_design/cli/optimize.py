"""``nrs-design optimize``: virtual mass and damping of every impedance controller."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.goals import design_answer, print_granted
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import detail, note, progress, say, wants_details
from nrs_design.cli.tables import print_table
from nrs_design.models.axis import unit
from nrs_design.proof.bounds import lower, lower_float

if TYPE_CHECKING:
    from nrs_design.api.optimum import Optimum
    from nrs_design.certificates.goals import CertifiedGoal
    from nrs_design.design.analysis import ImpedanceAnalysis
    from nrs_design.pipeline.certified_optimum import CertifiedOptimum
    from nrs_design.pipeline.design import Designed


@command("optimize", each_axis=True)
def optimize(spec: SpecFile) -> Answer:
    """Optimize virtual mass Mt and damping Bt for displayed impedance and sensitivity.

    Goals of the spec are respected. With decay_rate, peak_torque or delay among them, the gains of
    all controllers are chosen together, and those that design.free names, and come with their
    proof; every command takes these gains, and `gate` writes their certificate. The exit code is 1
    if gains that are given miss a goal, or if one of a proof is not proved, and 3 if one is not
    judged.

    Example: nrs-design optimize specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.api.optimum import Optimum
    from nrs_design.controllers.gains import steering_goals
    from nrs_design.pipeline.design import design_at_least_cost, interaction_of

    loaded = take_spec(spec)
    with progress(f"designing {loaded.spec.name}") as step:
        step("cost")
        interaction_of(loaded, "has nothing to design")
        designed = design_at_least_cost(loaded)
        assert designed is not None, "an interaction design"
        optimum, found = Optimum(designed), None
        goals: list[CertifiedGoal] = []
        step("margins")
        if steering_goals(designed.spec):
            from nrs_design.certificates.goals import certified_goals
            from nrs_design.pipeline.certified_optimum import run_certified_optimum

            step("gains with their proof")
            found = run_certified_optimum(designed, optimum.analysis, step)
            assert found.result.designed is not None, "as it was designed before"
            optimum = Optimum(found.result.designed)
            goals = [*certified_goals(optimum.designed.spec, found.result.certificate)]

    def facts() -> dict[str, Any]:
        return optimum.to_dict() | {"certified": found and _certified_facts(found, goals)}

    def show() -> None:
        _print(optimum)
        if found is not None:
            for goal in goals:
                say(goal.line)
            _print_certified(optimum, found)
            _print_freed(designed, optimum, found)

    proved = all(goal.met for goal in goals)
    items = optimum.analysis.impedance
    return design_answer(optimum, items, facts, show, proved=proved, prints_goals=found is not None)


def _certified_facts(certified: CertifiedOptimum, goals: Sequence[CertifiedGoal]) -> dict[str, Any]:
    """Return the proved facts of gains that a proof has chosen, in SI units."""
    from nrs_design.certificates.goals import decay_rate

    rate = decay_rate(certified.result.certificate)
    return {
        "gains": {f"{name}.{gain}": text for (name, gain), text in certified.gains.items()},
        "cost": certified.cost,
        "free_cost": certified.free_cost,
        "free_decay_rate": certified.free_rate,
        "goals": [
            {"goal": goal.key, "wanted": goal.wanted, "shown": goal.said, "met": goal.met}
            for goal in goals
        ],
        "decay_rate": None if rate is None else lower_float(rate),
        "designs_tried": certified.tried,
        "at_bounds": dict(certified.at_bounds),
        "declares_delay": _declared_ages(certified),
    }


def _declared_ages(certified: CertifiedOptimum) -> list[int] | None:
    """Return the ages of the force that were declared beyond those of the spec."""
    certificate = certified.result.certificate
    return None if certificate is None or certificate.ages is None else [*certificate.ages]


def _print_certified(optimum: Optimum, found: CertifiedOptimum) -> None:
    """Print assumptions and cost of the proof that has chosen the gains."""
    print_granted(found.result)
    if optimum.analysis.impedance:
        increase = max(found.cost - found.free_cost, 0.0)
        free = found.free_rate
        rate = "" if free is None else f", which decays with {free:.3g} 1/s (floating point)"
        say(
            f"cost {found.cost:.4f} of all controllers, {increase:.4f} above the least without "
            f"goals of a proof{rate}"
        )


def _print_freed(original: Designed, optimum: Optimum, found: CertifiedOptimum) -> None:
    """Print gains and ages that are not those of the spec."""
    units, bounds = optimum.designed.design.units, dict(found.at_bounds)
    for name, free in original.spec.design.free.items():
        for gain, _ in free.given():
            value = optimum.designed.design.laws[name].gains[gain]
            times = (
                f"{float(value / original.design.laws[name].gains[gain]):.3g} times the given one"
            )
            bound = bounds.get(f"{name} {gain}")
            statement = f"{name} {gain} = {float(value):.6g} {units[name][gain]}, {times}"
            omission = "the cost has neither noise of the sensor nor effort of the motor"
            end = f": on its {bound} bound; {omission}: look at both before you take it"
            say(statement if bound is None else statement + end)
    if (delay := _declared_ages(found)) is not None:
        say(f"proved for `sampling.delay: {delay}`, more than the spec declares")


def _print(optimum: Optimum) -> None:
    items, name = optimum.analysis.impedance, optimum.designed.spec.name
    if wants_details():
        from nrs_design.reporting.formatting import polynomial_text

        G = optimum.analysis.motion
        designed = optimum.analysis.motion_source == "designed"
        source = "by root locus" if designed else "given in the spec"
        numerator, denominator = map(polynomial_text, (G.numerator, G.denominator))
        say(f"{name}: G(s) = ({numerator}) / ({denominator}), {source}")
    if not items:
        note("no impedance controllers in this spec; see nrs-design tune for the others")
        return
    margins = [f"{kind}\nmargin" for kind in ("gain", "phase", "delay", "disk")]
    columns = ["controller", f"Mt\n{unit('kg m^2')}", f"Bt\n{unit('N m s/rad')}", "cost", "Ms"]
    columns += [*margins, f"stands up to\n{unit('N m/rad')}"]
    print_table(f"{name}: {_worst_of(items)}", columns, [*map(_cells, items)])
    for line in _marks(items):
        say(line)
    _print_basis(items)


def _cells(item: ImpedanceAnalysis) -> list[str]:
    """Return the row of a controller; `_marks` says what the marks mean."""
    from nrs_design.design.measures import MARGINS

    arm_limit, arm_text = item.limit_at_arm, ""
    if arm_limit is not None and math.isfinite(arm_limit):
        arm_text = f"\n{_limit(arm_limit)} N/m at {item.lever_arm:g} m"
    return [
        item.name,
        f"{item.Mt:.6g}{'*' * ('Mt' in item.on_bound)}",
        f"{item.Bt:.6g}{'*' * ('Bt' in item.on_bound)}",
        f"{item.cost:.4f}",
        *(f"{item.shown(measure).text}{'!' * (measure in item.unusual)}" for measure in MARGINS),
        f"{_limit(item.lowest_limit)}{arm_text}",
    ]


def _limit(value: float) -> str:
    """Write a limit of stiffness, rounded down."""
    if math.isnan(value):
        return "not computed"
    return "unlimited" if math.isinf(value) else lower(Fraction(value), 4)


def _worst_of(items: Sequence[ImpedanceAnalysis]) -> str:
    """Say over what the margins of a table are the worst."""
    from nrs_design.design.measures import MARGINS

    margins = (one for item in items for one in map(item.shown, MARGINS))
    whole = all(one.proved is not None or one.everywhere for one in margins)
    return f"the worst {'over' if whole else 'at the corners of'} all ranges"


def _print_basis(items: Sequence[ImpedanceAnalysis]) -> None:
    """Print which margins are proved for all controllers, and the basis of the others."""
    from nrs_design.api.optimum import meanings
    from nrs_design.design.measures import MARGINS

    for line in meanings(items):
        detail(line)
    proved = [m.title for m in MARGINS if all(m.title in item.proved_titles for item in items)]
    titles = "all margins" if len(proved) == len(MARGINS) else ", ".join(proved)
    if wants_details():
        return
    if proved:
        say(f"Proved over all values of the ranges: {titles}; the rest is floating point (-v).")
    else:
        say("Margins: floating point at the corners of all ranges, not a proof (-v says more).")


def _marks(items: Sequence[ImpedanceAnalysis]) -> Iterator[str]:
    """Yield what the marks mean, as far as there are any."""
    from nrs_design.design.measures import MARGINS

    if any(item.on_bound for item in items):
        yield "* on its bound: the range of the spec has chosen it, not the cost"
    if found := [m for m in MARGINS if any(m in item.unusual for item in items)]:
        usual = ", ".join(f"{measure.title} {measure.usual}" for measure in found)
        yield f"! not as usual ({usual}); a goal says what is accepted"
