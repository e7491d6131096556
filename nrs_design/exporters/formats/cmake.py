"""A file of CMake that builds the exported C as a library, and its self-test as a program."""

from __future__ import annotations

from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.export import Export
from nrs_design.exporters.program import program_of
from nrs_design.exporters.self_test import program_macro
from nrs_design.exporters.text import fill_template, harmless
from nrs_design.output import CMAKE

FORMAT = Format(
    "a library and a test for CMake from the files of c and monitor beside it",
    SAMPLED,
    {".cmake": CMAKE},
    executable=True,
)


def render(export: Export) -> dict[str, bytes]:
    """Return the file, by its ending."""
    program = program_of(export)
    text = fill_template(
        "law.cmake.j2",
        about="\n".join(f"# {harmless(line)}" for line in program.description),
        spec=program.names.spec,
        own=program.names.lower,
        test=program_macro(program.names),
    )
    return {".cmake": CMAKE + text.encode()}
