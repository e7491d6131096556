"""Controllers that the managers of a parameter file run, and those without a verdict."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass

from nrs_design.ros2.law import TYPE
from nrs_design.ros2.parameters import RosNode, texts
from nrs_design.spec.document import Position

MANAGER = "controller_manager"
# Types of ros2_controllers that only publish measurements, and move no robot.
SILENT = frozenset(
    {
        "battery_state_broadcaster/BatteryStateBroadcaster",
        "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster",
        "gps_sensor_broadcaster/GPSSensorBroadcaster",
        "imu_sensor_broadcaster/IMUSensorBroadcaster",
        "joint_state_broadcaster/JointStateBroadcaster",
        "magnetometer_broadcaster/MagnetometerBroadcaster",
        "pose_broadcaster/PoseBroadcaster",
        "range_sensor_broadcaster/RangeSensorBroadcaster",
        "state_interfaces_broadcaster/StateInterfacesBroadcaster",
    }
)


@dataclass(frozen=True, slots=True)
class UndecidedNode:
    """A node or controller without a verdict."""

    name: str  # Name of the node, or of the controller that a manager runs
    position: Position  # Place in the file
    reason: str  # Type, and the missing part
    silent: bool  # Whether the controller only publishes


def managers_of(node: RosNode, nodes: Collection[RosNode]) -> list[RosNode]:
    """Return the controller managers in the namespace of a node, or all."""
    managers = [n for n in nodes if n.base_name == MANAGER]
    return [n for n in managers if n.namespace == node.namespace] or managers


def kind_of(node: RosNode, nodes: Collection[RosNode]) -> str | None:
    """Return the type of a controller, as its manager or the node itself says."""
    node_types = texts(node.values["type"]) if "type" in node.values else None
    manager_type = _types(managers_of(node, nodes)).get(node.base_name)
    return manager_type or (node_types[0].text if node_types else None)


def find_undecided(
    nodes: Collection[RosNode], decided: Collection[RosNode]
) -> Iterator[UndecidedNode]:
    """Yield the possible controllers that have no verdict."""
    for node in nodes:
        if node not in decided and node.base_name != MANAGER and "*" not in node.base_name:
            kind = kind_of(node, nodes)
            reason = "nothing in this file says of which type it is"
            if kind is not None:
                reason = f"no model of a controller of type {kind} is here"
            yield UndecidedNode(node.name, node.position, reason, kind in SILENT)
    names = {node.base_name for node in nodes}
    for manager in (node for node in nodes if node.base_name == MANAGER):
        for name, kind in _types([manager]).items():
            if name in names or (kind == TYPE and "**" in names):
                continue
            reason = f"{manager.name} runs it as {kind}, and no node of this name is here"
            yield UndecidedNode(name, manager.place(f"{name}.type"), reason, kind in SILENT)


def _types(managers: Iterable[RosNode]) -> dict[str, str]:
    """Return the types of controllers, as their managers say."""
    types: dict[str, str] = {}
    for name, value in (pair for manager in managers for pair in manager.values.items()):
        items = texts(value)
        if name.endswith(".type") and items:
            types[name.removesuffix(".type")] = items[0].text
    return types
