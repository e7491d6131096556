"""``nrs-design optimize``: virtual mass and damping of every impedance controller."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.axis import unit
from nrs_design.cli.command import Answer, command
from nrs_design.cli.goals import (
    design_answer,
    goals_summary,
    print_responses,
    responses_summary,
)
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.cli.reading import take_spec
from nrs_design.cli.tables import print_table
from nrs_design.proof.bounds import lower, lower_float, upper_float

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis, ImpedanceAnalysis
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
            "certificate to reports/NAME.cert.json; for goals decay_rate, peak_torque and delay.",
        ),
    ] = None,
) -> Answer:
    """Optimize virtual mass Mt and damping Bt for displayed impedance and sensitivity.

    Goals of the spec are respected. With decay_rate, peak_torque or delay among them, the gains of
    all controllers are chosen together, and those that design.free names, and come with their
    proof. The exit code is 1 if gains that are given miss a goal, or if one is not proved.

    Example: nrs-design optimize specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.cli.certified_gains import CertifiedGains
    from nrs_design.pipeline import run_analysis, run_interaction

    loaded = take_spec(spec)
    with progress(f"designing {loaded.spec.name}") as step:
        step("cost")
        designed = run_interaction(loaded, "has nothing to design")
        step("margins")
        analysis = run_analysis(designed)
    certified = CertifiedGains.of(designed, analysis, out)
    if certified is not None:
        designed, analysis = certified.designed, certified.analysis

    def facts() -> dict[str, Any]:
        return {
            "motion_loop": motion_summary(analysis),
            "sensor": _sensor(designed),
            "controllers": [_summary(designed.spec, item) for item in analysis.impedance],
            "certified": None if certified is None else certified.facts(),
        }

    def show() -> None:
        if not analysis.impedance:
            note("no impedance controllers in this spec; see nrs-design tune for the others")
        _print(designed.spec, analysis)
        print_responses(analysis)
        if certified is not None:
            certified.show()

    proved = all(found.proved for item in analysis.impedance for found in item.responses)
    proved = proved and (certified is None or certified.proved)
    return design_answer(
        designed,
        analysis,
        analysis.impedance,
        facts,
        show,
        proved=proved,
        judged=certified is not None,
    )


def motion_summary(analysis: DesignAnalysis) -> dict[str, Any]:
    """Describe which motion loop G is in use."""
    return {
        "source": analysis.motion_source,
        "numerator": list(analysis.motion.numerator),
        "denominator": list(analysis.motion.denominator),
    }


def meanings(spec: InteractionDesignSpec) -> Iterator[str]:
    """Yield what the values of the table are about."""
    from nrs_design.design.measures import (
        COST_MEANING,
        LIMIT_MEANING,
        MEANING,
        ONE_AXIS,
        WEIGHED_MEANING,
    )

    yield MEANING[0]
    yield LIMIT_MEANING
    if spec.coupling is not None:
        yield ONE_AXIS
    yield MEANING[-1]
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
        "over": [*meanings(spec)],
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
    G = analysis.motion
    from nrs_design.design.measures import MARGINS

    source = (
        "designed by root locus" if analysis.motion_source == "designed" else "given in the spec"
    )
    motion = f"({_polynomial(G.numerator)}) / ({_polynomial(G.denominator)})"
    say(f"{spec.name}: G(s) = {motion}, {source}")
    columns = [
        "controller",
        f"Zdes\n{unit('N m s/rad')}",
        f"k\n{unit('N m/rad')}",
        f"Mt\n{unit('kg m^2')}",
        f"Bt\n{unit('N m s/rad')}",
        "cost",
        "Ms",
        "gain\nmargin",
        "phase\nmargin",
        "delay\nmargin",
        "disk\nmargin",
        f"k limit\n{unit('N m/rad')}",
    ]
    rows = [
        [
            item.name,
            f"{item.problem.desired:.5g}",
            f"{item.problem.loop.contact.stiffness:.6g}",
            f"{item.Mt:.6g}",
            f"{item.Bt:.6g}",
            f"{item.cost:.4f}",
            *(measure.text(item.worst(measure).value) for measure in MARGINS),
            _limit(item.lowest_limit),
        ]
        for item in analysis.impedance
    ]
    if rows:
        print_table("margins and k limit: the worst over the ranges", columns, rows)
        for line in meanings(spec):
            say(line)
    limits = [
        f"{item.name} {_limit(item.limit_at_arm)} N/m at {item.lever_arm:g} m"
        for item in analysis.impedance
        if item.limit_at_arm is not None and math.isfinite(item.limit_at_arm)
    ]
    if limits:
        say(f"k limit where it is touched: {', '.join(limits)}")


def _limit(value: float) -> str:
    """Write a limit of stiffness, rounded down."""
    if math.isnan(value):
        return "not computed"
    return "unlimited" if math.isinf(value) else lower(Fraction(value), 4)


def _polynomial(coefficients: tuple[float, ...]) -> str:
    degree = len(coefficients) - 1
    powers = {0: "", 1: " s"}
    terms = [
        f"{c:.5g}{powers.get(degree - i, f' s^{degree - i}')}" for i, c in enumerate(coefficients)
    ]
    return " + ".join(terms)
