"""The law as a co-simulation model for other simulators: one file by FMI 2.0.

Entries are stored as they are, with one date: no library of compression changes a byte.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from fractions import Fraction
from uuid import NAMESPACE_OID, uuid5

from nrs_design.exporters.c import header_text, source_text
from nrs_design.exporters.compiled import compiler, shared_library
from nrs_design.exporters.export import Export
from nrs_design.exporters.fmu_description import description, page
from nrs_design.exporters.fmu_source import wrapper_text
from nrs_design.exporters.program import Program, program_of
from nrs_design.exporters.record import ExportRecord

# The first entry is always the same, and so are the first bytes of the file.
FIRST, MARK = "documentation/nrs-design.txt", b"nrs-design fmu\n"
_DATE = (1980, 1, 1, 0, 0, 0)
LIBRARIES = "binaries/linux64"


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
    program = program_of(export)
    return {".fmu": packed(contents(program, compiler()))}


def remarks(files: Mapping[str, bytes]) -> tuple[str, ...]:
    """Say what a rendered file lacks."""
    with zipfile.ZipFile(io.BytesIO(files[".fmu"])) as archive:
        if any(name.startswith(LIBRARIES) for name in archive.namelist()):
            return ()
    return (
        "the FMU holds sources only: there is no compiler cc for 64-bit Linux on x86 here; an "
        "importer that compiles sources takes it",
    )


def contents(program: Program, compile_with: str | None) -> dict[str, bytes]:
    """Return every entry by its path.

    Parameters
    ----------
    program : Program
        The law.
    compile_with : str or None
        A compiler; None for sources alone.
    """
    record, law, names = program.record, program.law, program.names
    assert record.sample_time is not None
    guid, period = guid_of(record), repr(float(Fraction(record.sample_time.exact)))
    sources = {
        f"{names.spec}.h": header_text(record, law, names),
        f"{names.spec}.c": source_text(record, law, names),
        "fmu.c": wrapper_text(program, guid, period),
    }
    entries = {FIRST: MARK, "documentation/index.html": b""}
    entries["modelDescription.xml"] = description(program, guid, period).encode()
    entries |= {f"sources/{name}": text.encode() for name, text in sources.items()}
    binary = "compiled: nothing, only sources"
    if compile_with is not None:
        library = library_of(program)
        entries[library] = shared_library(compile_with, sources)
        binary = (
            f"compiled for 64-bit Linux on x86: {library}, by the C compiler of who exported it"
        )
    entries["documentation/index.html"] = page(program, binary).encode()
    return entries


def library_of(program: Program) -> str:
    """Return where the compiled library of a program is, if there is one."""
    return f"{LIBRARIES}/{program.names.lower}.so"


def guid_of(record: ExportRecord) -> str:
    """Return a name that follows from the spec, the proof and the sample time, and nothing else."""
    certificate = "none" if record.proof is None else record.proof.certificate_id
    period = "none" if record.sample_time is None else record.sample_time.exact
    text = f"nrs-design {record.spec.sha256} {certificate} {period}"
    return f"{{{uuid5(NAMESPACE_OID, text)}}}"


def packed(entries: Mapping[str, bytes]) -> bytes:
    """Pack entries into an archive, the same bytes each time.

    Parameters
    ----------
    entries : mapping of str to bytes
        Contents by path, in their order.
    """
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, content in entries.items():
            info = zipfile.ZipInfo(name, _DATE)
            # As a system writes it that Python does not run on may differ.
            info.create_system = 3
            info.external_attr = 0o644 << 16
            archive.writestr(info, content)
    return file.getvalue()
