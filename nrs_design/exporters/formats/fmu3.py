"""The law as a co-simulation model for other simulators: one file by FMI 3.0."""

from __future__ import annotations

from collections.abc import Mapping

from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.cosimulation import FMI3, fmu_of, what_it_lacks
from nrs_design.exporters.export import Export
from nrs_design.output import FMU3

FORMAT = Format(
    "the law for co-simulation by FMI 3.0, with sources, and compiled where cc is",
    SAMPLED,
    {".fmi3.fmu": FMU3},
    executable=True,
)


def render(export: Export) -> dict[str, bytes]:
    """Return the file, by its ending.

    Parameters
    ----------
    export : Export
        With a record, proved or not.

    Raises
    ------
    DesignError
        If there is no program of a controller yet, or the compiler of this system fails.
    """
    return {".fmi3.fmu": fmu_of(export, FMI3)}


def remarks(files: Mapping[str, bytes]) -> tuple[str, ...]:
    """Say what a rendered file lacks."""
    return what_it_lacks(files[".fmi3.fmu"])
