"""The peaks of a run that a scenario may limit: name, metric and unit."""

from __future__ import annotations

from collections.abc import Mapping

# Limited quantity to metric of `nrs_design.simulation.summary`.
PEAKS: Mapping[str, str] = {
    "torque": "peak_torque",
    "deflection": "peak_depth",
    "velocity": "peak_velocity",
}
UNITS: Mapping[str, str] = {"torque": "N*m", "deflection": "rad", "velocity": "rad/s"}
