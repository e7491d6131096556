"""Whether a deployed co-simulation model is that of a certificate: numbers, code, and variables."""

from __future__ import annotations

import io
import re
import struct
import zipfile
from collections.abc import Iterator, Mapping

from nrs_design.exporters.compiled import compiler
from nrs_design.exporters.cosimulation import (
    FIRST,
    FMI2,
    FMI3,
    Interface,
    contents,
    library_of,
)
from nrs_design.exporters.deployed_c import code_differences
from nrs_design.exporters.export import Export
from nrs_design.exporters.program import Program, program_of

_MOST_ENTRIES = 16
# Bytes of the format ZIP: for each entry twice, beside name and content, and once at the end.
_OF_AN_ENTRY, _OF_THE_END = 30 + 46, 22
# It names the release that wrote the file.
_RELEASE = re.compile(r'generationTool="[^"]*"')


def model_differences(content: bytes, export: Export) -> Iterator[str]:
    """Yield in what a model differs; its documentation is not compared.

    What a simulator runs is the library, if there is one: it must be, byte for byte, what the
    compiler of this system makes of the sources.

    Parameters
    ----------
    content : bytes
        Of the file, no longer than an export is.
    export : Export
        What is exported with the certificate.
    """
    program, entries = program_of(export), _entries(content)
    if entries is None:
        yield "it is no archive that was exported"
        return
    interface = FMI3 if entries.get(FIRST) == FMI3.mark else FMI2
    wanted, library = contents(program, interface, None), library_of(program, interface)
    for name in entries.keys() - wanted.keys() - {library}:
        yield f"{name[:80]} is not in an export"
    if library in entries:
        yield from _library_differences(program, interface, entries[library])
    for name, exported in wanted.items():
        found = entries.get(name)
        if found is None:
            yield f"{name} is missing"
        elif name.endswith((".h", ".c")):
            yield from _in(name, code_differences(_text(found), exported.decode()))
        elif name.endswith(".xml"):
            yield from _in(name, _description_differences(_text(found), exported.decode()))


def _entries(content: bytes) -> Mapping[str, bytes] | None:
    """Return the entries of an archive by path; None if no export is like that."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            listed = archive.infolist()
            # Whatever else there is could be another archive to another reader.
            said = sum(2 * len(info.filename) + info.file_size for info in listed)
            if (
                len(listed) > _MOST_ENTRIES
                or len({info.filename for info in listed}) < len(listed)
                or any(info.compress_type != zipfile.ZIP_STORED for info in listed)
                or len(content) != said + len(listed) * _OF_AN_ENTRY + _OF_THE_END
            ):
                return None
            return {info.filename: archive.read(info) for info in listed}
    except (zipfile.BadZipFile, struct.error, ValueError, OSError, RuntimeError, EOFError):
        return None


def _library_differences(program: Program, interface: Interface, found: bytes) -> Iterator[str]:
    compile_with, name = compiler(), library_of(program, interface)
    if compile_with is None:
        yield f"{name}: there is no compiler cc for 64-bit Linux on x86 here to compare it with"
    elif found != contents(program, interface, compile_with)[name]:
        yield (
            f"{name} is not what {compile_with} makes of the sources here: it is of another "
            "compiler, or of other code (export it here, or take the library out)"
        )


def _text(content: bytes) -> str:
    # What is no ASCII is no export either; it is found as a character that none has.
    return content.decode("ascii", errors="backslashreplace").replace("\r\n", "\n")


def _in(name: str, differences: Iterator[str]) -> Iterator[str]:
    yield from (f"{name}: {difference}" for difference in differences)


def _description_differences(found: str, exported: str) -> Iterator[str]:
    """Compare line by line; the release may differ."""
    lines, wanted = (_RELEASE.sub("", text, count=1).splitlines() for text in (found, exported))
    if len(lines) != len(wanted):
        yield f"it has {len(lines)} lines, and the export has {len(wanted)}"
    for one, other in zip(lines, wanted, strict=False):
        if one != other:
            yield f"it has {one.strip()[:300]}, and the export has {other.strip()[:300]}"
