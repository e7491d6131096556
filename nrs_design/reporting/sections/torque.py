"""Impedance by torques: which controllers are passive."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.models.axis import labelled
from nrs_design.reporting.document import Block, Paragraph, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.spec import LoadedSpec

_TEXT = (
    "Each controller makes the joint a spring and a damper. Whether it is passive, whatever it "
    "touches, is exact for commands that take effect at once and no measured force: b > K T/2 + B "
    "with the least friction b of the spec (Colgate and Schenkel 1997). It is no part of the proof."
)


def torque_blocks(loaded: LoadedSpec, analysis: DesignAnalysis) -> tuple[Block, ...]:
    """Say how stiff and damped the controllers that make torques are, and which are passive."""
    rows = tuple(
        (
            item.name,
            linked(loaded, number(item.Kp, 6), "controllers", item.name, "stiffness"),
            linked(loaded, number(item.B, 6), "controllers", item.name, "damping"),
            item.passive_text,
        )
        for item in analysis.torque
    )
    columns = (
        "Controller",
        labelled("K [N·m/rad]"),
        labelled("B [N·m·s/rad]"),
        labelled("Passive, margin [N·m·s/rad]"),
    )
    return Paragraph(_TEXT), Table("Controllers that make torques", columns, rows)
