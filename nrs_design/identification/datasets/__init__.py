"""Measured records: CSV files with named, unit-suffixed columns, checked before use."""

from nrs_design.identification.datasets.records import (
    FrequencyResponse,
    SinusoidRecord,
    TissueRecord,
    read_actuator,
    read_tissue,
)
from nrs_design.identification.datasets.table import Source

__all__ = [
    "FrequencyResponse",
    "SinusoidRecord",
    "Source",
    "TissueRecord",
    "read_actuator",
    "read_tissue",
]
