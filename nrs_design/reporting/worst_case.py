"""The worst runs that an adversary found, with limits and certified bounds, in display units."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.models.axis import current, labelled
from nrs_design.models.axis import unit as shown
from nrs_design.pipeline.certification import Result
from nrs_design.pipeline.scenarios import WorstCase, run_worst_case
from nrs_design.proof.bounds import lower, upper
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.simulated import Panel, draw_panels, iterate_stays
from nrs_design.reporting.sections.places import linked
from nrs_design.simulation.run import common_lever_arm
from nrs_design.simulation.worst_case import DEFLECTION, WorstRun, output_values, pushes_only

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.proof.channels import Output
    from nrs_design.spec import InteractionDesignSpec

COLUMNS = ("", "worst found", "unit", "limit", "certified bound", "bound / found")
MEANING = (
    "An adversary chose controllers, contact, delay and disturbances within what the spec allows. "
    "He began at rest, or settled under what he held for long: pressed in, or on the way to a "
    "surface. What he found may happen in the model, and is a lower bound of the worst that may; "
    "the certified bound is an upper one. In his runs a surface that is lost stays in its place. "
    "The limit of the velocity is that of its command; the axis itself may go beyond."
)
NO_BOUND = "No bound is certified beside it: the worst that may happen may be any larger."
UNDECLARED = (
    "The spec names no disturbances, so the velocity command took any course up to its limit; "
    "with `disturbances` a bound can be certified."
)
UPPER_SIGN = " (above)"
# Effects that the adversary does not use.
LEFT_OUT = "roundings of the law, jitter, noise without a bound, and the limit of the command"
_COMMAND = "velocity command"
_TITLE = "Worst case found"
_CAPTION = (
    "The worst run that was found for the force. Contact, controller and command change between "
    "steps as the adversary likes, within the rules of the spec. No run crosses a dashed line. "
    "`nrs-design simulate --worst-case` draws the worst runs for velocity and deflection, too."
)


def meaning(case: WorstCase) -> str:
    """Say what the numbers mean."""
    return MEANING if case.bounds else f"{MEANING.partition(';')[0]}. {NO_BOUND}"


def worst_rows(case: WorstCase, spec: InteractionDesignSpec) -> list[list[str]]:
    """Return rows for `COLUMNS`: what was found rounded down, bounds rounded up."""
    rows, lever_arm = [], common_lever_arm(spec, spec.touched)
    for item in case.found:
        factor, unit = scale_of(item["output"], item["unit"], lever_arm)
        limit, bound, ratio = item["limit"], item["certified_bound"], item["bound_over_found"]
        rows.append(
            [
                item["output"],
                lower(Fraction(factor * item["worst_found"]), 4)
                + UPPER_SIGN * item["exceeds_limit"],
                unit,
                "–" if limit is None else f"{factor * limit:.4g}",
                "–" if bound is None else upper(Fraction(factor * bound), 4),
                "–" if ratio is None else upper(Fraction(ratio), 3),
            ]
        )
    return rows


def worst_case_section(result: Result) -> Section | None:
    """Show the worst runs found in their units, or say why none is; None for given matrices."""
    designed = result.designed
    if designed is None:
        return None
    try:
        case = run_worst_case(designed, result.certificate)
    except DesignError as error:
        explanation = f"{error.message[0].upper()}{error.message[1:]}."
        return Section(_TITLE, (Paragraph(explanation),))
    undeclared = "" if case.declared else f"{UNDECLARED} "
    explanation = (
        f"{meaning(case)} {undeclared}Not in it: {LEFT_OUT}. Floating point, no part of the proof."
    )
    rows, loaded = [], designed.loaded
    for name, found, unit, limit, *bound_cells in worst_rows(case, designed.spec):
        key = "torque" if name == "force" else name
        rows.append((name, found, unit, linked(loaded, limit, "limits", key), *bound_cells))
    figure = draw_worst(case, case.runs[0], designed.spec)
    blocks = (
        Paragraph(explanation),
        Table("Worst found, limit and bound", COLUMNS, tuple(rows)),
        Illustration("worst-case", "The worst run found", _CAPTION, figure),
    )
    return Section(_TITLE, blocks)


def scale_of(name: str, unit: str, lever_arm: float | None) -> tuple[float, str]:
    """Return the factor from SI to the display unit, and that unit.

    With a lever arm in m, a deflection is in mm.
    """
    if name == DEFLECTION and lever_arm is not None:
        return 1e3 * lever_arm, "mm"
    fine = current().fine
    scales = {"N*m": (1.0, "N m"), "rad/s": (fine, "deg/s"), "rad": (fine, "deg")}
    conversions = {shown(si): (scale, shown(display)) for si, (scale, display) in scales.items()}
    return conversions.get(unit, (1.0, unit))


def draw_worst(case: WorstCase, run: WorstRun, spec: InteractionDesignSpec) -> Figure:
    """Draw a run: all quantities with limits and bounds, the command and the active controller."""
    lever_arm = common_lever_arm(spec, spec.touched)
    panels = [_panel(case, run, other.output, lever_arm) for other in case.runs]
    names = [channel.name for channel in case.system.channels]
    if _COMMAND in names:
        command = current().fine * run.disturbances[:, names.index(_COMMAND)]
        panels.append(Panel(labelled("Command [deg/s]"), {"": np.append(command, command[-1:])}))
    free = () if case.system.contact is None else case.system.contact.free
    modes = [_controller(mode.name) for mode in (*case.system.modes, *free)]
    active = [modes[mode] for mode in run.mode.tolist()]
    return draw_panels(run.time, panels, [*iterate_stays(run.time, active)])


def _controller(mode: str) -> str:
    """Return the controller of a mode, and whether it touches anything."""
    parts = mode.split("/")
    return f"{parts[0]}, no contact" if "free" in parts[1:] else parts[0]


def _panel(case: WorstCase, run: WorstRun, output: Output, lever_arm: float | None) -> Panel:
    factor, unit = scale_of(output.name, output.unit, lever_arm)
    values = factor * output_values(case.system, output, run.states)
    # Over the range of the contact, take the signal with the largest magnitude.
    farthest = values[:, np.abs(values).max(axis=0).argmax()]
    limit, bound = case.limits.get(output.name), case.bounds.get(output.name)
    both_signs, signs = (1, -1), (1,) if pushes_only(case.system, output) else (1, -1)
    limits = () if limit is None else tuple(sign * factor * limit for sign in both_signs)
    bounds = () if bound is None else tuple(sign * factor * bound for sign in signs)
    label = f"{output.name.capitalize()} [{unit}]"
    return Panel(label, {output.name: farthest}, limits, bounds, "certified bound")
