"""``nrs-design optimize``: virtual mass and damping of every impedance controller."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.axis import unit
from nrs_design.cli.command import Answer, command
from nrs_design.cli.exit_codes import INCONCLUSIVE, worst
from nrs_design.cli.goals import (
    design_answer,
    goals_summary,
    print_responses,
    responses_summary,
)
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import detail, note, progress, say, wants_details
from nrs_design.cli.reading import take_spec
from nrs_design.cli.tables import print_table
from nrs_design.proof.bounds import lower_float, upper_float

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis, ImpedanceAnalysis
    from nrs_design.design.cost_bound import CostBound
    from nrs_design.design.measures import Measure
    from nrs_design.design.sampled_passivity import SampledBand
    from nrs_design.pipeline import Designed
    from nrs_design.spec import InteractionDesignSpec


@command("optimize", each_axis=True)
def optimize(
    spec: SpecFile,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="NEW.nrs.yaml",
            help="Write the spec with these gains given, named after the file, and its "
            "certificate to reports/NAME.cert.json; for goals decay_rate, peak_torque and delay, "
            "and for --retune.",
        ),
    ] = None,
    global_optimum: Annotated[
        bool,
        typer.Option(
            "--global-optimum",
            help="Prove how far the cost is above the least one within the bounds of Mt and Bt; "
            "takes a second or two for a controller.",
        ),
    ] = False,
    retune: Annotated[
        bool,
        typer.Option(
            "--retune",
            help="Prove within how many per cent of these gains all Bt may be retuned while the "
            "robot runs; --out writes the spec with these ranges.",
        ),
    ] = False,
) -> Answer:
    """Optimize virtual mass Mt and damping Bt for displayed impedance and sensitivity.

    Goals of the spec are respected. With decay_rate, peak_torque or delay among them, the gains of
    all controllers are chosen together, and those that design.free names, and come with their
    proof. The exit code is 1 if gains that are given miss a goal, or if one is not proved; 3 if
    --retune proves nothing.

    Example: nrs-design optimize specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.cli.certified_gains import CertifiedGains
    from nrs_design.cli.retuned_gains import RetunedBox
    from nrs_design.pipeline import run_analysis, run_interaction
    from nrs_design.pipeline.cost_bounds import run_cost_bounds

    loaded = take_spec(spec)
    with progress(f"designing {loaded.spec.name}") as step:
        step("cost")
        designed = run_interaction(loaded, "has nothing to design")
        step("margins")
        chosen = analysis = run_analysis(designed)
    certified = CertifiedGains.of(designed, analysis, None if retune else out)
    if certified is not None:
        designed, analysis = certified.designed, certified.analysis

    bounds = run_cost_bounds(chosen, analysis) if global_optimum else {}
    box = RetunedBox.of(designed, out) if retune else None

    def facts() -> dict[str, Any]:
        return {
            "motion_loop": motion_summary(analysis),
            "sensor": _sensor(designed),
            "controllers": [
                _summary(designed.spec, item) | _optimum_facts(bounds.get(item.name))
                for item in analysis.impedance
            ],
            "certified": None if certified is None else certified.facts(),
            "retuned": None if box is None else box.facts(),
        }

    def show() -> None:
        if not analysis.impedance:
            note("no impedance controllers in this spec; see nrs-design tune for the others")
        _print(designed.spec, analysis)
        _print_bounds(bounds)
        print_responses(analysis)
        if certified is not None:
            certified.show()
        if box is not None:
            box.show()

    proved = all(found.proved for item in analysis.impedance for found in item.responses)
    proved = proved and (certified is None or certified.proved)
    answer = design_answer(
        designed,
        analysis,
        analysis.impedance,
        facts,
        show,
        proved=proved,
        judged=certified is not None,
        marked=True,
    )
    # What --retune asks for was not proved, which refutes nothing.
    open_ = box is not None and box.found.result is None
    return replace(answer, code=worst({answer.code, INCONCLUSIVE})) if open_ else answer


def _optimum_facts(bound: CostBound | str | None) -> dict[str, Any]:
    """Return the bounds on the least cost, rounded to their safe sides; nothing if not asked."""
    if bound is None:
        return {}
    if isinstance(bound, str):
        return {"global_optimum": None, "global_optimum_not_computed": bound}
    return {
        "global_optimum": {
            "cost_at_most": upper_float(bound.above),
            "least_cost_at_least": lower_float(bound.below),
            "gap": upper_float(bound.gap),
            "boxes": bound.boxes,
            "reached": bound.reached,
            "without_goals": bound.goals,
        }
    }


def _print_bounds(bounds: dict[str, CostBound | str]) -> None:
    from nrs_design.design.measures import OPTIMUM_MEANING

    for name, bound in bounds.items():
        say(f"{name}: {f'no bound on the cost: {bound}' if isinstance(bound, str) else bound.text}")
    if any(not isinstance(bound, str) for bound in bounds.values()):
        say(OPTIMUM_MEANING)


def motion_summary(analysis: DesignAnalysis) -> dict[str, Any]:
    """Describe which motion loop G is in use."""
    return {
        "source": analysis.motion_source,
        "numerator": list(analysis.motion.numerator),
        "denominator": list(analysis.motion.denominator),
    }


def meanings(spec: InteractionDesignSpec, items: Sequence[ImpedanceAnalysis]) -> Iterator[str]:
    """Yield what the values of the table are about."""
    from nrs_design.design.measures import (
        COST_MEANING,
        LIMIT_MEANING,
        MEANING,
        ONE_AXIS,
        WEIGHED_MEANING,
        computed,
    )

    yield MEANING[0]
    yield LIMIT_MEANING
    if spec.coupling is not None:
        yield ONE_AXIS
    yield from computed({item.name: item.proved_titles for item in items})
    yield COST_MEANING
    weights = (getattr(controller, "weights", None) for controller in spec.controllers.values())
    if any(given is not None and (given.transparency or given.accuracy) for given in weights):
        yield WEIGHED_MEANING


def _summary(spec: InteractionDesignSpec, item: ImpedanceAnalysis) -> dict[str, Any]:
    from nrs_design.design import measures

    def worst(measure: Measure) -> float | None:
        return finite(item.worst(measure).value)

    band = item.band
    passive, broken = (None, None) if band is None else (band.passive, band.broken)
    return {
        "name": item.name,
        "desired_impedance": item.problem.desired,
        "environment": item.problem.loop.contact.given(),
        "stiffness": item.problem.loop.contact.stiffness,
        "Mt": item.Mt,
        "Bt": item.Bt,
        "Kt": item.problem.loop.Kt,
        "cost": item.cost,
        "given": [gain for gain in ("Mt", "Bt") if getattr(item.given, gain).fixed],
        "optimum": {"Mt": item.optimum.Mt, "Bt": item.optimum.Bt, "cost": item.optimum.cost},
        "sensitivity_peak": worst(measures.SENSITIVITY_PEAK),
        "gain_margin": worst(measures.GAIN_MARGIN),
        "phase_margin_rad": worst(measures.PHASE_MARGIN),
        "delay_margin_s": worst(measures.DELAY_MARGIN),
        "disk_margin": worst(measures.DISK_MARGIN),
        "stiffness_limit": finite(item.lowest_limit),
        "stiffness_limit_at": item.limit_at,
        "over": [*meanings(spec, [item])],
        "lever_arm_m": item.lever_arm,
        "stiffness_limit_at_arm_N_m": item.limit_at_arm and finite(item.limit_at_arm),
        "passive_up_to_rad_s": passive and lower_float(passive),
        "not_passive_at_rad_s": broken and upper_float(broken),
        "passivity_not_computed": None
        if item.sampled or spec.sampling is None
        else measures.PASSIVITY_NOT_COMPUTED,
        "sampled_passivity": [_band(band) for band in item.sampled],
        "creep": _creep(item),
        "goals": goals_summary(item),
        "responses": responses_summary(item),
        "units": {
            "Mt": unit("kg*m^2"),
            "Bt": unit("N*m*s/rad"),
            "Kt": unit("N*m/rad"),
            "impedance": unit("N*m*s/rad"),
            "stiffness": unit("N*m/rad"),
        },
    }


def _band(band: SampledBand) -> dict[str, Any]:
    """Return where a sampled law is passive, and the exact witness that it is not beyond."""
    between = band.broken and [lower_float(band.broken[0]), upper_float(band.broken[1])]
    return {
        "delay": band.age,
        "passive_up_to_rad_s": lower_float(band.passive),
        "not_passive_between_rad_s": between,
        "not_passive_at_tangent": band.tangent and str(band.tangent),
    }


def _sensor(designed: Designed) -> dict[str, Any]:
    """Return what may last of the errors of the force signal, N m, rounded up."""
    sensor = designed.design.sensor
    return {
        "lasting_error": upper_float(sensor.lasting),
        "parts": {name: upper_float(error) for name, error in sensor.errors.items()},
        "unit": unit("N*m"),
    }


def _creep(item: ImpedanceAnalysis) -> dict[str, Any] | None:
    """Return the bounds on the creep, rounded up; None without a sensor whose errors are known."""
    if item.creep is None:
        return None
    angle, way = item.creep.angle, unit("rad")
    return {
        f"velocity_{way}_s": upper_float(item.creep.velocity),
        f"{'angle_rad' if way == 'rad' else 'way_m'}": None
        if angle is None
        else upper_float(angle),
        f"noise_rms_{way}_s": item.creep.noise,
    }


def finite(value: float) -> float | None:
    """Return a number for JSON, which has no infinity; None says unbounded."""
    return value if math.isfinite(value) else None


def _print(spec: InteractionDesignSpec, analysis: DesignAnalysis) -> None:
    source = "by root locus" if analysis.motion_source == "designed" else "given in the spec"
    G = analysis.motion
    motion = f"({_polynomial(G.numerator)}) / ({_polynomial(G.denominator)})"
    detail(f"{spec.name}: G(s) = {motion}, {source}")
    if not analysis.impedance:
        return
    from nrs_design.cli.marked import basis, cells, marks

    columns = [
        "controller",
        f"Mt\n{unit('kg m^2')}",
        f"Bt\n{unit('N m s/rad')}",
        "cost",
        "Ms",
        "gain\nmargin",
        "phase\nmargin",
        "delay\nmargin",
        "disk\nmargin",
        f"stands up to\n{unit('N m/rad')}",
    ]
    print_table(
        f"{spec.name}: the worst over all ranges", columns, [*map(cells, analysis.impedance)]
    )
    for line in marks(analysis.impedance):
        say(line)
    for line in meanings(spec, analysis.impedance):
        detail(line)
    if not wants_details():
        say(basis(analysis.impedance))


def _polynomial(coefficients: tuple[float, ...]) -> str:
    degree = len(coefficients) - 1
    powers = {0: "", 1: " s"}
    terms = [
        f"{c:.5g}{powers.get(degree - i, f' s^{degree - i}')}" for i, c in enumerate(coefficients)
    ]
    return " + ".join(terms)
