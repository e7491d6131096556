"""``nrs-design tune``: motion PD by root locus, and the P of the force loop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.goals import design_answer
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import progress
from nrs_design.cli.tables import print_blocks
from nrs_design.models.axis import unit
from nrs_design.proof.bounds import lower_float

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.pipeline.design import Designed


@command("tune", each_axis=True)
def tune(spec: SpecFile) -> Answer:
    """Tune the motion PD by root locus and the force gain, and print the poles that result.

    The exit code is 1 if a force controller misses a goal of the spec.

    Example: nrs-design tune specs/neuroboscope/force-limit.nrs.yaml
    """
    from nrs_design.api.optimum import Optimum
    from nrs_design.errors import DesignError
    from nrs_design.pipeline.runs import run_interaction

    loaded = take_spec(spec)
    with progress(f"tuning {loaded.spec.name}"):
        designed = run_interaction(loaded, "has nothing to tune")
        if designed.spec.followed is not None:
            raise DesignError(
                "there is no motion loop around a motor, so there is no motion gain to tune",
                path=loaded.path,
                remedy="nrs-design optimize chooses the gains of impedance controllers",
                at=(*designed.spec.drives,),
            )
        optimum = Optimum(designed)
        analysis = optimum.analysis
    return design_answer(
        optimum,
        analysis.tuned,
        lambda: _summary(designed.design, analysis),
        lambda: _print(designed, analysis),
    )


def _summary(design: ControllerDesign, analysis: DesignAnalysis) -> dict[str, Any]:
    from nrs_design.api.optimum import goals_summary

    return {
        "motion": _motion_summary(design, analysis),
        "force": [
            {
                "name": item.name,
                "stiffness": item.stiffness,
                "Kp": item.loop.gain,
                "Ki": item.approach.integral,
                "poles": _pairs(item.loop.poles),
                "damping_ratio": item.loop.damping_ratio,
                "natural_frequency": item.loop.natural_frequency,
                "offset": item.approach.offset,
                "steady_state_ratio": item.steady_error,
                "peak_torque": item.peak,
                "goals": goals_summary(item),
                "units": {
                    "Kp": unit("rad/(N*m)"),
                    "Ki": unit("rad/(N*m*s)"),
                    "stiffness": unit("N*m/rad"),
                    "poles": "1/s",
                    "peak_torque": unit("N*m"),
                },
            }
            for item in analysis.force
        ],
        "torque": [
            {
                "name": item.name,
                "Kp": item.Kp,
                "B": item.B,
                "passivity_margin": None if item.margin is None else lower_float(item.margin),
                "units": {
                    "Kp": unit("N*m/rad"),
                    "B": unit("N*m*s/rad"),
                    "passivity_margin": unit("N*m*s/rad"),
                },
            }
            for item in analysis.torque
        ],
    }


def _motion_summary(design: ControllerDesign, analysis: DesignAnalysis) -> dict[str, Any] | None:
    from nrs_design.api.optimum import motion_summary

    target, achieved = analysis.wanted, analysis.reached
    if target is None:
        return None
    return {
        "wanted_poles": _pairs(target.wanted_poles),
        "root_locus": {"derivative_gain": target.derivative_gain, "zero": target.zero},
        "Kp": float(design.motion.Kp),
        "Kd": float(design.motion.Kd),
        "loop": motion_summary(analysis),
        "poles": _pairs(achieved.poles),
        "damping_ratio": achieved.damping_ratio,
        "natural_frequency": achieved.natural_frequency,
        "overshoot_percent": 100 * achieved.overshoot,
        "units": {**design.units["motion"], "poles": "1/s", "zero": "1/s"},
    }


def _print(designed: Designed, analysis: DesignAnalysis) -> None:
    """Print the tables and sentences of the report."""
    from nrs_design.reporting.sections.design import force_blocks, motion_blocks
    from nrs_design.reporting.sections.torque import torque_blocks

    blocks = [*motion_blocks(designed, analysis)]
    if analysis.torque:
        blocks = [*torque_blocks(designed.loaded, analysis)]
    elif analysis.force:
        blocks += force_blocks(designed, analysis)
    print_blocks(designed.spec.name, blocks)


def _pairs(poles: tuple[complex, ...]) -> list[list[float]]:
    return [[pole.real, pole.imag] for pole in poles]
