"""Measured records: files with columns that are named by quantity and unit, checked before use."""

from nrs_design.identification.datasets.records import (
    ActuatorRecord,
    FrequencyResponse,
    SignalRecord,
    TissueRecord,
    read_actuator,
    read_signals,
    read_tissue,
)
from nrs_design.identification.tables.table import Source

__all__ = [
    "ActuatorRecord",
    "FrequencyResponse",
    "SignalRecord",
    "Source",
    "TissueRecord",
    "read_actuator",
    "read_signals",
    "read_tissue",
]
