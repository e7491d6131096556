"""Shared options of the robot commands, and their parsers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.tables import print_table
from nrs_design.robot.models.geometry import PoseError

if TYPE_CHECKING:
    from nrs_design.robot.models.robot import Robot


Pose = Annotated[
    str | None,
    typer.Option("--pose", metavar="PHI,PSI,D", help="Pose in rad, rad and m, as in 0,0,0.2."),
]
Velocity = Annotated[
    str | None, typer.Option("--velocity", metavar="W1,W2,W3", help="Joint velocities in rad/s.")
]
Acceleration = Annotated[
    str | None,
    typer.Option("--acceleration", metavar="A1,A2,A3", help="Joint accelerations in rad/s^2."),
]
Tilt = Annotated[
    float | None,
    typer.Option("--tilt", metavar="DEG", help="Tilt of the base in degrees, not the spec's."),
]

Three = tuple[float, float, float]

# A depth beyond this multiple of the workspace is taken for another unit.
DOUBTFUL = 10


def three_numbers(text: str, option: str) -> Three:
    """Read ``1,2,3``."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise typer.BadParameter(
            f"{text!r} is not three numbers with commas between them, such as 0,0,0.2",
            param_hint=option,
        )
    return numbers[0], numbers[1], numbers[2]


def read_pose(text: str, robot: Robot) -> Three:
    """Read a pose, and doubt one that is in other units than rad and m."""
    phi, psi, d = three_numbers(text, "--pose")
    for name, angle in (("phi", phi), ("psi", psi)):
        if abs(angle) > math.pi / 2:
            raise PoseError(
                f"--pose: {name} = {angle:g} rad is beyond a right angle",
                remedy=f"angles are in rad: {angle:g} deg are {math.radians(angle):.6g}",
            )
    deepest = robot.workspace.d[1]
    if abs(d) > DOUBTFUL * deepest:
        raise PoseError(
            f"--pose: d = {d:g} m is far beyond the workspace, which ends at {deepest:g} m",
            remedy=f"depths are in m: {d:g} mm are {d / 1e3:g}",
        )
    return phi, psi, d


def print_quantities(content: Mapping[str, Any], labels: Mapping[str, str]) -> None:
    """Print the numbers, rows of three and matrices that have a label, all in SI units."""
    rows = [
        [title, *(f"{number:.8g}" for number in numbers), *[""] * (3 - len(numbers))]
        for name, label in labels.items()
        if name in content
        for title, numbers in _rows(label, content[name])
    ]
    print_table("", ["SI units", "1", "2", "3"], rows)


def _rows(label: str, value: Any) -> Iterator[tuple[str, Sequence[float]]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _rows(f"{label}: {key}", inner)
    elif isinstance(value, list) and isinstance(value[0], list):
        yield from ((f"{label}, row {i}", row) for i, row in enumerate(value, 1))
    else:
        yield label, value if isinstance(value, list) else [value]


def lists(result: object, *names: str) -> dict[str, Any]:
    """Return the arrays of a result by name, as JSON has them."""
    return {name: getattr(result, name).tolist() for name in names}
