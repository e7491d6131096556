"""The design: gains as shipped, motion loop, impedance and force control."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.design.transfer import TransferFunction, poles
from nrs_design.models.axis import unit
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.complex_plane import draw_root_locus
from nrs_design.reporting.formatting import number, polynomial_text, root, roots
from nrs_design.reporting.sections.impedance import CURVES, controller_tables, impedance_section
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.sections.titles import MOTION
from nrs_design.reporting.sections.torque import torque_blocks
from nrs_design.spec import InteractionDesignSpec

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis, ForceAnalysis
    from nrs_design.design.root_locus import PdDesign
    from nrs_design.pipeline.design import Designed

_NOMINAL = (
    "Design values in floating point, for contact at the nominal stiffness, in continuous time; no "
    "part of the proof. Design goals below has the worst margins over all corners, of the loop "
    "that is proved; warnings are about those."
)
_OFFSET = (
    "Steady error and peak torque with an offset: for an axis that arrives at the largest velocity "
    "of the spec, and a switch to force control exactly at its torque limit, which is Fd."
)
_NO_OFFSET = (
    "Steady error without an offset: for a commanded position X where contact begins. A simulated "
    "run keeps X as it was at the switch, and leaves another error."
)


_UNSTABLE = (
    "What the gains achieve is not shown: poles and margins exist only where the nominal loops are "
    "stable."
)
_MOTION = ("motion_loop",)
_NATURAL = "Natural frequency [rad/s]"
_FORCE_ROWS: tuple[tuple[str, Callable[[ForceAnalysis], str]], ...] = (
    ("Kp [rad/(N·m)]", lambda item: number(item.loop.gain, 6)),
    (
        "Ki [rad/(N·m·s)]",
        lambda item: number(item.approach.integral, 6) if item.approach.integral else "–",
    ),
    ("Nominal stiffness [N·m/rad]", lambda item: number(item.stiffness, 6)),
    ("Closed-loop poles [rad/s]", lambda item: roots(item.loop.poles)),
    ("Damping ratio [1]", lambda item: number(item.loop.damping_ratio)),
    (_NATURAL, lambda item: number(item.loop.natural_frequency)),
    ("Offset X_i", lambda item: item.approach.offset),
    ("Steady error over command [1]", lambda item: number(item.steady_error)),
    ("Peak torque [N·m]", lambda item: "–" if item.peak is None else number(item.peak)),
)


def design_sections(designed: Designed, analysis: DesignAnalysis | None) -> tuple[Section, ...]:
    """Describe a design; without an analysis only its gains."""
    gains = [_gain_table(designed)]
    if analysis is None:
        return (Section("Designed gains", (*gains, Paragraph(_UNSTABLE))),)
    parts = [Section("Designed gains", tuple(gains)), _motion_section(designed, analysis)]
    if analysis.impedance:
        parts.append(impedance_section(designed, analysis.impedance))
    if analysis.force:
        loci = (_force_locus(item) for item in analysis.force[:CURVES])
        parts.append(Section("Force control", (*force_blocks(designed, analysis), *loci)))
    if analysis.torque:
        title = "Impedance by torques"
        parts.append(Section(title, torque_blocks(designed.loaded, analysis)))
    return tuple(parts)


def _gain_table(designed: Designed) -> Table:
    design, rows = designed.design, []
    for name, law in design.laws.items():
        for gain, value in law.gains.items():
            unit = design.units[name][gain].replace("*", "·").replace("^2", "²")
            key_path = ("controllers", name, gain) if name in designed.spec.controllers else _MOTION
            texts = (number(float(value), 6), exact_decimal(value))
            rounded_value, exact = (linked(designed.loaded, text, *key_path) for text in texts)
            rows.append((name, gain, rounded_value, unit, exact))
        if not law.gains:
            rows.append((name, "no gain: the motion loop alone", "", "", ""))
    columns = ("Controller", "Gain", "Value", "Unit", "Exact value that ships (float32)")
    return Table("Gains of one axis", columns, tuple(rows))


def _motion_section(designed: Designed, analysis: DesignAnalysis) -> Section:
    target, blocks = analysis.wanted, motion_blocks(designed, analysis)
    loci = () if target is None else (_motion_locus(designed, analysis, target),)
    return Section(MOTION, (*blocks, *loci))


def motion_blocks(designed: Designed, analysis: DesignAnalysis) -> tuple[Block, ...]:
    """Describe the motion loop: its source, its requirements and the achieved values."""
    spec = designed.spec
    G = analysis.motion
    text = (
        f"Motion loop in use: G(s) = ({polynomial_text(G.numerator, 6)}) / "
        f"({polynomial_text(G.denominator, 6)}), from {_sides(spec)} velocity. "
        f"{_source(spec, analysis)}"
    )
    if (target := analysis.wanted) is None:
        return (Paragraph(text),)
    return Paragraph(text), _motion_table(designed, analysis, target)


def _sides(spec: InteractionDesignSpec) -> str:
    return "commanded torque to" if spec.torque_interface else "commanded to actual"


def _source(spec: InteractionDesignSpec, analysis: DesignAnalysis) -> str:
    if spec.followed is not None:
        commands = "velocities" if spec.velocity_interface else "positions"
        return (
            f"The robot closes this loop itself, and takes {commands}: there are no motion gains."
        )
    if spec.torque_interface is not None:
        return "Each controller closes its own loop around it, with its stiffness and damping."
    if analysis.motion_source == "given":
        return "The spec states this G itself; it need not be the one that the PD gains make."
    given = spec.motion_loop
    assert given is not None
    names = [
        name
        for name, value in (("derivative gain", given.derivative_gain), ("zero", given.zero))
        if value is not None
    ]
    if names:
        return f"It follows from the PD controller, whose {' and '.join(names)} the spec gives."
    return "It follows from the PD controller that was designed by root locus."


def _motion_table(designed: Designed, analysis: DesignAnalysis, target: PdDesign) -> Table:
    achieved, motion, command = analysis.reached, designed.design.motion, designed.design.command
    damping = -target.wanted_poles[0].real / target.natural_frequency
    per, six = unit("rad"), partial(number, digits=6)
    Kd, zero, omega = target.derivative_gain, target.zero, target.natural_frequency
    # Key of the spec, label, target and achieved value.
    rows = (
        ("derivative_gain", f"Kd [{command}·s/{per}]", six(Kd), six(float(motion.Kd))),
        ("zero", "Zero Kp/Kd [1/s]", six(zero), six(float(motion.zero))),
        ("zero", f"Kp [{command}/{per}]", six(Kd * zero), six(float(motion.Kp))),
        (
            "settling_time",
            "Poles [rad/s]",
            root(target.wanted_poles[0], 5),
            roots(achieved.poles, 5),
        ),
        ("damping_ratio", "Damping ratio [1]", number(damping), number(achieved.damping_ratio)),
        ("settling_time", _NATURAL, number(omega), number(achieved.natural_frequency)),
        ("damping_ratio", "Overshoot [%]", "–", number(100 * achieved.overshoot, 3)),
        ("settling_time", "Bandwidth [rad/s]", "–", number(achieved.bandwidth)),
    )
    cells = tuple(
        (label, *(linked(designed.loaded, text, "motion_loop", key) for text in texts))
        for key, label, *texts in rows
    )
    columns = ("", "Root locus asks for", "G and gains in use")
    return Table("Motion loop: wanted and reached", columns, cells)


def _motion_locus(designed: Designed, analysis: DesignAnalysis, target: PdDesign) -> Illustration:
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
    figure = draw_root_locus(open_loop, target.wanted_poles, poles(closed).tolist())
    return Illustration("root-locus", "Root locus of the PD design", caption, figure)


def force_blocks(designed: Designed, analysis: DesignAnalysis) -> tuple[Block, ...]:
    """Say what the force controllers achieve at nominal values."""
    items, title = analysis.force, "Force controllers, at nominal values"
    texts = {
        _NOMINAL: True,
        _OFFSET: any(item.peak is not None for item in items),
        _NO_OFFSET: any(item.approach.offset == "none" for item in items),
    }
    paragraphs = (Paragraph(text) for text, applies in texts.items() if applies)
    return (*paragraphs, *controller_tables(designed.loaded, title, _FORCE_ROWS, items))


def _force_locus(item: ForceAnalysis) -> Illustration:
    scaled = tuple(item.stiffness * c for c in item.forward.numerator)
    open_loop = TransferFunction(scaled, item.forward.denominator)
    ratio_note = ", with Ki/Kp kept" if item.approach.integral else ""
    caption = (
        f"Poles of the force loop of {item.name} while Kp grows from 0{ratio_note}, at nominal "
        f"stiffness {number(item.stiffness, 6)} {unit('N·m/rad')}. Diamonds: "
        f"Kp = {number(item.loop.gain)} {unit('rad/(N·m)')}."
    )
    figure = draw_root_locus(open_loop, (), item.loop.poles)
    title = f"Root locus of the force loop: {item.name}"
    return Illustration(f"force-locus-{item.name}", title, caption, figure)
