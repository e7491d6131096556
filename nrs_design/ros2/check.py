"""Hold a parameter file of ros2_controllers against what its robot touches."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path

from nrs_design.errors import Fault, SpecError
from nrs_design.gating.obligations import Caution, GateOutcome, Obligation, SpecOutcome, Status
from nrs_design.gating.rules import RULES, Rule
from nrs_design.progress import Progress
from nrs_design.proof.bounds import nearly
from nrs_design.proof.evidence.fields import rate_text
from nrs_design.proof.mode import Time
from nrs_design.ros2.axis import ControllerContext, assumptions, close_axis
from nrs_design.ros2.law import (
    LAW,
    ROTATIONAL,
    STIFFNESS,
    AdmittanceLaw,
    Axis,
    Range,
    is_admittance,
    read_law,
    read_parameter,
)
from nrs_design.ros2.managers import MANAGER, find_undecided, kind_of, managers_of
from nrs_design.ros2.parameters import RosNode, read_nodes
from nrs_design.ros2.traps import find_traps
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.spec.document import Position

PARAMETERS, AXIS, REMAINING_NODES = (RULES[f"NRS20{i}"] for i in (1, 2, 3))

# The verdict on a file is the worst of its axes; the worst comes first.
_ORDER = (Status.ERROR, Status.MISSED, Status.REFUTED, Status.INCONCLUSIVE, Status.PROVED)


@dataclass(slots=True)
class _Asker:
    """Decides axes, each distinct one once."""

    path: Path
    limits: Limits
    progress: Progress
    verdicts: dict[tuple[object, ...], tuple[Status, str]] = field(default_factory=dict)

    def obligation(self, law: AdmittanceLaw, axis: Axis, context: ControllerContext) -> Obligation:
        """Return the verdict on one axis."""
        name, stiffness = f"{law.node.name}: axis {axis.name}", context.find_stiffness(axis)
        if axis.selected and law.force_source is not None:
            words = f"its force comes through {law.force_source}, another controller: not modelled"
            found = Status.INCONCLUSIVE, words
        elif stiffness is None:
            kind = ROTATIONAL if axis.rotates else STIFFNESS
            option = "--rotational-stiffness" if axis.rotates else "--stiffness"
            words = f"nothing is said of what it touches: give {option} '{kind.example}'"
            found = Status.INCONCLUSIVE, words
        else:
            numbers = (axis.mass, axis.damping_ratio, axis.stiffness, axis.selected, axis.rotates)
            key = (*numbers, stiffness, law.joint_damping, law.filter_coefficient, context.period)
            if key not in self.verdicts:
                self.progress(name)
                self.verdicts[key] = self._certify(law, axis, context, stiffness)
            found = self.verdicts[key]
        return _owed(AXIS, self.path, name, *found, axis.position)

    def _certify(
        self, law: AdmittanceLaw, axis: Axis, context: ControllerContext, stiffness: Range
    ) -> tuple[Status, str]:
        system = close_axis(law, axis, context)
        found = certify(system, limits=self.limits)
        status, evidence = Status(str(found.verdict)), found.evidence
        range_text = "by itself (no force acts on it)"
        if axis.selected:
            range_text = _range(stiffness, "N*m/rad" if axis.rotates else "N/m")
        if evidence is None:
            claim = "neither a proof nor a refutation was found"
        elif status is Status.PROVED:
            rate = evidence.proved_rate(system)
            bound = "" if rate is None else f", rho <= {rate_text(rate, Time.DISCRETE)} per period"
            contact = ""
            if axis.selected:
                contact = (
                    ", contact lost at will" if evidence.covers_lost_contact else ", in contact"
                )
            claim = f"stable{contact}{bound}"
        else:
            claim = evidence.claim(system)
        return status, f"{range_text}: {claim}"


def check_file(
    path: Path, base_context: ControllerContext, limits: Limits, progress: Progress
) -> GateOutcome:
    """Read every admittance controller of a file, and decide each of its axes.

    Each is asked about in a context with the period that the file says.
    """
    nodes = read_nodes(path)
    controllers = _controllers(nodes, path)
    undecided = [*find_undecided(nodes, controllers)]
    names = {node.base_name for node in nodes} | {other.name for other in undecided}
    asker = _Asker(path, limits, progress)
    obligations: list[Obligation] = []
    cautions: list[Caution] = []
    notes: dict[str, None] = {}
    for node in controllers:
        managers = managers_of(node, nodes)
        manager = managers[0] if len(managers) == 1 else None
        law, faults = _read(node, manager, nodes, names)
        if law is None:
            obligations += [_unreadable(path, node, fault) for fault in faults]
            continue
        rate = _rate(law, manager, path)
        context = replace(base_context, period=1 / rate)
        notes |= dict.fromkeys((*assumptions(context), _rate_note(law, manager, rate)))
        read = "the parameters that the law depends on are read as written"
        obligations.append(_owed(PARAMETERS, path, node.name, Status.MET, read, node.position))
        obligations += [asker.obligation(law, axis, context) for axis in law.axes]
        cautions += find_traps(law, path)
    for other in (other for other in undecided if not other.silent):
        reason = f"passed over, so undecided: {other.reason}"
        owed = _owed(REMAINING_NODES, path, other.name, Status.INCONCLUSIVE, reason, other.position)
        obligations.append(owed)
    outcome = SpecOutcome(
        path, tuple(obligations), verdict=_verdict(obligations), cautions=tuple(cautions)
    )
    lines = [f"taken for granted: {note}" for note in notes]
    if silent := ", ".join(other.name for other in undecided if other.silent):
        lines.append(f"passed over, because they command nothing: {silent}")
    return GateOutcome((outcome,), tuple(lines))


def _controllers(nodes: Collection[RosNode], path: Path) -> list[RosNode]:
    """Return the admittance controllers of a file, of which there must be one."""
    others = (node for node in nodes if node.base_name != MANAGER)
    found = [node for node in others if is_admittance(node, kind_of(node, nodes))]
    # A wildcard sets parameters of the controllers that match it, and is no controller itself.
    found = [node for node in found if not any(map(node.matches_node, found))]
    if not found:
        names = ", ".join(node.name for node in nodes)
        raise SpecError(
            f"no admittance controller is among its nodes ({names})",
            path=path,
            remedy="name the file that holds `admittance:` with mass, damping_ratio and stiffness",
        )
    return found


def _read(
    node: RosNode, manager: RosNode | None, nodes: Collection[RosNode], names: Collection[str]
) -> tuple[AdmittanceLaw | None, Sequence[Fault]]:
    """Return the law of a controller, or the faults of its parameters and rate."""
    controllers = [other for other in nodes if other.base_name != MANAGER]
    if shared_faults := _find_shared(node, controllers, LAW):
        return None, shared_faults
    try:
        law = read_law(node, names)
    except SpecError as error:
        return None, error.faults
    rates = _find_shared(manager, nodes, ("update_rate",)) if manager else []
    return (None, rates) if rates else (law, ())


def _find_shared(node: RosNode, nodes: Iterable[RosNode], names: Collection[str]) -> list[Fault]:
    """Return a fault for each parameter that a second node may also set."""
    return [
        other.fault(
            name,
            f"counts for {node.name}, too; if both say it, releases differ in which counts",
            f"write it at {node.name} alone",
        )
        for other in nodes
        if other is not node and node.may_share(other)
        for name in other.values
        if name in names
    ]


def _owed(
    rule: Rule, path: Path, name: str, status: Status, message: str, place: Position
) -> Obligation:
    return Obligation(rule, path, name, status, f"{name}: {message}", place.line, place.column)


def _verdict(obligations: Iterable[Obligation]) -> str | None:
    """Return the worst of what was decided; None where something could not be read."""
    found = {item.status for item in obligations} - {Status.MET}
    worst = next((status for status in _ORDER if status in found), None)
    return None if worst in (None, Status.ERROR) else str(worst)


def _rate(law: AdmittanceLaw, manager: RosNode | None, path: Path) -> Fraction:
    """Return how often the law runs, in 1/s: the manager's rate, or its own if that is lower."""
    law_rate = law.values["update_rate"][0]
    values, faults = read_parameter(manager, "update_rate") if manager else ((), [])
    rate = values[0] if values else Fraction(0)
    if not faults and not rate:
        message = "the rate of the control loop is not in this file"
        faults = [law.node.fault("update_rate", message, "add update_rate of controller_manager")]
    elif not faults and 0 < law_rate < rate and rate % law_rate:
        message = (
            f"{law_rate} does not divide {rate}, the rate of the control loop: the controller runs "
            "at uneven periods, or at another rate"
        )
        faults = [law.node.fault("update_rate", message, "write a rate that divides it")]
    if faults:
        raise SpecError.combine(faults, path)
    return min(rate, law_rate) if law_rate else rate


def _rate_note(law: AdmittanceLaw, manager: RosNode | None, rate: Fraction) -> str:
    """Name the source of the rate: only this file is read."""
    assert manager is not None  # _rate
    line = manager.place("update_rate").line
    text = f"{law.node.name} runs {nearly(rate)} times per second, as "
    text += f"{manager.name} (line {line}) says"
    if law.values["update_rate"][0]:
        law_line = law.node.place("update_rate").line
        text += f" together with its own update_rate (line {law_line})"
    return f"{text}; what a launch file, a command line or another file sets is not seen here"


def _unreadable(path: Path, node: RosNode, fault: Fault) -> Obligation:
    message = f"{fault.message} ({fault.remedy})" if fault.remedy else fault.message
    return Obligation(PARAMETERS, path, node.name, Status.ERROR, message, fault.line, fault.column)


def _range(stiffness: Range, unit: str) -> str:
    low, high = stiffness
    if low == high:
        return f"at {nearly(low, unit)}"
    return f"from {nearly(low)} to {nearly(high, unit)}"
