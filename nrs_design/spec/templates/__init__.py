"""Spec files to start from, each explained key by key."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from types import MappingProxyType

# Interaction designs of a sliding axis, by the template of the turning axis.
PRISMATIC = {
    "interaction-design": "prismatic-axis",
    "velocity-interface": "prismatic-velocity-interface",
    "position-interface": "prismatic-position-interface",
}
_SUFFIX = ".nrs.yaml"
TEMPLATES: Mapping[str, str] = MappingProxyType(
    {
        file.name.removesuffix(_SUFFIX): file.read_text(encoding="utf-8")
        for file in sorted(files(__name__).iterdir(), key=lambda file: file.name)
        if file.name.endswith(_SUFFIX)
    }
)
