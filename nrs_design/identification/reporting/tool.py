"""The page of an identified tool."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.identification.reporting.figures.tool import draw_errors
from nrs_design.identification.reporting.identification import identification_page, label_of
from nrs_design.reporting.document import Bullets, Illustration, Report, Section, Table
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
    sources = [record.source for record in found.records]
    note = label_of(found.synthetic)
    rows = tuple(
        (axis, *map(str, estimates))
        for axis, *estimates in zip(
            "xyz", found.center, found.force_bias, found.torque_bias, strict=True
        )
    )
    columns = ("Along", "Center of mass [m]", "Bias of the force [N]", "Bias of the torque [N·m]")
    force, torque = found.rmse
    return identification_page(
        name="tool",
        title=f"Tool on the force sensor, from {plural(len(found.force_errors), 'pose')}",
        claim=f"Mass {found.mass} kg; center of mass "
        f"{', '.join(number(e.value, 4) for e in found.center)} m from the origin of the sensor.",
        remarks=tuple(f"Doubt: {doubt}." for doubt in found.doubts),
        sources=sources,
        sections=(
            Section("Tool and bias", (Table("Estimates [95 % interval]", columns, rows),)),
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
            Section("How to read this", (Bullets("", _MEANING),), boxed=True),
        ),
    )
