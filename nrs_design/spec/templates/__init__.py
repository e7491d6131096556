"""Spec files to start from, each explained key by key."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from types import MappingProxyType

# Interaction designs of robots that take velocities, positions and torques.
INTERFACES = tuple(f"{taken}-interface" for taken in ("velocity", "position", "torque"))
# Those of an axis that slides, by what they are of an axis that turns.
PRISMATIC = {
    "interaction-design": "prismatic-axis",
    "velocity-interface": "prismatic-velocity-interface",
    "position-interface": "prismatic-position-interface",
}
# Several axes in one file.
TASK_SPACE = "task-space"
_NAMES = (
    "interaction-design",
    *INTERFACES,
    *PRISMATIC.values(),
    "hybrid-force",
    TASK_SPACE,
    "switched-system",
    "robot",
)


def _read(name: str) -> str:
    return (files(__name__) / f"{name}.nrs.yaml").read_text(encoding="utf-8")


TEMPLATES: Mapping[str, str] = MappingProxyType({name: _read(name) for name in _NAMES})
