"""Doubtful parameters with which the controller starts."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
from fractions import Fraction
from pathlib import Path

from nrs_design.gating.obligations import Caution
from nrs_design.ros2.law import FILTER, NEEDED, PARAMETER_NAMES, AdmittanceLaw, unknown_names
from nrs_design.ros2.parameters import RosNode, texts

# Default share of the new sample; smaller shares smooth the force longer.
SLOW = Fraction(1, 20)
RETUNING = "enable_parameter_update_without_reactivation"
# Name of a parameter, index in its list, and the doubt.
Trap = tuple[str, int | None, str]


def find_traps(law: AdmittanceLaw, path: Path) -> Iterator[Caution]:
    """Yield what is doubtful about the parameters, each at its place."""
    for name, index, message in (*_damping(law), *_filter(law), *_settings(law), *_unknown(law)):
        place = law.node.place(name, index)
        yield Caution(path, f"{law.node.name}: {name}: {message}", place.line, place.column)


def _settings(law: AdmittanceLaw) -> Iterator[Trap]:
    masses = {axis.mass for axis in law.axes[:3]}, {axis.mass for axis in law.axes[3:]}
    if any(len(values) > 1 for values in masses) and not _same_frame(law.node):
        yield (
            "admittance.mass",
            None,
            "masses differ: since ros2_controllers 6.4.0, masses act along the axes of the control "
            "frame, like stiffness and damping; in older releases, masses act along the axes of "
            "the base, and a rotated control frame couples the axes: no verdict covers that",
        )
    if law.values[RETUNING][0]:
        state = "is on" if RETUNING in law.node.values else "is on by default"
        consequence = "parameters change while the controller runs, and no verdict covers that"
        yield RETUNING, None, f"{state}: {consequence}; set it to false"
    if missing := [name for name in NEEDED if name not in law.node.values]:
        names = ", ".join(missing)
        consequence = "unless another file or a launch file gives what this one does not"
        yield missing[0], None, f"the controller does not start without {names}, {consequence}"


def _same_frame(node: RosNode) -> bool:
    """Tell whether the control frame is the base."""
    frames = [
        texts(node.values[name]) if name in node.values else None
        for name in ("control.frame.id", "kinematics.base")
    ]
    names = [items[0].text for items in frames if items]
    return len(names) == len(frames) and names[0] == names[1]


def _unknown(law: AdmittanceLaw) -> Iterator[Trap]:
    """Yield names that may be slips of the pen, and the others together."""
    known, others = sorted(PARAMETER_NAMES), []
    for name in unknown_names(law.node):
        if matches := get_close_matches(name, known, n=1, cutoff=0.85):
            yield name, None, f"is not known to the controller; did you mean {matches[0]}?"
        else:
            others.append(name)
    if others:
        unknown_text = ", ".join(others)
        yield others[0], None, f"the controller passes over what it does not know: {unknown_text}"


def _damping(law: AdmittanceLaw) -> Iterator[Trap]:
    for index, axis in enumerate(law.axes):
        if axis.damping_ratio < 0:
            message = f"is negative for axis {axis.name}: it drives the motion"
            yield "admittance.damping_ratio", index, message
        elif axis.selected and axis.stiffness == 0 < axis.damping_ratio:
            left = float(law.joint_damping * axis.mass)
            unit = "N*m*s/rad" if axis.rotates else "N*s/m"
            yield (
                "admittance.stiffness",
                index,
                f"0 takes away the damping of axis {axis.name}, 2 damping_ratio sqrt(mass "
                f"stiffness); joint_damping is left, {float(law.joint_damping):g} 1/s, which acts "
                f"like {left:.3g} {unit}",
            )


def _filter(law: AdmittanceLaw) -> Iterator[Trap]:
    c = law.filter_coefficient
    if FILTER not in law.node.values:
        yield FILTER, None, "is not given; the default 0.05 smooths the force over 20 periods"
    elif not 0 < c <= 1:
        yield FILTER, None, f"{float(c):g} is no share of the new sample: write 0 < c <= 1"
    elif c <= SLOW:
        yield FILTER, None, f"{float(c):g} smooths the force over {float(1 / c):.0f} periods"
