"""The law as a model for co-simulation by FMI 2.0: one file, the same bytes each time.

Entries are stored as they are, with one date: no library of compression changes a byte.
"""

from __future__ import annotations

import io
import platform
import shutil
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from uuid import NAMESPACE_OID, uuid5

from nrs_design.controllers.operations import StepLaw
from nrs_design.errors import DesignError
from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.export import Export
from nrs_design.exporters.formats.c import header_text, source_text
from nrs_design.exporters.program import Program, program_of, start_lines
from nrs_design.exporters.record import ExportRecord
from nrs_design.exporters.text import block_comment, fill_template
from nrs_design.output import C_SOURCE, FMU
from nrs_design.pipeline.processes import run_program

FORMAT = Format(
    "the law for co-simulation by FMI 2.0, with sources, and compiled where cc is",
    SAMPLED,
    {".fmu": FMU},
    executable=True,
)
# The first entry is always the same, and so are the first bytes of the file.
_FIRST = "documentation/nrs-design.txt"
_MARK = b"nrs-design fmu\n"
# Folder of the library for 64-bit Linux on x86.
_LIBRARIES = "binaries/linux64"
_WRAPPER = "fmu.c"
_DATE = (1980, 1, 1, 0, 0, 0)
# Units in base units of SI; other units of motors have a name only.
_BASE = {
    "rad": 'rad="1"',
    "m": 'm="1"',
    "m/s": 'm="1" s="-1"',
    "N": 'kg="1" m="1" s="-2"',
    "rad/s": 'rad="1" s="-1"',
    "N*m": 'kg="1" m="2" s="-2"',
    # 2 pi / 60.
    "rpm": 'rad="1" s="-1" factor="0.10471975511965977"',
    "V": 'kg="1" m="2" s="-3" A="-1"',
    "A": 'A="1"',
}
FMU_LIMITS = (
    "Inputs arrive as doubles and are rounded to single precision once.",
    "A step from t on takes the inputs that are set at t. What it commands is for the time from t "
    "on: step this model first, hand its command over, then step the motor across the same time. "
    "A master that hands it over after the step makes the loop one sample slower than the proof "
    "says.",
    "A communication step is a whole number of sample times; others are refused. In one of many "
    "samples inputs are held, and of the commands the last one is seen alone: the loop of the "
    "proof has steps of one.",
    "A simulation shows one run. It proves nothing, and it is no part of the proof.",
)


def render(export: Export) -> dict[str, bytes]:
    """Return the file, by its ending; a `DesignError` if the compiler of this system fails."""
    return {".fmu": packed(contents(program_of(export), compiler()))}


def remarks(files: Mapping[str, bytes]) -> tuple[str, ...]:
    """Say what a rendered file lacks."""
    with zipfile.ZipFile(io.BytesIO(files[".fmu"])) as archive:
        if any(name.startswith("binaries/") for name in archive.namelist()):
            return ()
    return (
        "the FMU holds sources only: there is no compiler cc for 64-bit Linux on x86 here; an "
        "importer that compiles sources takes it",
    )


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable that is a real number."""

    # Name and number in the description.
    name: str
    reference: int
    # Member of the model in C.
    place: str
    # "input", "output" or "local".
    causality: str
    unit: str
    meaning: str


def variables_of(law: StepLaw) -> tuple[Variable, ...]:
    """Return all real variables of a law by their numbers: inputs, then outputs, then states."""
    computed = "what the step computed; 0 where it was not valid"
    rows = [(v.name, f"in.{v.name}", "input", v.unit, v.meaning) for v in law.inputs]
    rows += [(name, f"out.{name}", "output", law.units[name], computed) for name in law.outputs]
    rows += [(f"state.{v.name}", f"state.{v.name}", "local", v.unit, v.meaning) for v in law.states]
    return tuple(
        Variable(name, number, *attributes) for number, (name, *attributes) in enumerate(rows)
    )


def contents(program: Program, compiler: str | None) -> dict[str, bytes]:
    """Return every entry by its path; without a compiler, for sources alone."""
    names = program.names
    code = {
        f"{names.spec}.h": header_text(program),
        f"{names.spec}.c": source_text(program),
        _WRAPPER: wrapper_text(program),
    }
    entries = {_FIRST: _MARK, "documentation/index.html": b""}
    entries["modelDescription.xml"] = description(program).encode()
    entries |= {f"sources/{name}": text.encode() for name, text in code.items()}
    binary = "compiled: nothing, only sources"
    if compiler is not None:
        library = f"{_LIBRARIES}/{names.lower}.so"
        entries[library] = shared_library(compiler, code)
        binary = (
            f"compiled for 64-bit Linux on x86: {library}, by the C compiler of who exported it"
        )
    entries["documentation/index.html"] = _page(program, binary).encode()
    return entries


def _period(record: ExportRecord) -> str:
    """Return the sample time in s, as a decimal that reads back as the same double."""
    assert record.sample_time is not None
    return repr(float(Fraction(record.sample_time.exact)))


def guid_of(record: ExportRecord) -> str:
    """Return the identifier of spec, proof and sample time."""
    certificate = "none" if record.proof is None else record.proof.certificate_id
    period = "none" if record.sample_time is None else record.sample_time.exact
    text = f"nrs-design {record.spec.sha256} {certificate} {period}"
    return f"{{{uuid5(NAMESPACE_OID, text)}}}"


def packed(entries: Mapping[str, bytes]) -> bytes:
    """Pack entries into an archive, the same bytes each time."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, content in entries.items():
            info = zipfile.ZipInfo(name, _DATE)
            # The default differs between operating systems.
            info.create_system = 3
            info.external_attr = 0o644 << 16
            archive.writestr(info, content)
    return file.getvalue()


def wrapper_text(program: Program) -> str:
    """Return the C around a law; numbers are rounded where the law takes them."""
    header = (*program.description, "It makes a model by FMI 2.0 of the law.")
    return fill_template(
        f"{_WRAPPER}.j2",
        comment=block_comment(header, C_SOURCE),
        names=program.names,
        law=program.law,
        variables=variables_of(program.law),
        guid=guid_of(program.record),
        period=_period(program.record),
    )


def description(program: Program) -> str:
    """Return what the model says of itself, as XML."""
    record, law, variables = program.record, program.law, variables_of(program.law)
    modes = ", ".join(f"{k} {mode}" for k, mode in enumerate(law.modes))
    # Outputs by their places: the mode comes first, and whether a step is valid last.
    places = [v.reference + 2 for v in variables if v.causality == "output"]
    period = _period(record)
    return fill_template(
        "modelDescription.xml.j2",
        names=program.names,
        law=law,
        guid=guid_of(record),
        summary=f"{record.verdict.upper()}: the law of {record.spec.name}, every {period} s",
        tool=f"nrs-design {record.package.version}",
        units={v.unit: _BASE.get(v.unit, "") for v in variables},
        period=period,
        modes=f"controller in force: {modes}",
        variables=variables,
        places=[*places, len(variables) + 2],
    )


def _page(program: Program, binary: str) -> str:
    """Return the documentation as HTML; `binary` describes the compiled part."""
    proof, modes = program.record.proof, program.law.modes
    sections = (
        ("What this is", (*program.description, binary)),
        ("Outside the proof, in this format", FMU_LIMITS),
        ("How to start it", tuple(start_lines(program.law))),
        ("Taken for granted by the proof", () if proof is None else proof.assumptions),
        ("Modes", tuple(f"{k}: {mode}" for k, mode in enumerate(modes))),
    )
    return fill_template("fmu.html.j2", names=program.names, sections=sections)


# No path, time or random name gets into the library.
FLAGS = (
    *("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-fvisibility=hidden", "-shared", "-s"),
    *("-Wl,--build-id=none", "-frandom-seed=nrs-design"),
)


def compiler() -> str | None:
    """Return the compiler for 64-bit Linux on an x86 processor, if this system is and has one."""
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        return None
    return shutil.which("cc")


def shared_library(compiler: str, sources: Mapping[str, str]) -> bytes:
    """Compile sources, by their names, with a compiler that takes the flags of GCC."""
    with TemporaryDirectory(prefix="nrs-design-") as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text, encoding="ascii")
        files = [name for name in sources if name.endswith(".c")]
        compilation = run_program(compiler, [*FLAGS, "-o", "library.so", *files], folder)
        if compilation.returncode:
            raise DesignError(
                f"{compiler} does not compile the law: {compilation.stderr.strip()[:500]}",
                remedy="repair the compiler; without one, sources alone are written",
            )
        return (Path(folder) / "library.so").read_bytes()
