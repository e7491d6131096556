"""Impedance by torques: how stiff each damping may be, and where it is passive."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.axis import labelled
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.style import BLUE, INK, PURPLE, VERMILLION, legend, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.laws.torque_impedance import TorqueAnalysis
    from nrs_design.spec import LoadedSpec

_TEXT = (
    "Each controller makes the joint a spring and a damper. Whether it is passive, whatever it "
    "touches, is exact for commands that take effect at once and no measured force: b > K T/2 + B "
    "with the least friction b of the spec (Colgate and Schenkel 1997). The border in the air is "
    "that of the nominal joint, in floating point. Neither is part of the proof."
)
_CAPTION = (
    "In the air, stable below the border, which is that of the characteristic polynomial of the "
    "nominal joint; dashed, what Gil and others (2009) estimate for it where B is small. Passive "
    "below the dotted line, were commands to take effect at once. Dots: the controllers."
)
POINTS = 80


def torque_section(loaded: LoadedSpec, analysis: DesignAnalysis) -> Section:
    """Describe the controllers that make torques, with the borders of stiffness."""
    figure = draw_borders(analysis.torque)
    drawn = Illustration("torque-borders", "Borders of stiffness", _CAPTION, figure)
    return Section("Impedance by torques", (*torque_blocks(loaded, analysis), drawn))


def torque_blocks(loaded: LoadedSpec, analysis: DesignAnalysis) -> tuple[Block, ...]:
    """Say how stiff and damped the controllers that make torques are, and may be."""
    rows = tuple(
        (
            item.name,
            linked(loaded, number(item.Kp, 6), "controllers", item.name, "stiffness"),
            linked(loaded, number(item.B, 6), "controllers", item.name, "damping"),
            number(item.border, 6),
            item.passive_text,
        )
        for item in analysis.torque
    )
    columns = (
        "Controller",
        labelled("K [N·m/rad]"),
        labelled("B [N·m·s/rad]"),
        labelled("Stable in the air below [N·m/rad]"),
        labelled("Passive, margin [N·m·s/rad]"),
    )
    return Paragraph(_TEXT), Table("Controllers that make torques", columns, rows)


@styled
def draw_borders(items: Sequence[TorqueAnalysis]) -> Figure:
    """Draw stiffness against damping: the border in the air, its estimate, and what is passive."""
    figure, axes = new_axes(4.2)
    wall = items[0].wall
    widest = max(2.5 * wall.friction, 1.5 * max(item.B for item in items))
    damping = np.linspace(0.0, widest, POINTS)
    axes.plot(damping, [wall.border(B) for B in damping], color=BLUE, label="stable in the air")
    estimate = [wall.estimate(B) for B in damping]
    axes.plot(damping, estimate, color=VERMILLION, linestyle="--", label="(b + B)/(T/2 + t)")
    passive = np.maximum(wall.friction - damping, 0.0) * 2 / wall.period
    axes.plot(damping, passive, color=PURPLE, linestyle=":", label="passive: (b - B) 2/T")
    for item in items:
        axes.plot(item.B, item.Kp, "o", color=INK)
        axes.annotate(item.name, (item.B, item.Kp), xytext=(5, 5), textcoords="offset points")
    axes.set_xlabel(labelled("damping B [N m s/rad]"))
    axes.set_ylabel(labelled("stiffness K [N m/rad]"))
    axes.set_xlim(0, widest)
    axes.set_ylim(0, None)
    legend(figure, axes, 2)
    return figure
