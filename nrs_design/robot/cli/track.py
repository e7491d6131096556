"""``nrs-design robot track``: motion control, simulated against the full dynamics."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import progress, say
from nrs_design.cli.tables import print_table
from nrs_design.robot.cli.options import Tilt

ControllerName = Literal["computed-torque", "independent-joint", "balanced", "all"]
Coordinate = Literal["d", "phi", "psi", "all"]


@command("robot-track")
def track(
    spec: SpecFile,
    controller: Annotated[
        ControllerName, typer.Option(help="One controller, or all three.")
    ] = "all",
    experiment: Annotated[
        Coordinate, typer.Option(help="What moves, or all three in turn.")
    ] = "all",
    period: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            min=0.5,
            max=1000.0,
            help="Period of every sine, not the thesis's 10 s or 110 s.",
        ),
    ] = None,
    tilt: Tilt = None,
) -> Answer:
    """Simulate the motion controllers of thesis 4.2 to 4.4 and compare their tracking errors.

    These laws follow a pose, in double precision and without tissue.

    Example: nrs-design robot track specs/robots/neuroboscope.nrs.yaml --experiment psi
    """
    from nrs_design.robot.pipeline import run_robot
    from nrs_design.robot.simulation.simulate import LEFT_OUT, simulate
    from nrs_design.robot.simulation.track import CONTROLLERS, build_tracks, experiment_tilt

    loaded, robot_spec, robot = run_robot(spec)
    robot = robot.tilted(experiment_tilt(robot_spec) if tilt is None else math.radians(tilt))
    names: tuple[str, ...] = (controller,)
    if controller == "all":
        names = tuple(name for name in CONTROLLERS if robot_spec.balance or name != "balanced")
    tracks = [
        one
        for name in names
        for one in build_tracks(robot_spec, robot, name, period)
        if experiment in ("all", one.experiment.coordinate)
    ]
    with progress("simulating") as report:
        runs = [record.summary() for record in simulate(tracks, report)]
    content: dict[str, Any] = {
        "base_tilt": robot.base_tilt,
        "runs": runs,
        "not_modelled": list(LEFT_OUT),
        "units": {"rmse": "deg, deg, mm", "command": "rpm", "time": "s", "base_tilt": "rad"},
    }

    def show() -> None:
        _print_runs(runs)
        say("not modelled:")
        for line in LEFT_OUT:
            say(f"  - {line}")

    return Answer(lambda: loaded.facts | content, show)


def _print_runs(runs: list[dict[str, Any]]) -> None:
    columns = ["controller", "moves", "period [s]", "phi [deg]", "psi [deg]", "d [mm]"]
    rows = [
        [
            run["controller"],
            run["moved"],
            f"{run['period']:.4g}",
            *(f"{error:.4f}" for error in run["rmse"]),
            f"{max(run['largest_command']):.0f}",
        ]
        for run in runs
    ]
    print_table(
        "root mean square of wanted less measured, simulated",
        [*columns, "largest command [rpm]"],
        rows,
    )
