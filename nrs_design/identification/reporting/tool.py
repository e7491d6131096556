"""The page of an identified tool."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.identification.reporting.figures.tool import draw_errors
from nrs_design.identification.reporting.identification import (
    identification_page,
    in_interval,
    label_of,
)
from nrs_design.reporting.document import Illustration, Report, Section, Table
from nrs_design.reporting.formatting import number, plural

if TYPE_CHECKING:
    from nrs_design.identification.tool import ToolIdentification

_MEANING = (
    "A pose gives F = m g + F0 and T = c x m g + T0 along the axes of the sensor: a linear fit, "
    "with 95 % intervals for errors that are independent of each other.",
    "The orientations are taken for exact. An error of theirs that is the same in all poses, as of "
    "a sensor that is mounted askew, may hide in center of mass and bias.",
    "The robot takes the weight and the bias off; what intervals leave of them makes it creep.",
)


def tool_report(found: ToolIdentification) -> Report:
    """Say and draw everything about the identification of a tool."""
    note = label_of(found.sources)
    force, torque = found.rmse
    return identification_page(
        found,
        name="tool",
        title=f"Tool on the force sensor, from {plural(len(found.force_errors), 'pose')}",
        claim=f"Mass {found.mass} kg; center of mass "
        f"{', '.join(number(e.value, 4) for e in found.center)} m from the origin of the sensor.",
        sections=(
            Section("Tool and bias", (estimates(found),)),
            Section(
                "Measured less fitted",
                (
                    Illustration(
                        "errors",
                        "Errors in each pose",
                        f"{note}Root mean square: {number(force, 3)} N and {number(torque, 3)} N·m."
                        " A pose that stands out was touched, or moved.",
                        draw_errors(found),
                    ),
                ),
            ),
        ),
        meaning=_MEANING,
    )


def estimates(found: ToolIdentification) -> Table:
    """Return center of mass and bias along each axis."""
    along = zip("xyz", found.center, found.force_bias, found.torque_bias, strict=True)
    rows = tuple((axis, *map(in_interval, values)) for axis, *values in along)
    columns = ("Along", "Center of mass [m]", "Bias of the force [N]", "Bias of the torque [N·m]")
    return Table("Estimates [95 % interval]", columns, rows)
