"""``nrs-design robot track``: motion control, simulated against the full dynamics."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.cli.tables import print_table
from nrs_design.progress import Progress
from nrs_design.robot.cli.options import Tilt

if TYPE_CHECKING:
    from nrs_design.robot.models.robot import Robot
    from nrs_design.robot.simulation.experiment import TrackingRecord
    from nrs_design.spec import RobotSpec

ALL = "all"


class ControllerOption(StrEnum):
    """Which of the three controllers."""

    COMPUTED_TORQUE = "computed-torque"
    INDEPENDENT_JOINT = "independent-joint"
    BALANCED = "balanced"
    ALL = ALL


class ExperimentOption(StrEnum):
    """Which coordinate moves."""

    D = "d"
    PHI = "phi"
    PSI = "psi"
    ALL = ALL


@command("robot-track")
def track(
    spec: SpecFile,
    controller: Annotated[
        ControllerOption, typer.Option("--controller", help="One controller, or all three.")
    ] = ControllerOption.ALL,
    experiment: Annotated[
        ExperimentOption, typer.Option("--experiment", help="What moves, or all three in turn.")
    ] = ExperimentOption.ALL,
    period: Annotated[
        float | None,
        typer.Option(
            "--period",
            metavar="S",
            min=0.5,
            max=1000.0,
            help="Period of every sine, not the thesis's 10 s or 110 s.",
        ),
    ] = None,
    tilt: Tilt = None,
    figures: Annotated[
        Path | None,
        typer.Option("--figures", metavar="DIR", help="Draw into this folder, as SVG and PNG."),
    ] = None,
) -> Answer:
    """Simulate the motion controllers of thesis 4.2 to 4.4 and compare their tracking errors.

    These laws follow a pose, in double precision and without tissue.

    Example: nrs-design robot track specs/robots/neuroboscope.nrs.yaml --figures figures
    """
    from nrs_design.robot.pipeline import run_robot
    from nrs_design.robot.simulation.simulate import LEFT_OUT
    from nrs_design.robot.simulation.track import experiment_tilt

    loaded, robot_spec, robot = run_robot(spec)
    robot = robot.tilted(experiment_tilt(robot_spec) if tilt is None else math.radians(tilt))
    moved = None if experiment is ExperimentOption.ALL else experiment.value
    with progress("simulating") as tell:
        records = _records(robot_spec, robot, controller, moved, period, tell)
    runs = [_run(robot_spec, robot, record) for record in records]
    files: list[str] = []
    if figures is not None:
        from nrs_design.output import PNG, SVG, Output, write_outputs
        from nrs_design.reporting.images import to_png, to_svg_file
        from nrs_design.robot.reporting.figures import draw_tracking

        drawn = draw_tracking(records, [run["measured_on_robot"] for run in runs])
        outputs: list[Output] = [
            (figures / "tracking.svg", to_svg_file(drawn), SVG),
            (figures / "tracking.png", to_png(drawn), PNG),
        ]
        write_outputs(outputs)
        note(f"figures written to {figures}")
        files = [str(path) for path, _, _ in outputs]

    def show() -> None:
        _print_runs(runs)
        say("not modelled:")
        for line in LEFT_OUT:
            say(f"  - {line}")

    facts = loaded.facts
    return Answer(lambda: facts | _document(robot, runs) | {"files": files}, show)


def _records(
    spec: RobotSpec,
    robot: Robot,
    controller: ControllerOption,
    moved: str | None,
    period: float | None,
    tell: Progress,
) -> list[TrackingRecord]:
    from nrs_design.robot.simulation.simulate import simulate
    from nrs_design.robot.simulation.track import CONTROLLERS, build_track

    names: tuple[str, ...] = (controller.value,)
    if controller is ControllerOption.ALL:
        names = tuple(name for name in CONTROLLERS if spec.balance or name != "balanced")
    tracks = [build_track(spec, robot, name, period).only(moved) for name in names]
    return simulate(tracks, tell=tell)


def _run(spec: RobotSpec, robot: Robot, record: TrackingRecord) -> dict[str, Any]:
    from nrs_design.robot.simulation.track import measured_rmse

    measured = measured_rmse(spec, robot, record.controller, record.experiment)
    return record.summary() | {"measured_on_robot": measured}


def _document(robot: Robot, runs: list[dict[str, Any]]) -> dict[str, Any]:
    from nrs_design.robot.simulation.simulate import LEFT_OUT

    return {
        "base_tilt": robot.base_tilt,
        "runs": runs,
        "not_modelled": list(LEFT_OUT),
        "units": {"rmse": "deg, deg, mm", "command": "rpm", "time": "s", "base_tilt": "rad"},
    }


def _print_runs(runs: list[dict[str, Any]]) -> None:
    measured = any(run["measured_on_robot"] for run in runs)
    columns = ["controller", "moves", "period [s]", "phi [deg]", "psi [deg]", "d [mm]"]
    columns += ["largest command [rpm]"]
    if measured:
        columns += ["on the robot: phi [deg]", "psi [deg]", "d [mm]"]
    rows = [
        [
            run["controller"],
            run["moved"],
            f"{run['period']:.4g}",
            *(f"{error:.4f}" for error in run["rmse"]),
            f"{max(run['largest_command']):.0f}",
            *(f"{error:.4f}" for error in run["measured_on_robot"] or ()),
        ]
        for run in runs
    ]
    print_table("root mean square of wanted less measured, simulated", columns, rows)
