"""Parallel position and force control: for which stiffness, and how much dead time it bears."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.parallel import draw_parallel
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.spec import LoadedSpec

_TEXT = (
    "In constant contact the loop is that of s D + k (Kp s + Ki) N with the motion loop N/D. For "
    "which stiffness it is unstable is decided exactly, by Routh's criterion; ends are rounded "
    "away from what is unstable. Dead time is drawn in floating point. Neither is part of the "
    "proof, which is for stiffness that changes."
)
_CAPTION = (
    "Stable below a border, for that dead time of the force signal. Stiffness and gains count by "
    "their products alone, so a law is a ray from the origin; its dot is at the nominal stiffness, "
    "its end at ten times that."
)


def parallel_section(loaded: LoadedSpec, analysis: DesignAnalysis) -> Section:
    """Describe the parallel controllers."""
    rows = tuple(
        (
            item.name,
            *(
                linked(loaded, text, "controllers", item.name)
                for text in (
                    number(float(item.Kp), 6),
                    number(float(item.Ki), 6),
                    number(item.stiffness, 6),
                    item.unstable_text,
                )
            ),
        )
        for item in analysis.parallel
    )
    columns = (
        "Controller",
        "Kp [rad/(N·m)]",
        "Ki [rad/(N·m·s)]",
        "Nominal stiffness [N·m/rad]",
        "Unstable for k [N·m/rad]",
    )
    figure = draw_parallel(analysis.motion, analysis.parallel)
    return Section(
        "Parallel position and force control",
        (
            Paragraph(_TEXT),
            Table("Parallel controllers", columns, rows),
            Illustration("parallel-region", "Region of gains", _CAPTION, figure),
        ),
    )
