"""Measured records: files with columns that are named by quantity and unit, checked before use."""

from nrs_design.identification.datasets.records import (
    ActuatorRecord,
    FrequencyResponse,
    PoseRecord,
    SignalRecord,
    TissueRecord,
    read_actuator,
    read_poses,
    read_signals,
    read_tissue,
)
from nrs_design.identification.tables.table import Source

__all__ = [
    "ActuatorRecord",
    "FrequencyResponse",
    "PoseRecord",
    "SignalRecord",
    "Source",
    "TissueRecord",
    "read_actuator",
    "read_poses",
    "read_signals",
    "read_tissue",
]
