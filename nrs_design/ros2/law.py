"""The law of ``admittance_controller`` of ros2_controllers, from its parameters.

Names, types and bounds are those of the parameters that it declares
(ros2_controllers, ``admittance_controller_parameters.yaml``).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction
from types import MappingProxyType

from nrs_design.errors import Fault, SpecError
from nrs_design.ros2.parameters import RosNode, read_bool, read_double, read_integer, texts
from nrs_design.spec.document import Position, Scalar
from nrs_design.spec.quantity import QuantityKind

Range = tuple[Fraction, Fraction]  # Both ends

# Quantities of options, each with an example that the option accepts.
STIFFNESS = QuantityKind("a stiffness for translations", ("N/m",), "200..2000 N/m")
ROTATIONAL = QuantityKind("a stiffness for rotations", ("N*m/rad",), "5..40 N*m/rad")
LAG = QuantityKind("a time", ("s",), "5..20 ms")
AXES = ("x", "y", "z", "rx", "ry", "rz")
TYPE = "admittance_controller/AdmittanceController"
FILTER = "ft_sensor.filter_coefficient"


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter that the law depends on."""

    read: Callable[[str], Fraction]  # Reads one value, and says why ROS 2 would not
    count: int = 1  # Length of the list; 1 for a single value
    # low, high: bounds that the node enforces.
    low: Fraction | None = None
    high: Fraction | None = None
    default: Fraction | None = None  # None if the parameter is required


LAW: Mapping[str, Parameter] = MappingProxyType(
    {
        "admittance.selected_axes": Parameter(read_bool, 6),
        "admittance.mass": Parameter(read_double, 6, Fraction("0.0001"), Fraction(10**6)),
        "admittance.damping_ratio": Parameter(read_double, 6),
        "admittance.stiffness": Parameter(read_double, 6, Fraction(0), Fraction(10**8)),
        "admittance.joint_damping": Parameter(read_double, low=Fraction(0), default=Fraction(5)),
        FILTER: Parameter(read_double, default=Fraction("0.05")),
        "gravity_compensation.CoG.force": Parameter(read_double, default=Fraction(0)),
        "kinematics.alpha": Parameter(read_double, default=Fraction("0.01")),
        "enable_parameter_update_without_reactivation": Parameter(read_bool, default=Fraction(1)),
        "update_rate": Parameter(read_integer, low=Fraction(0), default=Fraction(0)),
    }
)
# Required parameters that the law does not depend on.
NEEDED = (
    "joints",
    "command_interfaces",
    "state_interfaces",
    "chainable_command_interfaces",
    "kinematics.plugin_name",
    "kinematics.plugin_package",
    "kinematics.base",
    "kinematics.tip",
    "ft_sensor.name",
    "ft_sensor.frame.id",
    "control.frame.id",
    "fixed_world_frame.frame.id",
    "gravity_compensation.frame.id",
    "gravity_compensation.CoG.pos",
)
# All parameters of the node; it ignores others silently.
PARAMETER_NAMES = frozenset(
    {*LAW, *NEEDED, "command_joints", "robot_description", "type", "use_sim_time", "is_async"}
)


@dataclass(frozen=True, slots=True)
class Axis:
    """One Cartesian axis of the law, in SI units of a translation or a rotation."""

    name: str  # Out of `AXES`
    position: Position  # Place of its mass
    selected: bool  # Whether the force acts on the axis
    # As written; the damping is ``2 damping_ratio sqrt(mass stiffness)``.
    mass: Fraction
    damping_ratio: Fraction
    stiffness: Fraction

    @property
    def rotates(self) -> bool:
        """Whether the axis is a rotation."""
        return self.name.startswith("r")


@dataclass(frozen=True, slots=True)
class AdmittanceLaw:
    """What one admittance controller computes."""

    node: RosNode  # Its parameters
    axes: tuple[Axis, ...]  # All six
    joint_damping: Fraction  # In 1/s
    filter_coefficient: Fraction  # Share of the new sample in the smoothed force, in each period
    values: Mapping[str, tuple[Fraction, ...]]  # Everything that was read, defaults filled in
    # Controller that passes the force on, and may filter or scale the force.
    force_source: str | None = None


def is_admittance(node: RosNode, kind: str | None) -> bool:
    """Tell whether a node is an admittance controller, by its type or its parameters."""
    if kind is not None:
        return kind == TYPE
    return any(name.startswith("admittance.") for name in node.values)


def read_law(node: RosNode, controllers: Collection[str] = ()) -> AdmittanceLaw:
    """Read the law of an admittance controller; a `SpecError` says why the node would not start."""
    read = {name: read_parameter(node, name) for name in LAW}
    faults = [fault for _, wrong in read.values() for fault in wrong]
    if faults := [*faults, *_too_few_joints(node)]:
        raise SpecError.combine(faults, None)
    values = {name: numbers for name, (numbers, _) in read.items()}
    keys = ("selected_axes", "mass", "damping_ratio", "stiffness")
    rows = zip(AXES, *(values[f"admittance.{key}"] for key in keys), strict=True)
    axes = tuple(
        Axis(name, node.place("admittance.mass", i), bool(selected), *numbers)
        for i, (name, selected, *numbers) in enumerate(rows)
    )
    damping, share = values["admittance.joint_damping"][0], values[FILTER][0]
    return AdmittanceLaw(node, axes, damping, share, values, _find_force_source(node, controllers))


def _too_few_joints(node: RosNode) -> Iterator[Fault]:
    """Yield a fault where fewer than six joints couple the axes.

    The controller computes all six, selected or not, and takes the pseudoinverse of the Jacobian:
    with fewer joints than axes, that couples them, and no proof of one axis by itself holds.
    """
    name = "joints"
    items = texts(node.values[name]) if name in node.values else None
    if items is not None and len(items) < len(AXES):
        count = f"{len(items)} joint" + "s" * (len(items) != 1)
        yield node.fault(
            name,
            f"{count} cannot move six axes one by one: the pseudoinverse of the Jacobian couples "
            "them, and every axis is proved by itself",
            "name at least six joints; fewer are not covered by any proof here",
        )


def _find_force_source(node: RosNode, controllers: Collection[str]) -> str | None:
    """Return the controller whose interfaces ``ft_sensor.name`` begins with."""
    items = texts(node.values["ft_sensor.name"]) if "ft_sensor.name" in node.values else None
    source = items[0].text.strip("/").partition("/")[0] if items else ""
    return source if source in controllers else None


def read_parameter(node: RosNode, name: str) -> tuple[tuple[Fraction, ...], list[Fault]]:
    """Return the values of a parameter of `LAW`, and its faults."""
    parameter, count = LAW[name], LAW[name].count
    form_text = "one value" if count == 1 else f"a list of {count} values"
    if name not in node.values and name in node.places:
        return (), [node.fault(name, f"expected {form_text}, found a map", f"write {form_text}")]
    if name not in node.values:
        if parameter.default is not None:
            return (parameter.default,), []
        names = get_close_matches(name, unknown_names(node), n=1, cutoff=0.8)
        remedy = f"write {name} for {names[0]}" if names else f"add {name}: the controller needs it"
        return (), [node.fault(name, "is missing", remedy)]
    items = texts(node.values[name])
    if items is None or len(items) != count:
        found = "something else" if items is None else f"{len(items)}"
        return (), [node.fault(name, f"expected {form_text}, found {found}", f"write {form_text}")]
    numbers, faults = [], []
    for index, item in enumerate(items):
        try:
            numbers.append(_bounded(item, parameter))
        except SpecError as error:
            item_index = index if count > 1 else None
            faults.append(node.fault(name, error.message, error.remedy or "", item_index))
    return tuple(numbers), faults


def _bounded(item: Scalar, parameter: Parameter) -> Fraction:
    value = parameter.read(item.text)
    low, high = parameter.low, parameter.high
    if (low is not None and value < low) or (high is not None and value > high):
        ends = "at least" if high is None else "between"
        bounds_text = " and ".join(f"{float(end):g}" for end in (low, high) if end is not None)
        raise SpecError(
            f"{item.text} is not {ends} {bounds_text}: the controller refuses to start",
            remedy=f"write a number {ends} {bounds_text}",
        )
    return value


def unknown_names(node: RosNode) -> list[str]:
    """Return the parameters that the controller passes over without a word."""
    return [name for name in node.values if name not in PARAMETER_NAMES]
