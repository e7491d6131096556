"""The law as a co-simulation model for other simulators: one file by FMI 2.0."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from zipfile import ZipFile

from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.compiled import compiler
from nrs_design.exporters.cosimulation import contents, packed
from nrs_design.exporters.export import Export
from nrs_design.exporters.program import program_of
from nrs_design.output import FMU

FORMAT = Format(
    "the law for co-simulation by FMI 2.0, with sources, and compiled where cc is",
    SAMPLED,
    {".fmu": FMU},
    executable=True,
)


def render(export: Export) -> dict[str, bytes]:
    """Return the file, by its ending; a `DesignError` if the compiler of this system fails."""
    return {".fmu": packed(contents(program_of(export), compiler()))}


def remarks(files: Mapping[str, bytes]) -> tuple[str, ...]:
    """Say what a rendered file lacks."""
    with ZipFile(BytesIO(files[".fmu"])) as archive:
        if any(name.startswith("binaries/") for name in archive.namelist()):
            return ()
    return (
        "the FMU holds sources only: there is no compiler cc for 64-bit Linux on x86 here; an "
        "importer that compiles sources takes it",
    )
