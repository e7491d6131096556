"""The record of a build, as ``verify --deployed --compile`` writes it, as far as it is quoted."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from nrs_design.assurance.sources import read_file
from nrs_design.certificates.certificate import Certificate
from nrs_design.errors import DataError

_REMEDY = "name the NAME.binary.json of a build of this design"


class _Part(BaseModel):
    # The format may get more fields.
    model_config = ConfigDict(extra="ignore", frozen=True, strict=True)


class _Spec(_Part):
    name: str
    sha256: str


class _Compiler(_Part):
    version: str
    target: str


class BuildRecord(_Part):
    """What was compiled and run, as the record says; it is not run again here."""

    schema_id: Literal["nrs-design/binary/1"] = Field(alias="schema")
    spec: _Spec
    certificate: str
    compiler: _Compiler
    compile: tuple[str, ...] = Field(strict=False)
    run: tuple[str, ...] = Field(strict=False)
    result: str
    compared: Mapping[str, str]  # SHA-256 of each source by its name
    compiled: Mapping[str, str]  # The same of objects, and of the program that ran
    not_compared: tuple[str, ...] = Field(strict=False)


@dataclass(frozen=True, slots=True)
class Build:
    """A record, and how it stands to the program of a case."""

    record: BuildRecord
    content: bytes  # The file, as it is
    others: tuple[str, ...]  # Sources of the program that the build did not take as they are

    @property
    def said(self) -> str:
        """The build in a few words."""
        by = f"run by {self.record.run[0]}" if self.record.run else "run where it was compiled"
        return f"{self.record.result}; {self.record.compiler.version}; {by}"


def read_build(path: Path, certificate: Certificate, program: Mapping[str, bytes]) -> Build:
    """Read the record of a build.

    Parameters
    ----------
    path : Path
        Of the record.
    certificate : Certificate
        That it must be about.
    program : mapping of str to bytes
        Sources of the case by name.

    Raises
    ------
    DataError
        If it is no such record, or about another spec or certificate, or there is no program.
    """
    if not program:
        message = "is about a program, and this design has none here"
        raise DataError(message, path=path, remedy="leave --build out")
    content = read_file(path)
    try:
        record = BuildRecord.model_validate_json(content)
    except ValidationError as error:
        first = error.errors()[0]
        at = ".".join(map(str, first["loc"])) or "its text"
        message = f"is no record of a build: {at}: {first['msg']}"
        raise DataError(message, path=path, remedy=_REMEDY) from error
    spec = (certificate.spec_name, certificate.spec_sha256)
    if (record.spec.name, record.spec.sha256) != spec or record.certificate != certificate.id:
        message = "is about another spec or certificate, or an earlier one"
        raise DataError(message, path=path, remedy=_REMEDY)
    return Build(record, content, tuple(_others(record, program)))


def _others(record: BuildRecord, program: Mapping[str, bytes]) -> list[str]:
    """Return the sources of the law that are not among those of the build, byte for byte."""
    law = [name for name in program if name in (f"{record.spec.name}{e}" for e in (".c", ".h"))]
    hashes = {name: hashlib.sha256(program[name]).hexdigest() for name in law}
    return [name for name in law if record.compared.get(name) != hashes[name]]
