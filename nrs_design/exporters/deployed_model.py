"""Whether a deployed co-simulation model is that of a certificate: numbers, code, and variables."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.exporters.compiled import compiler
from nrs_design.exporters.deployed_archive import Archive, Element, elements
from nrs_design.exporters.deployed_c import code_differences
from nrs_design.exporters.export import Export
from nrs_design.exporters.fmu import contents, library_of
from nrs_design.exporters.program import Program, program_of


def model_differences(archive: Archive | None, export: Export) -> Iterator[str]:
    """Yield in what a model differs; its documentation is not compared.

    What a simulator runs is the library, if there is one: it must be, byte for byte, what the
    compiler of this system makes of the sources.

    Parameters
    ----------
    archive : Archive or None
        What the file holds, as `nrs_design.exporters.deployed_archive.read_archive` gives it.
    export : Export
        What is exported with the certificate.
    """
    program = program_of(export)
    wanted = contents(program, None)
    if archive is None:
        yield "it is no archive that was exported"
        return
    entries, library = archive.entries, library_of(program)
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
            yield from _in(name, _description_differences(archive.documents[name], exported))


def _library_differences(program: Program, found: bytes) -> Iterator[str]:
    compile_with, name = compiler(), library_of(program)
    if compile_with is None:
        yield f"{name}: there is no compiler cc for 64-bit Linux on x86 here to compare it with"
    elif found != contents(program, compile_with)[name]:
        yield (
            f"{name} is not what {compile_with} makes of the sources here: it is of another "
            "compiler, or of other code (export it here, or take the library out)"
        )


def _text(content: bytes) -> str:
    # What is no ASCII is no export either; it is found as a character that none has.
    return content.decode("ascii", errors="backslashreplace").replace("\r\n", "\n")


def _in(name: str, differences: Iterator[str]) -> Iterator[str]:
    yield from (f"{name}: {difference}" for difference in differences)


def _description_differences(found: list[Element] | str, exported: bytes) -> Iterator[str]:
    """Compare elements with their attributes; that of the release may differ."""
    wanted = elements(exported)
    if isinstance(found, str) or isinstance(wanted, str):
        yield str(found)
        return
    if len(found) != len(wanted):
        yield f"it has {len(found)} elements, and the export has {len(wanted)}"
    for one, other in zip(found, wanted, strict=False):
        if one != other:
            yield f"it has {_said(one)}, and the export has {_said(other)}"


def _said(element: Element) -> str:
    tag, attributes, text = element
    return f"<{' '.join([tag, *(f'{k}={v!r}' for k, v in attributes)])}>{text}"[:300]
