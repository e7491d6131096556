"""The design: gains as shipped, motion loop, impedance and force control."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.design.transfer import TransferFunction, poles
from nrs_design.proof.bounds import lower
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.complex_plane import draw_root_locus
from nrs_design.reporting.figures.impedance import draw_displayed_impedance, draw_sensitivity
from nrs_design.reporting.formatting import number, polynomial, root, roots
from nrs_design.reporting.sections.creep import creep_section
from nrs_design.reporting.sections.goals import goals_section
from nrs_design.reporting.sections.parallel import parallel_section
from nrs_design.spec import InteractionDesignSpec

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis, ForceAnalysis, ImpedanceAnalysis
    from nrs_design.design.passivity import PassiveBand
    from nrs_design.pipeline import Designed

# More controllers than these make a table too wide for a page, or a figure too full.
_COLUMNS = 4
_CURVES = 6

_NOMINAL = (
    "Design values in floating point, for contact at the nominal stiffness; no part of the proof."
)
_OFFSET = (
    "Steady error and peak torque with an offset: for an axis that arrives at the largest velocity "
    "of the spec, and a switch to force control exactly at its torque limit, which is Fd."
)
_SUDDEN = (
    "Viscoelastic contact: the stiffness is that which a sudden motion meets, and up to the "
    "stiffness limit all parameters of the law grow in proportion to it."
)


def _spring(item: ImpedanceAnalysis) -> str:
    return number(item.problem.loop.Kt, 6) if item.problem.loop.Kt else ""


_IMPEDANCE_ROWS: tuple[tuple[str, Callable[[ImpedanceAnalysis], str]], ...] = (
    ("Desired impedance [N·m·s/rad]", lambda item: number(item.problem.desired, 5)),
    ("Nominal stiffness [N·m/rad]", lambda item: number(item.problem.loop.contact.stiffness, 6)),
    ("Stiffness beside the damper [N·m/rad]", lambda item: _given(item, "parallel_stiffness")),
    ("Nominal damping [N·m·s/rad]", lambda item: _given(item, "damping", "0")),
    ("Mt at the optimum [kg·m²]", lambda item: number(item.optimum.Mt, 6)),
    ("Bt at the optimum [N·m·s/rad]", lambda item: number(item.optimum.Bt, 6)),
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
    ("Displayed admittance passive up to [Hz], exact", lambda item: _passive(item.band)),
)
_FORCE_ROWS: tuple[tuple[str, Callable[[ForceAnalysis], str]], ...] = (
    ("Kp [rad/(N·m)]", lambda item: number(item.loop.gain, 6)),
    ("Nominal stiffness [N·m/rad]", lambda item: number(item.stiffness, 6)),
    ("Closed-loop poles [rad/s]", lambda item: roots(item.loop.poles)),
    ("Damping ratio [1]", lambda item: number(item.loop.damping_ratio)),
    ("Natural frequency [rad/s]", lambda item: number(item.loop.natural_frequency)),
    ("Offset X_i", lambda item: item.approach.offset),
    ("Steady error over command [1]", lambda item: number(item.steady_error)),
    ("Peak torque [N·m]", lambda item: "–" if item.peak is None else number(item.peak)),
)


def design_sections(designed: Designed, analysis: DesignAnalysis | None) -> tuple[Section, ...]:
    """Describe a design; without an analysis only its gains."""
    spec, design = designed.spec, designed.design
    gains = Section("Designed gains", (_gain_table(design), *_ranges(spec, design)))
    if analysis is None:
        text = (
            "What the gains achieve is not shown: poles and margins exist only where the nominal "
            "loops are stable."
        )
        return (Section("Designed gains", (*gains.blocks, Paragraph(text))),)
    parts = [gains, _motion_section(designed, analysis)]
    if analysis.impedance:
        parts.append(_impedance_section(analysis.impedance))
    if sensor := creep_section(designed, analysis):
        parts.append(sensor)
    if analysis.force:
        parts.append(_force_section(analysis))
    if analysis.parallel:
        parts.append(parallel_section(analysis))
    if any(item.achieved for item in analysis.measured):
        parts.append(goals_section(spec, analysis))
    return tuple(parts)


def _gain_table(design: ControllerDesign) -> Table:
    rows = []
    for name, law in design.laws.items():
        for gain, value in law.gains.items():
            unit = design.units[name][gain].replace("*", "·").replace("^2", "²")
            rows.append((name, gain, number(float(value), 6), unit, exact_decimal(value)))
        if not law.gains:
            rows.append((name, "no gain: the motion loop alone", "", "", ""))
    columns = ("Controller", "Gain", "Value", "Unit", "Exact value that ships (float32)")
    return Table("Gains of one axis", columns, tuple(rows))


def _ranges(spec: InteractionDesignSpec, design: ControllerDesign) -> tuple[Block, ...]:
    """List the ranges of gains that the spec declares, if any."""
    rows = []
    for controller in design.controllers:
        for gain, declared in spec.controllers[controller.name].gains().items():
            if declared.range is not None and declared.ranged:
                low, high = (end.text for end in declared.range)
                rows.append((controller.name, gain, low, high))
    if not rows:
        return ()
    text = (
        "These gains may be retuned while the robot runs; the statement about stability is for "
        "the whole ranges, widened to the single-precision numbers that their ends round to."
    )
    columns = ("Controller", "Gain", "Lowest", "Highest")
    return Paragraph(text), Table("Declared ranges of gains", columns, tuple(rows))


def _motion_section(designed: Designed, analysis: DesignAnalysis) -> Section:
    spec, design = designed.spec, designed.design
    G = analysis.motion
    text = (
        f"Motion loop in use: G(s) = ({polynomial(G.numerator, 6)}) / "
        f"({polynomial(G.denominator, 6)}), from commanded to actual velocity. "
        f"{_source(spec, analysis)}"
    )
    return Section(
        "Motion loop",
        (Paragraph(text), _motion_table(design, analysis), _motion_locus(designed, analysis)),
    )


def _source(spec: InteractionDesignSpec, analysis: DesignAnalysis) -> str:
    if analysis.motion_source == "given":
        return "The spec states this G itself; it need not be the one that the PD gains make."
    given = spec.motion_loop
    names = [
        name
        for name, value in (("derivative gain", given.derivative_gain), ("zero", given.zero))
        if value is not None
    ]
    if names:
        return f"It follows from the PD controller, whose {' and '.join(names)} the spec gives."
    return "It follows from the PD controller that was designed by root locus."


def _motion_table(design: ControllerDesign, analysis: DesignAnalysis) -> Table:
    wanted, reached, motion = analysis.wanted, analysis.reached, design.motion
    damping = -wanted.wanted_poles[0].real / wanted.natural_frequency
    wanted_Kp = wanted.derivative_gain * wanted.zero
    rows = (
        (
            f"Kd [{design.command}·s/rad]",
            number(wanted.derivative_gain, 6),
            number(float(motion.Kd), 6),
        ),
        ("Zero Kp/Kd [1/s]", number(wanted.zero, 6), number(float(motion.zero), 6)),
        (
            f"Kp [{design.command}/rad]",
            number(wanted_Kp, 6),
            number(float(motion.Kp), 6),
        ),
        ("Poles [rad/s]", root(wanted.wanted_poles[0], 5), roots(reached.poles, 5)),
        ("Damping ratio [1]", number(damping), number(reached.damping_ratio)),
        (
            "Natural frequency [rad/s]",
            number(wanted.natural_frequency),
            number(reached.natural_frequency),
        ),
        ("Overshoot [%]", "–", number(100 * reached.overshoot, 3)),
        ("Bandwidth [rad/s]", "–", number(reached.bandwidth)),
    )
    return Table(
        "Motion loop: wanted and reached", ("", "Root locus asks for", "G and gains in use"), rows
    )


def _motion_locus(designed: Designed, analysis: DesignAnalysis) -> Illustration:
    design, actuator = designed.design, designed.plant.actuator
    gain, zero, Kd = float(actuator.gain), float(design.motion.zero), float(design.motion.Kd)
    lag = float(actuator.time_constant)
    open_loop = TransferFunction((gain, gain * zero), (lag, 1.0, 0.0))
    closed = TransferFunction((1.0,), (lag, 1.0 + Kd * gain, Kd * gain * zero))
    caption = (
        f"Poles of the motion loop while Kd grows from 0, with the zero kept at {number(-zero, 6)} "
        f"1/s. Squares: poles that damping ratio and settling time ask for. Diamonds: poles with "
        f"the shipped gains, {roots(poles(closed).tolist())} rad/s."
    )
    if analysis.motion_source == "given":
        caption += " The G that the spec states has its own poles, given in the table."
    figure = draw_root_locus(open_loop, Kd, analysis.wanted.wanted_poles, poles(closed).tolist())
    return Illustration("root-locus", "Root locus of the PD design", caption, figure)


def _impedance_section(items: tuple[ImpedanceAnalysis, ...]) -> Section:
    drawn = items[:_CURVES]
    rest = "" if len(drawn) == len(items) else f" The first {_CURVES} controllers are drawn."
    displayed = Illustration(
        "displayed-impedance",
        "Displayed and desired impedance",
        "Magnitude of the impedance that the operator feels in nominal contact (solid) and the "
        f"desired one (dashed); the dotted line is the bandwidth of the motion.{rest}",
        draw_displayed_impedance(drawn),
    )
    sensitivity = Illustration(
        "sensitivity",
        "Sensitivity",
        "Magnitude of L = 1/(1 + G Ze Y) in nominal contact; the marker is its peak Ms. A value "
        f"above 1 (gray line) amplifies disturbances of that frequency.{rest}",
        draw_sensitivity(drawn),
    )
    rows = [(label, [value(item) for item in items]) for label, value in _IMPEDANCE_ROWS]
    rows = [(label, values) for label, values in rows if any(values)]
    tables = _by_controller(
        "Impedance controllers",
        [label for label, _ in rows],
        [item.name for item in items],
        [list(column) for column in zip(*(values for _, values in rows), strict=True)],
    )
    paragraphs = [Paragraph(_NOMINAL)]
    if any(item.problem.loop.contact.remembers for item in items):
        paragraphs.append(Paragraph(_SUDDEN))
    return Section("Impedance control", (*paragraphs, *tables, displayed, sensitivity))


def _passive(band: PassiveBand | None) -> str:
    if band is None:
        return ""
    if band.passive is None:
        return "every frequency"
    return lower(band.passive * Fraction(1000, 6284), 4)


def _given(item: ImpedanceAnalysis, key: str, default: str = "") -> str:
    """Write a parameter of the nominal contact, if its law has it."""
    value = item.problem.loop.contact.given().get(key)
    return number(float(value), 5) if value is not None else default


def _force_section(analysis: DesignAnalysis) -> Section:
    tables = _by_controller(
        "Force controllers",
        [label for label, _ in _FORCE_ROWS],
        [item.name for item in analysis.force],
        [[value(item) for _, value in _FORCE_ROWS] for item in analysis.force],
    )
    loci = (_force_locus(analysis.motion, item) for item in analysis.force[:_CURVES])
    texts = [Paragraph(_NOMINAL)]
    if any(item.peak is not None for item in analysis.force):
        texts.append(Paragraph(_OFFSET))
    return Section("Force control", (*texts, *tables, *loci))


def _force_locus(motion: TransferFunction, item: ForceAnalysis) -> Illustration:
    scaled = tuple(item.stiffness * c for c in motion.numerator)
    open_loop = TransferFunction(scaled, motion.denominator)
    # A gain of zero is allowed; the locus still needs a range of gains.
    gain = item.loop.gain or 1 / item.stiffness
    caption = (
        f"Poles of the force loop of {item.name} while Kp grows from 0, at the nominal stiffness "
        f"{number(item.stiffness, 6)} N·m/rad. Diamonds: Kp = {number(item.loop.gain)} rad/(N·m)."
    )
    figure = draw_root_locus(open_loop, gain, (), item.loop.poles)
    return Illustration(
        f"force-locus-{item.name}",
        f"Root locus of the force loop: {item.name}",
        caption,
        figure,
    )


def _by_controller(
    title: str, labels: Sequence[str], names: Sequence[str], columns: Sequence[Sequence[str]]
) -> list[Block]:
    """Make tables with a row for each quantity and a column for each controller."""
    tables: list[Block] = []
    for start in range(0, len(names), _COLUMNS):
        part = slice(start, start + _COLUMNS)
        rows = tuple(zip(labels, *columns[part], strict=True))
        tables.append(Table(title, ("", *names[part]), rows))
    return tables
