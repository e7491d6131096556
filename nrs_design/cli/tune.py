"""``nrs-design tune``: motion PD by root locus, and the P of the force loop."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from nrs_design.axis import current, unit
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.goals import design_answer
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import progress, say
from nrs_design.cli.tables import print_table
from nrs_design.facts.design import goals_summary, motion_summary
from nrs_design.proof.bounds import lower_float

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.design.analysis import DesignAnalysis, ForceAnalysis

TORQUE_TEXT = (
    "Passive whatever is touched: b > K T/2 + B with the least friction b of the spec, exact for "
    "commands at once (Colgate and Schenkel 1997). The border in the air is that of the nominal "
    "joint, in floating point. Neither is the proof."
)
_NOMINAL = (
    "Poles, damping and steady error in this table are those of the loop at nominal values in "
    "continuous time. Goals and warnings are about the loop that certify-switching is about, at "
    "the worst corner of the ranges."
)
_NO_OFFSET = (
    "{}: the steady-state error is that of a commanded position where contact begins. A simulated "
    "run keeps the position that was commanded at the switch, and leaves another error."
)
OFFSETS = {"reference": "reference of the motion loop", "measured": "measured position"}


@command("tune", each_axis=True)
def tune(spec: SpecFile) -> Answer:
    """Tune the motion PD by root locus and the force gain, and print the poles that result.

    The exit code is 1 if a force controller misses a goal of the spec.

    Example: nrs-design tune specs/neuroboscope/force-limit.nrs.yaml
    """
    from nrs_design.errors import DesignError
    from nrs_design.pipeline.analysis import run_analysis
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
        analysis = run_analysis(designed)
    return design_answer(
        designed,
        analysis,
        analysis.tuned,
        lambda: _summary(designed.design, analysis),
        lambda: _print(loaded.spec.name, designed.design, analysis),
    )


def _summary(design: ControllerDesign, analysis: DesignAnalysis) -> dict[str, Any]:
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
                "stable_below_in_the_air": item.border,
                "passivity_margin": None if item.margin is None else lower_float(item.margin),
                "units": {
                    "Kp": unit("N*m/rad"),
                    "B": unit("N*m*s/rad"),
                    "stable_below_in_the_air": unit("N*m/rad"),
                    "passivity_margin": unit("N*m*s/rad"),
                },
            }
            for item in analysis.torque
        ],
    }


def _motion_summary(design: ControllerDesign, analysis: DesignAnalysis) -> dict[str, Any] | None:
    wanted, reached = analysis.wanted, analysis.reached
    if wanted is None:
        return None
    return {
        "wanted_poles": _pairs(wanted.wanted_poles),
        "root_locus": {"derivative_gain": wanted.derivative_gain, "zero": wanted.zero},
        "Kp": float(design.motion.Kp),
        "Kd": float(design.motion.Kd),
        "loop": motion_summary(analysis),
        "poles": _pairs(reached.poles),
        "damping_ratio": reached.damping_ratio,
        "natural_frequency": reached.natural_frequency,
        "overshoot_percent": 100 * reached.overshoot,
        "units": {**design.units["motion"], "poles": "1/s", "zero": "1/s"},
    }


def _print(name: str, design: ControllerDesign, analysis: DesignAnalysis) -> None:
    if analysis.torque:
        _print_torque(name, analysis)
        return
    _print_motion(name, design, analysis)
    if analysis.motion_source == "given":
        say("The spec states G itself: the poles are those of that G, not of the PD gains.")
    if analysis.force:
        _print_force(name, analysis)
        say(_NOMINAL)
        for item in analysis.force:
            if item.peak is not None:
                say(_offset_text(item))
            elif item.approach.offset == "none":
                say(_NO_OFFSET.format(item.name))


def _print_motion(name: str, design: ControllerDesign, analysis: DesignAnalysis) -> None:
    wanted, reached, per = analysis.wanted, analysis.reached, unit("rad")
    assert wanted is not None, "there is a motion loop"
    columns = (
        "motion PD",
        f"Kd\n{design.command} s/{per}",
        "zero\n1/s",
        f"Kp\n{design.command}/{per}",
        "poles\n1/s",
        "damping\nratio",
        "overshoot",
    )
    rows = [
        [
            "root locus",
            f"{wanted.derivative_gain:.6g}",
            f"{wanted.zero:.6g}",
            "",
            _poles(wanted.wanted_poles),
            "",
            "",
        ],
        [
            "shipped",
            f"{float(design.motion.Kd):.8g}",
            f"{float(design.motion.zero):.6g}",
            f"{float(design.motion.Kp):.8g}",
            _poles(reached.poles),
            f"{reached.damping_ratio:.4f}",
            f"{100 * reached.overshoot:.2f} %",
        ],
    ]
    print_table(f"{name}: motion loop", columns, rows)


def _offset_text(item: ForceAnalysis) -> str:
    velocity, force = current().fine * item.approach.velocity, item.approach.force
    gain = item.approach.integral
    integral = f"Ki = {gain:.6g} {unit('rad/(N m s)')}, " if gain else ""
    return (
        f"{item.name}: {integral}X_i is the {OFFSETS[item.approach.offset]} at the switch. "
        f"Arriving at {velocity:.4g} {unit('deg/s')}, the torque peaks at {item.peak:.3f} "
        f"{unit('N m')} and settles {100 * item.steady_error:.2f} % off {force:.4g} "
        f"{unit('N m')}, for a switch exactly there."
    )


def _print_force(name: str, analysis: DesignAnalysis) -> None:
    columns = (
        "controller",
        f"k\n{unit('N m/rad')}",
        f"Kp\n{unit('rad/(N m)')}",
        "poles\n1/s",
        "damping\nratio",
        "natural\nfrequency",
        "steady-state\nerror ratio",
    )
    rows = [
        [
            item.name,
            f"{item.stiffness:.6g}",
            f"{item.loop.gain:.6g}",
            _poles(item.loop.poles),
            f"{item.loop.damping_ratio:.4f}",
            f"{item.loop.natural_frequency:.2f} rad/s",
            f"{item.steady_error:.3f}",
        ]
        for item in analysis.force
    ]
    print_table(f"{name}: force loop, nominal", columns, rows)


def _print_torque(name: str, analysis: DesignAnalysis) -> None:
    columns = (
        "controller",
        f"K\n{unit('N m/rad')}",
        f"B\n{unit('N m s/rad')}",
        f"stable in the air\nbelow, {unit('N m/rad')}",
        f"passive, margin\n{unit('N m s/rad')}",
    )
    rows = [
        [item.name, f"{item.Kp:.6g}", f"{item.B:.6g}", f"{item.border:.6g}", item.passive_text]
        for item in analysis.torque
    ]
    print_table(f"{name}: impedance by torques", columns, rows)
    say(TORQUE_TEXT)


def _pairs(poles: tuple[complex, ...]) -> list[list[float]]:
    return [[pole.real, pole.imag] for pole in poles]


def _poles(poles: tuple[complex, ...]) -> str:
    upper = [pole for pole in poles if pole.imag >= 0]
    return ", ".join(
        f"{pole.real:.4f}" if math.isclose(pole.imag, 0) else f"{pole.real:.4f} +- {pole.imag:.4f}j"
        for pole in upper
    )
