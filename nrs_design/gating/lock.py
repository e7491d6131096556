"""``nrs.lock``: which specs were examined, with which verdict and which certificate."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from nrs_design import __version__
from nrs_design.errors import CertificateError
from nrs_design.files import open_regular
from nrs_design.gating.obligations import GateOutcome, SpecOutcome
from nrs_design.output import write_output

MAX_BYTES = 64 * 2**20

Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class _Frozen(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, populate_by_name=True)


class LockedCertificate(_Frozen):
    """A certificate: its file, relative to the lock file, and its id."""

    file: str = Field(min_length=1)
    id: Sha256


class LockedSpec(_Frozen):
    """One spec: its file, relative to the lock file, the hash of its bytes, and its verdict."""

    path: str = Field(min_length=1)
    sha256: Sha256
    verdict: Literal["proved", "refuted", "inconclusive"]
    rate: str | None
    certificate: LockedCertificate | None

    @model_validator(mode="after")
    def _check_certificate(self) -> LockedSpec:
        if self.certificate is None and self.verdict != "inconclusive":
            raise ValueError("a spec that is proved or refuted has a certificate")
        if self.rate is not None and self.verdict == "inconclusive":
            raise ValueError("a spec without a verdict has no rate")
        return self


class Package(_Frozen):
    """What wrote the lock file."""

    name: Literal["nrs-design"] = "nrs-design"
    version: str = __version__


class Lock(_Frozen):
    """The whole file."""

    schema_id: Literal["nrs-design/lock/1"] = Field(default="nrs-design/lock/1", alias="schema")
    package: Package = Field(default_factory=Package)
    specs: list[LockedSpec]

    @model_validator(mode="after")
    def _check_paths(self) -> Lock:
        paths = [spec.path for spec in self.specs]
        if len(set(paths)) != len(paths):
            raise ValueError("a spec is locked twice")
        return self


def make_lock(specs: Iterable[SpecOutcome], file: Path) -> Lock:
    """Return the lock of specs, for a lock file at a place; those that can be certified have one.

    What makes no claim about switching is left out.
    """
    entries = [_entry(spec, file) for spec in specs if spec.certifiable]
    return Lock(specs=sorted(entries, key=lambda entry: entry.path))


def write_lock(outcome: GateOutcome, file: Path) -> GateOutcome:
    """Write the lock file, and note it; where a spec has no verdict, leave the file as it is.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    if any(spec.verdict is None and spec.certifiable for spec in outcome.specs):
        return outcome.with_note(f"{file} not written: not every spec has a verdict")
    write_output(file, dump_lock(make_lock(outcome.specs, file)))
    return outcome.with_note(f"{file} written")


def dump_lock(lock: Lock) -> str:
    """Return the text of the lock file: sorted, and without times."""
    document = lock.model_dump(mode="json", by_alias=True)
    return json.dumps(document, indent=2, ensure_ascii=True) + "\n"


def read_lock(file: Path) -> Lock:
    """Read a lock file.

    Raises
    ------
    CertificateError
        If it is missing or is not a lock file.
    """
    remedy = "make it with nrs-design gate, without --locked"
    try:
        document = json.loads(_read_bytes(file).decode(), object_pairs_hook=_unique)
        return Lock.model_validate(document)
    except OSError as error:
        raise CertificateError(
            f"cannot be read ({error.strerror})", path=file, remedy=remedy
        ) from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the file"
        raise CertificateError(
            f"not a lock file: {where}: {first['msg']}", path=file, remedy=remedy
        ) from error
    except (ValueError, RecursionError) as error:
        raise CertificateError(f"not a lock file: {error}", path=file, remedy=remedy) from error


def _read_bytes(file: Path) -> bytes:
    """Read a whole file, but never an endless one."""
    if file.exists() and not file.is_file():
        raise CertificateError("is not a regular file", path=file)
    with open_regular(file) as stream:
        content = stream.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise CertificateError("larger than any lock file", path=file)
    return content


def relative_to_lock(path: Path, lock: Path) -> str:
    """Return a path as it stands in a lock file, with forward slashes."""
    return Path(os.path.relpath(path, lock.parent)).as_posix()


def _entry(spec: SpecOutcome, file: Path) -> LockedSpec:
    certificate = None
    if spec.certificate is not None and spec.certificate_id is not None:
        certificate = LockedCertificate(
            file=relative_to_lock(spec.certificate, file), id=spec.certificate_id
        )
    return LockedSpec.model_validate(
        {
            "path": relative_to_lock(spec.path, file),
            "sha256": spec.sha256,
            "verdict": spec.verdict,
            "rate": spec.rate,
            "certificate": certificate,
        }
    )


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    keys = [key for key, _ in pairs]
    if len(set(keys)) != len(keys):
        raise ValueError("a key occurs twice")
    return dict(pairs)
