"""Measured records: files with columns that are named by quantity and unit, checked before use."""

from nrs_design.identification.datasets.records import (
    ActuatorRecord,
    FrequencyResponse,
    TissueRecord,
    read_actuator,
    read_tissue,
)
from nrs_design.identification.datasets.table import Source

__all__ = [
    "ActuatorRecord",
    "FrequencyResponse",
    "Source",
    "TissueRecord",
    "read_actuator",
    "read_tissue",
]
