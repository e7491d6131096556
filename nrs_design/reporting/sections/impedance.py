"""Impedance control: gains, margins, and what is displayed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.proof.bounds import lower, upper
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.impedance import draw_displayed_impedance, draw_sensitivity
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked

if TYPE_CHECKING:
    from nrs_design.design.analysis import ImpedanceAnalysis
    from nrs_design.design.passivity import PassiveBand
    from nrs_design.design.sampled_passivity import SampledBand
    from nrs_design.pipeline import Designed

# More controllers than these make a table too wide for a page, or a figure too full.
_COLUMNS = 4
CURVES = 6

NOMINAL = (
    "Design values in floating point, for contact at the nominal stiffness; no part of the proof. "
    "Design goals below has the worst values over all corners, which warnings are about."
)
_CONTINUOUS = (
    " Margins and limits of stiffness are those of the loop in continuous time, with the force of "
    "the moment: the sampling that the spec declares takes from them. The proof is about the "
    "sampled loop."
)
_SUDDEN = (
    "Viscoelastic contact: the stiffness is that which a sudden motion meets, and up to the "
    "stiffness limit all parameters of the law grow in proportion to it."
)

_PASSIVE_SAMPLED = (
    "Sampled: any force whose frequencies all lie below takes no energy from the robot, at the "
    "worst of the ages of the force sample, each of them kept, with the nominal motor. No law that "
    "samples a force is passive for every force: between two samples it acts unseen."
)


def _at_arm(item: ImpedanceAnalysis) -> str:
    return "" if item.limit_at_arm is None else number(item.limit_at_arm)


def _optimal(item: ImpedanceAnalysis, gain: str) -> str:
    """Write a gain at the optimum; one that the spec gives was not chosen."""
    given = getattr(item.given, gain).fixed
    return "given" if given else number(getattr(item.optimum, gain), 6)


def _spring(item: ImpedanceAnalysis) -> str:
    return number(item.problem.loop.Kt, 6) if item.problem.loop.Kt else ""


_IMPEDANCE_ROWS: tuple[tuple[str, Callable[[ImpedanceAnalysis], str]], ...] = (
    ("Desired impedance [N·m·s/rad]", lambda item: number(item.problem.desired, 5)),
    ("Nominal stiffness [N·m/rad]", lambda item: number(item.problem.loop.contact.stiffness, 6)),
    ("Stiffness beside the damper [N·m/rad]", lambda item: _given(item, "parallel_stiffness")),
    ("Nominal damping [N·m·s/rad]", lambda item: _given(item, "damping", "0")),
    ("Mt at the optimum [kg·m²]", lambda item: _optimal(item, "Mt")),
    ("Bt at the optimum [N·m·s/rad]", lambda item: _optimal(item, "Bt")),
    ("Mt as shipped [kg·m²]", lambda item: number(item.Mt, 6)),
    ("Bt as shipped [N·m·s/rad]", lambda item: number(item.Bt, 6)),
    ("Kt as given [N·m/rad]", _spring),
    ("Cost as shipped [1]", lambda item: number(item.cost, 5)),
    ("Sensitivity peak Ms [1]", lambda item: number(item.margins.sensitivity_peak)),
    ("Frequency of Ms [rad/s]", lambda item: number(item.margins.sensitivity_peak_frequency)),
    ("Gain margin, up [factor]", lambda item: number(item.margins.gain_margin)),
    ("Gain margin, down [factor]", lambda item: number(item.margins.gain_margin_low)),
    ("Phase margin [deg]", lambda item: number(math.degrees(item.margins.phase_margin))),
    ("Delay margin [ms]", lambda item: number(1e3 * item.margins.delay_margin)),
    ("Disk margin [1]", lambda item: number(item.margins.disk_margin)),
    ("Stiffness limit [N·m/rad]", lambda item: number(item.margins.stiffness_limit)),
    ("Stiffness limit at the lever arm [N/m]", _at_arm),
    ("Displayed admittance passive up to [Hz], exact", lambda item: _passive(item.band)),
    ("The same, sampled [Hz], exact", lambda item: _sampled(item.sampled)),
    ("Sampled, not passive near [Hz]", lambda item: _broken(item.sampled)),
)

# Where a spec says what a row of the table shows, or what it follows from.
_SAID: dict[str, Callable[[ImpedanceAnalysis], tuple[str, ...]]] = {
    "Desired impedance [N·m·s/rad]": lambda item: ("controllers", item.name, _wanted(item)),
    "Nominal stiffness [N·m/rad]": lambda item: (*_home(item), "stiffness"),
    "Nominal damping [N·m·s/rad]": lambda item: (*_home(item), "damping"),
    "Mt at the optimum [kg·m²]": lambda item: ("controllers", item.name, "Mt"),
    "Bt at the optimum [N·m·s/rad]": lambda item: ("controllers", item.name, "Bt"),
    "Mt as shipped [kg·m²]": lambda item: ("controllers", item.name, "Mt"),
    "Bt as shipped [N·m·s/rad]": lambda item: ("controllers", item.name, "Bt"),
    "Kt as given [N·m/rad]": lambda item: ("controllers", item.name, "Kt"),
}


def _wanted(item: ImpedanceAnalysis) -> str:
    given = item.given.desired_impedance is not None
    return "desired_impedance" if given else "desired_impedance_ratio"


def _home(item: ImpedanceAnalysis) -> tuple[str, str]:
    return "environments", item.given.environment


def nominal_note(designed: Designed) -> Paragraph:
    """Say what nominal values are about.

    Parameters
    ----------
    designed : Designed
        Whose values are shown.
    """
    return Paragraph(NOMINAL + (_CONTINUOUS if designed.spec.sampling is not None else ""))


def impedance_section(designed: Designed, items: tuple[ImpedanceAnalysis, ...]) -> Section:
    """Show cost, margins and curves of the impedance controllers.

    Parameters
    ----------
    designed : Designed
        With the places of all that the spec says.
    items : tuple of ImpedanceAnalysis
        At least one.
    """
    drawn = items[:CURVES]
    rest = "" if len(drawn) == len(items) else f" The first {CURVES} controllers are drawn."
    displayed = Illustration(
        "displayed-impedance",
        "Displayed and desired impedance",
        "Magnitude of the impedance that the operator feels in nominal contact (solid) and the "
        "desired one (dashed); the dotted line is the bandwidth of the motion. Shaded: what the "
        f"goal allows up to there, or what is usual.{rest}",
        draw_displayed_impedance(drawn),
    )
    sensitivity = Illustration(
        "sensitivity",
        "Sensitivity",
        "Magnitude of L = 1/(1 + G Ze Y) in nominal contact; the marker is its peak Ms. A value "
        f"above 1 (gray line) amplifies disturbances of that frequency.{rest}",
        draw_sensitivity(drawn),
    )
    rows = [
        (label, [_linked(designed, label, item, value(item)) for item in items])
        for label, value in _IMPEDANCE_ROWS
    ]
    rows = [(label, values) for label, values in rows if any(values)]
    tables = by_controller(
        "Impedance controllers, at nominal values",
        [label for label, _ in rows],
        [item.name for item in items],
        [list(column) for column in zip(*(values for _, values in rows), strict=True)],
    )
    paragraphs = [nominal_note(designed)]
    if any(item.problem.loop.contact.remembers for item in items):
        paragraphs.append(Paragraph(_SUDDEN))
    if any(item.sampled for item in items):
        paragraphs.append(Paragraph(_PASSIVE_SAMPLED))
    return Section("Impedance control", (*paragraphs, *tables, displayed, sensitivity))


def _passive(band: PassiveBand | None) -> str:
    if band is None:
        return ""
    if band.passive is None:
        return "every frequency"
    return lower(band.passive * Fraction(1000, 6284), 4)


def _sampled(bands: Sequence[SampledBand]) -> str:
    """Write the least band over the ages of the force sample."""
    if not bands:
        return ""
    passive = min(band.passive for band in bands)
    return lower(passive * Fraction(1000, 6284), 4) if passive else "not shown"


def _broken(bands: Sequence[SampledBand]) -> str:
    """Write the least frequency at which an age of the force sample is not passive."""
    found = [band.broken[1] for band in bands if band.broken is not None]
    return upper(min(found) * Fraction(1000, 6283), 4) if found else ""


def _given(item: ImpedanceAnalysis, key: str, default: str = "") -> str:
    """Write a parameter of the nominal contact, if its law has it."""
    value = item.problem.loop.contact.given().get(key)
    return number(float(value), 5) if value is not None else default


def _linked(designed: Designed, label: str, item: ImpedanceAnalysis, text: str) -> str:
    # What follows from several lines leads to the controller, which names the others.
    at = _SAID[label](item) if label in _SAID else ("controllers", item.name)
    return linked(designed.loaded, text, *at)


def by_controller(
    title: str, labels: Sequence[str], names: Sequence[str], columns: Sequence[Sequence[str]]
) -> list[Block]:
    """Make tables with a row for each quantity and a column for each controller.

    Parameters
    ----------
    title : str
        Of every table.
    labels : sequence of str
        Of the rows.
    names : sequence of str
        Of the controllers.
    columns : sequence of sequences of str
        Cells of each controller.
    """
    tables: list[Block] = []
    for start in range(0, len(names), _COLUMNS):
        part = slice(start, start + _COLUMNS)
        rows = tuple(zip(labels, *columns[part], strict=True))
        tables.append(Table(title, ("", *names[part]), rows))
    return tables
