"""Spec files to start from, each explained key by key."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from types import MappingProxyType

# An interaction design of a robot that takes velocities.
VELOCITY_INTERFACE = "velocity-interface"
_NAMES = ("interaction-design", VELOCITY_INTERFACE, "hybrid-force", "switched-system", "robot")


def _read(name: str) -> str:
    return (files(__name__) / f"{name}.nrs.yaml").read_text(encoding="utf-8")


TEMPLATES: Mapping[str, str] = MappingProxyType({name: _read(name) for name in _NAMES})
