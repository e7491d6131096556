"""Whether a deployed co-simulation model is that of a certificate: numbers, code, and variables."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator, Mapping
from xml.etree import ElementTree

from nrs_design.exporters.compiled import compiler
from nrs_design.exporters.deployed_c import code_differences
from nrs_design.exporters.export import Export
from nrs_design.exporters.fmu import contents, library_of
from nrs_design.exporters.program import Program, program_of

# No export holds more.
LARGEST_ENTRY, MOST_ENTRIES = 2**22, 16
_XML = b'<?xml version="1.0" encoding="UTF-8"?>'
# It names the release that wrote the file.
_RELEASE = "generationTool"


def model_differences(content: bytes, export: Export) -> Iterator[str]:
    """Yield in what a model differs; its documentation is not compared.

    What a simulator runs is the library, if there is one: it must be, byte for byte, what the
    compiler of this system makes of the sources.

    Parameters
    ----------
    content : bytes
        Of the file.
    export : Export
        What is exported with the certificate.
    """
    program = program_of(export)
    wanted = contents(program, None)
    library = library_of(program)
    entries = _entries(content)
    if entries is None:
        yield "it is no archive that was exported"
        return
    for name in entries.keys() - wanted.keys() - {library}:
        yield f"{name[:80]} is not in an export"
    if library in entries:
        yield from _library_differences(program, entries[library])
    for name, exported in wanted.items():
        found = entries.get(name)
        if found is None:
            yield f"{name} is missing"
        elif name.endswith((".h", ".c")):
            yield from _in(name, code_differences(_text(found), exported.decode()))
        elif name.endswith(".xml"):
            yield from _in(name, _description_differences(found, exported))


def _library_differences(program: Program, found: bytes) -> Iterator[str]:
    compile_with, name = compiler(), library_of(program)
    if compile_with is None:
        yield f"{name}: there is no compiler cc for 64-bit Linux on x86 here to compare it with"
    elif found != contents(program, compile_with)[name]:
        yield (
            f"{name} is not what {compile_with} makes of the sources here: it is of another "
            "compiler, or of other code (export it here, or take the library out)"
        )


def _entries(content: bytes) -> Mapping[str, bytes] | None:
    """Return what an archive holds, by path; None if no export is like that."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            listed = archive.infolist()
            plain = len(listed) <= MOST_ENTRIES and all(
                info.compress_type == zipfile.ZIP_STORED and info.file_size <= LARGEST_ENTRY
                for info in listed
            )
            if not plain or len({info.filename for info in listed}) < len(listed):
                return None
            return {info.filename: archive.read(info) for info in listed}
    except (zipfile.BadZipFile, ValueError, NotImplementedError, RuntimeError, OSError):
        return None


def _text(content: bytes) -> str:
    # What is no ASCII is no export either; it is found as a character that none has.
    return content.decode("ascii", errors="backslashreplace").replace("\r\n", "\n")


def _in(name: str, differences: Iterator[str]) -> Iterator[str]:
    yield from (f"{name}: {difference}" for difference in differences)


def _description_differences(content: bytes, wanted: bytes) -> Iterator[str]:
    """Compare elements with their attributes; that of the release may differ."""
    # A document with definitions of its own could grow without bound.
    if b"<!" in content or not content.startswith(_XML):
        yield "it begins otherwise than an export, or has definitions of its own"
        return
    try:
        found = [*_elements(content)]
    except ElementTree.ParseError:
        yield "it is no XML"
        return
    exported = [*_elements(wanted)]
    if len(found) != len(exported):
        yield f"it has {len(found)} elements, and the export has {len(exported)}"
    for one, other in zip(found, exported, strict=False):
        if one != other:
            yield f"it has {_said(one)}, and the export has {_said(other)}"


Element = tuple[str, tuple[tuple[str, str], ...], str]


def _elements(content: bytes) -> Iterator[Element]:
    for element in ElementTree.fromstring(content).iter():
        attributes = {k: v for k, v in element.attrib.items() if k != _RELEASE}
        yield element.tag, tuple(sorted(attributes.items())), (element.text or "").strip()


def _said(element: Element) -> str:
    tag, attributes, text = element
    return f"<{' '.join([tag, *(f'{k}={v!r}' for k, v in attributes)])}>{text}"[:300]
