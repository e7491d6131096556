"""Whether what was deployed is what is exported with a certificate: files, or a folder of them.

Code is compared token by token, in its order: numbers, types, fields, operations, cases of a test.
Tables, tests in Python and files of CMake are compared line by line, an export record field by
field, a model for co-simulation by what it holds. Comments say nothing and are not compared.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import MappingProxyType

from nrs_design.certificates.certificate import Certificate
from nrs_design.controllers.gains import design_from_gains
from nrs_design.errors import NrsDesignError
from nrs_design.exporters import format_names, format_of, rendered
from nrs_design.exporters.build import build_record
from nrs_design.exporters.deployed_c import code_differences, line_differences
from nrs_design.exporters.deployed_model import model_differences
from nrs_design.exporters.deployed_record import record_differences
from nrs_design.exporters.export import Export
from nrs_design.exporters.record import ExportRecord
from nrs_design.files import open_regular, read_json_text, unique_keys
from nrs_design.spec import InteractionDesignSpec

LARGEST_BYTES = 2**22
# How the record of a build ends, which stands beside what was built.
BINARY_RECORD = ".binary.json"


@dataclass(frozen=True, slots=True)
class DeployedFiles:
    """What of a deployed file or folder was compared, and what was found."""

    compared: tuple[Path, ...]
    differences: tuple[str, ...]  # Each begins with the name of its file
    # Files beside them that nothing was compared with.
    others: tuple[Path, ...]

    @property
    def left_out(self) -> str:
        """What was not compared, in words."""
        what = ["comments", "how it is compiled"]
        if any(file.suffix == ".json" for file in self.compared):
            what.append("the release that wrote it")
        if any(file.suffix == ".fmu" for file in self.compared):
            what.append("the documentation of the model")
        return ", ".join([*what, *(file.name for file in self.others)])


def compare_deployed(
    place: Path, spec: InteractionDesignSpec, certificate: Certificate
) -> DeployedFiles:
    """Compare a deployed file, or every exported file in a folder, with a certificate.

    Parameters
    ----------
    place : Path
        A file, or a folder that holds at least header and source of the law.
    spec : InteractionDesignSpec
        That of the certificate.
    certificate : Certificate
        Accepted, and about this spec.

    Raises
    ------
    NrsDesignError
        If a file cannot be read, or is none that is compared, or the certificate says nothing about
        it.
    """
    if not place.is_dir():
        return DeployedFiles((place,), tuple(find_differences(place, spec, certificate)), ())
    files = sorted(path for path in place.iterdir() if path.is_file())
    known = {file: end for end in _ways() if (file := place / f"{spec.name}{end}") in files}
    exports = _Exports(spec, certificate)
    told = [f"{file.name}: {each}" for file in known for each in exports.differences(file)]
    told += [f"{spec.name}{end}: it is missing" for end in _missing({*known.values()})]
    # The certificate is read, and a record of a build is what is about to be written.
    aside = {f"{spec.name}.cert.json", f"{spec.name}{BINARY_RECORD}"}
    others = (file for file in files if file not in known and file.name not in aside)
    return DeployedFiles((*known,), (*told,), (*others,))


def _missing(there: set[str]) -> list[str]:
    """Return the endings of files that belong to those that are there, and of the law itself."""
    wanted = {".h", ".c"}
    for pair in (("_test.h", "_test.c"), ("_monitor.h", "_monitor.c")):
        wanted |= {*pair} if there & {*pair} else set()
    return sorted(wanted - there)


def find_differences(
    file: Path, spec: InteractionDesignSpec, certificate: Certificate
) -> list[str]:
    """Return in what a deployed file differs from a certificate; nothing if in nothing.

    Parameters
    ----------
    file : Path
        An export; which one, its name says by its ending, such as ``_monitor.h``.
    spec : InteractionDesignSpec
        That of the certificate.
    certificate : Certificate
        Accepted, and about this spec.

    Raises
    ------
    NrsDesignError
        If the file cannot be read as one of these, or the certificate says nothing about it.
    """
    return _Exports(spec, certificate).differences(file)


@dataclass(frozen=True, slots=True)
class _Exports:
    """What is exported with a certificate, each format made once."""

    spec: InteractionDesignSpec
    certificate: Certificate
    made: dict[str, Mapping[str, bytes]] = field(default_factory=dict)

    def differences(self, file: Path) -> list[str]:
        """Return in what a file differs from its export."""
        ending = max((end for end in _ways() if file.name.endswith(end)), key=len, default=None)
        if ending is None and file.suffix != ".json":
            raise _something_else(file)
        if ending in (None, ".export.json"):
            proved = _record(self.spec, self.certificate)
            return [*record_differences(_text(file), proved, file)]
        format_, differences = _ways()[ending]
        export = _exported(self.spec, self.certificate, file)
        if ending.endswith(".fmu"):
            return [*model_differences(_read(file), export)]
        if format_ not in self.made:
            self.made[format_] = rendered(format_, export)
        return [*differences(_text(file), self.made[format_][ending].decode())]


def _vector_differences(text: str, wanted: str) -> Iterator[str]:
    """Compare a document of vectors; the lines that every file says of itself name the release."""
    try:
        found = json.loads(read_json_text(text.encode()), object_pairs_hook=unique_keys)
    except (ValueError, RecursionError):
        yield "it is no document of JSON"
        return
    exported = json.loads(wanted)
    if not isinstance(found, dict):
        found = {}
    for name in sorted((found.keys() | exported.keys()) - {"about"}):
        if json.dumps(found.get(name)) != json.dumps(exported.get(name)):
            yield f"its field {name!r} is not what the export has"


# How the text of a file is compared, by its suffix; a model has a way of its own.
_BY_SUFFIX: Mapping[str, Callable[[str, str], Iterator[str]]] = MappingProxyType(
    {
        **dict.fromkeys((".h", ".c"), code_differences),
        **dict.fromkeys((".cmake", ".csv", ".py", ".fmu"), line_differences),
        ".json": _vector_differences,
    }
)


@cache
def _ways() -> Mapping[str, tuple[str, Callable[[str, str], Iterator[str]]]]:
    """Return the format of each file that is compared, by its ending, and how that is done."""
    endings = ((end, name) for name in format_names() for end in format_of(name).files)
    return {
        end: (name, _BY_SUFFIX[suffix])
        for end, name in endings
        if "/" not in end and (suffix := Path(f"law{end}").suffix) in _BY_SUFFIX
    }


def _something_else(file: Path) -> NrsDesignError:
    return NrsDesignError(
        "is none of the files that are compared",
        path=file,
        remedy="name the folder, or a file of `export --format c`, `cmake`, `vectors`, `monitor`, "
        "`fmu` or `json`, under its name",
    )


def _exported(spec: InteractionDesignSpec, certificate: Certificate, file: Path) -> Export:
    """Return what is exported with a certificate of a sampled loop."""
    if certificate.system.sample_time is None:
        raise NrsDesignError(
            "holds a law in steps, and the certificate is about continuous time",
            path=file,
            remedy="name a certificate of a spec with `sampling`",
        )
    if certificate.system.clock is not None and certificate.system.clock.is_round:
        raise NrsDesignError(
            "holds a law of one period, and the certificate is about two",
            path=file,
            remedy="name a certificate of a spec without `outer_period`",
        )
    record, design = _record(spec, certificate), design_from_gains(spec, certificate.gains)
    return Export("proved", record, certificate, design=design, spec=spec)


def _record(spec: InteractionDesignSpec, certificate: Certificate) -> ExportRecord:
    design = design_from_gains(spec, certificate.gains)
    return build_record(design, certificate, spec)


def _read(file: Path) -> bytes:
    try:
        with open_regular(file) as stream:
            content = stream.read(LARGEST_BYTES + 1)
    except OSError as error:
        raise NrsDesignError(f"cannot be read ({error.strerror})", path=file) from error
    if len(content) > LARGEST_BYTES:
        raise NrsDesignError("is larger than any export", path=file, remedy="export it again")
    return content


def _text(file: Path) -> str:
    try:
        return _read(file).decode("ascii" if file.suffix in (".h", ".c") else "utf-8")
    except UnicodeDecodeError as error:
        raise NrsDesignError(
            "is not the text that was exported", path=file, remedy="export it again"
        ) from error
