"""``nrs.lock``: examined specs, and the status of each obligation that needs a design."""

from __future__ import annotations

import json
import os
import posixpath
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    model_serializer,
    model_validator,
)

from nrs_design.errors import CertificateError
from nrs_design.files import open_regular, read_json_text, unique_keys
from nrs_design.gating import rules

if TYPE_CHECKING:
    from pydantic import SerializerFunctionWrapHandler

SCHEMA: Literal["nrs-design/lock/2"] = "nrs-design/lock/2"
MAX_BYTES = 32 * 2**20
MAX_SPECS = 10_000
# Rules that --locked decides again; the status of every other obligation is locked.
DECIDED_AGAIN = frozenset(
    {
        rules.SPEC,
        rules.MODE_STABLE,
        rules.SWITCHING_STABLE,
        rules.CERTIFIED_GOAL,
        rules.CERTIFICATE_HOLDS,
        rules.LOCKED,
        rules.NOT_DOUBTED,
        rules.NOT_WEAKER,
    }
)


def _check_path(text: str) -> str:
    absolute = posixpath.isabs(text) or os.path.isabs(text) or os.path.splitdrive(text)[0]
    if absolute or "\0" in text or text != posixpath.normpath(text):
        raise ValueError("a path must be relative to the lock file and in its shortest form")
    return text


def _check_below(text: str) -> str:
    if text.partition("/")[0] == "..":
        raise ValueError("a certificate must be below the folder of the lock file")
    return text


Sha256 = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
RelativePath = Annotated[str, Field(max_length=4096), AfterValidator(_check_path)]
PathBelow = Annotated[RelativePath, AfterValidator(_check_below)]


class _Frozen(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, populate_by_name=True)


class LockedCertificate(_Frozen):
    """A certificate: its file, relative to the lock file and below it, and its id."""

    file: PathBelow
    id: Sha256


class LockedGoal(_Frozen):
    """An obligation that only a design can decide, such as a design goal: how it ended."""

    rule: str
    subject: str
    # An exact check proves or refutes, and is made again; see `Status`.
    status: Literal["met", "inconclusive", "missed", "error"]
    message: str

    @model_validator(mode="after")
    def _check_rule(self) -> LockedGoal:
        if self.rule not in rules.RULES or rules.RULES[self.rule] in DECIDED_AGAIN:
            raise ValueError("this rule is not one that is locked")
        return self


class LockedRemark(_Frozen):
    """The worst remark on a design, which its runs and margins alone decide."""

    message: str
    at: list[str]  # Keys that lead to its place in the spec
    # Three digits of `Caution.beyond`: further digits differ between processors.
    beyond: float = Field(gt=0, allow_inf_nan=False)


class LockedSpec(_Frozen):
    """One spec: its file, relative to the lock file, the hash of what it says, and what was found.

    ``version`` is that of the nrs-design which designed the gains.
    """

    path: RelativePath
    sha256: Sha256
    version: str
    verdict: Literal["proved", "refuted", "inconclusive"]
    rate: str | None
    certificate: LockedCertificate | None
    gains: dict[str, dict[str, str]]
    goals: list[LockedGoal]
    remark: LockedRemark | None = None

    @model_serializer(mode="wrap")
    def _leave_out_what_is_empty(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        document: dict[str, Any] = dump(self)
        return {key: value for key, value in document.items() if value or key != "remark"}

    @model_validator(mode="after")
    def _check_certificate(self) -> LockedSpec:
        if self.certificate is None and self.verdict != "inconclusive":
            raise ValueError("a spec that is proved or refuted has a certificate")
        if self.rate is not None and self.verdict == "inconclusive":
            raise ValueError("a spec without a verdict has no rate")
        return self


class Lock(_Frozen):
    """The whole file."""

    schema_id: Literal["nrs-design/lock/2"] = Field(default=SCHEMA, alias="schema")
    specs: Annotated[list[LockedSpec], Field(max_length=MAX_SPECS)]

    @model_validator(mode="after")
    def _check_paths(self) -> Lock:
        paths = [spec.path for spec in self.specs]
        if len(set(paths)) != len(paths):
            raise ValueError("a spec is locked twice")
        files = [spec.certificate.file for spec in self.specs if spec.certificate is not None]
        if len(set(files)) != len(files):
            raise ValueError("two specs have the same certificate file")
        return self


def dump_lock(lock: Lock) -> str:
    """Return the text of the lock file: sorted, and without times."""
    document = lock.model_dump(mode="json", by_alias=True)
    return json.dumps(document, indent=2, ensure_ascii=True) + "\n"


def read_lock_if_any(file: Path) -> Lock:
    """Read a lock file; an empty lock if there is none."""
    return read_lock(file) if os.path.lexists(file) else Lock(specs=[])


def read_lock(file: Path) -> Lock:
    """Read a lock file; a missing, foreign or oversized one is a `CertificateError`."""
    remedy = "take it as it was committed, or make it anew with nrs-design gate over all specs"
    refused = partial(CertificateError, path=file, remedy=remedy)
    try:
        with open_regular(file) as stream:
            content = stream.read(MAX_BYTES + 1)
        if len(content) > MAX_BYTES:
            raise ValueError(f"it is larger than {MAX_BYTES >> 20} MiB")
        document = json.loads(read_json_text(content), object_pairs_hook=unique_keys)
        return Lock.model_validate(document)
    except OSError as error:
        raise refused(f"cannot be read ({error.strerror})") from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the file"
        message = first["msg"].removeprefix("Value error, ")
        raise refused(f"not a lock file: {place}: {message}") from error
    except (ValueError, RecursionError) as error:
        raise refused(f"not a lock file: {error}") from error


def relative_to_lock(path: Path, lock: Path) -> str:
    """Return a path relative to a lock file, with forward slashes."""
    return Path(os.path.relpath(path, lock.parent)).as_posix()
