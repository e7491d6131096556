"""What a run is held against its limits by."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

# Quantities, and how `nrs_design.simulation.summary` names their largest values.
PEAKS: Mapping[str, str] = MappingProxyType(
    {"torque": "peak_torque", "deflection": "peak_depth", "velocity": "peak_velocity"}
)
UNITS: Mapping[str, str] = MappingProxyType(
    {"torque": "N*m", "deflection": "rad", "velocity": "rad/s"}
)
