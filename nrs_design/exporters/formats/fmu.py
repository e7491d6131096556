"""The law as a co-simulation model for other simulators: one file by FMI 2.0."""

from __future__ import annotations

from collections.abc import Mapping

from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.cosimulation import fmu_of, what_it_lacks
from nrs_design.exporters.export import Export
from nrs_design.output import FMU

FORMAT = Format(
    "the law for co-simulation by FMI 2.0, with sources, and compiled where cc is",
    SAMPLED,
    {".fmu": FMU},
    executable=True,
)


def render(export: Export) -> dict[str, bytes]:
    """Return the file, by its ending."""
    return {".fmu": fmu_of(export)}


def remarks(files: Mapping[str, bytes]) -> tuple[str, ...]:
    """Say what a rendered file lacks."""
    return what_it_lacks(files[".fmu"])
