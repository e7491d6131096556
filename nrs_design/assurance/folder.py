"""The folder of a case on disk: it is read whole, and written whole or not at all."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from nrs_design.assurance.contents import FACTS, SCHEMA, SUMS
from nrs_design.assurance.sources import read_file
from nrs_design.errors import CertificateError, NrsDesignError, OutputError
from nrs_design.files import read_json_text, unique_keys
from nrs_design.output import check_place, write_outputs
from nrs_design.proof.text import quoted

# Far more than any evidence has.
MAX_FILES, MAX_BYTES = 1000, 2**28
_LINE = re.compile(r"([0-9a-f]{64})  ([^\s/][^\n]*)")
_ELSEWHERE = "choose another --out, or remove the folder"


def read_folder(folder: Path) -> dict[str, bytes]:
    """Return all files of a folder by their paths, with forward slashes, sorted.

    Raises
    ------
    CertificateError
        If it is no folder, holds a link, or far more than evidence has.
    """
    if not folder.is_dir():
        message = "is a file" if folder.exists() else "there is no such folder"
        remedy = "name a folder that `nrs-design evidence --out` has written"
        raise CertificateError(message, path=folder, remedy=remedy)
    paths, size = [], 0
    for path in _walk(folder):
        if path.is_symlink():
            remedy = "evidence holds files only: remove it"
            raise CertificateError("is a symbolic link", path=path, remedy=remedy)
        paths.append(path)
        size += path.stat().st_size
        if len(paths) > MAX_FILES or size > MAX_BYTES:
            remedy = "name the folder of one spec alone"
            raise CertificateError("holds more than evidence does", path=folder, remedy=remedy)
    return {path.relative_to(folder).as_posix(): read_file(path) for path in sorted(paths)}


def _walk(folder: Path) -> Iterator[Path]:
    for place, folders, files in os.walk(folder):
        inside = [Path(place) / name for name in (*folders, *files)]
        yield from (path for path in inside if path.is_symlink() or not path.is_dir())


def hash_faults(files: Mapping[str, bytes]) -> tuple[str, ...]:
    """Return what is changed, missing or added, by the hashes that the folder lists.

    Parameters
    ----------
    files : mapping of str to bytes
        As `read_folder` returns them.
    """
    if SUMS not in files:
        return (f"{SUMS} is missing",)
    lines = files[SUMS].decode(errors="replace").splitlines()
    found = [_LINE.fullmatch(line) for line in lines]
    if not all(found):
        return (f"{SUMS} has a line that is no hash and name",)
    listed = {match[2]: match[1] for match in found if match is not None}
    if len(listed) < len(lines):
        return (f"{SUMS} names a file twice",)
    return tuple(_differences(files, listed))


def _differences(files: Mapping[str, bytes], listed: Mapping[str, str]) -> Iterator[str]:
    for path in sorted(listed.keys() - files.keys()):
        yield f"{quoted(path)} is missing"
    for path in sorted(files.keys() - listed.keys() - {SUMS}):
        yield f"{quoted(path)} was added"
    for path in sorted(listed.keys() & files.keys()):
        if hashlib.sha256(files[path]).hexdigest() != listed[path]:
            yield f"{quoted(path)} was changed"


def read_facts(files: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts that a folder states, none of them checked.

    Raises
    ------
    CertificateError
        If there are none of this format.
    """
    remedy = "make it again with `nrs-design evidence SPEC --out FOLDER`"
    try:
        text = read_json_text(files[FACTS])
        facts = json.loads(text, object_pairs_hook=unique_keys)
        if facts["schema"] != SCHEMA:
            raise ValueError("another schema")
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        message = f"{FACTS} is missing, or not of the format {SCHEMA}"
        raise CertificateError(message, remedy=remedy) from error
    return dict(facts)


def check_free(folder: Path, name: str) -> tuple[str, ...]:
    """Refuse a folder in which something would be lost; return the files to replace.

    Parameters
    ----------
    folder : Path
        It may be absent, empty, or hold evidence of the same spec that nobody has changed.
    name : str
        Of the spec.

    Raises
    ------
    OutputError
        If it holds anything else, or cannot be written to.
    """
    check_place(folder / SUMS)
    if not folder.exists():
        return ()
    try:
        files = read_folder(folder)
        owner = read_facts(files)["spec"]["name"] if files else name
        faults = hash_faults(files) if files else ()
    except (NrsDesignError, LookupError, TypeError) as error:
        message = "holds something else than evidence"
        raise OutputError(message, path=folder, remedy=_ELSEWHERE) from error
    if owner != name:
        message = f"holds evidence of the spec {quoted(str(owner))}"
        raise OutputError(message, path=folder, remedy=_ELSEWHERE)
    if faults:
        message = f"holds evidence that was changed since: {'; '.join(faults)}"
        raise OutputError(message, path=folder, remedy=_ELSEWHERE)
    return tuple(files)


def write_folder(folder: Path, name: str, contents: Mapping[str, bytes]) -> None:
    """Write all files of a case, and remove those of an earlier one that it no longer has.

    Parameters
    ----------
    folder : Path
        As `check_free` takes it.
    name : str
        Of the spec.
    contents : mapping of str to bytes
        All files by their paths.

    Raises
    ------
    OutputError
        As `check_free` raises it, or if a file cannot be written.
    """
    before = check_free(folder, name)
    write_outputs([(folder / path, content, b"") for path, content in contents.items()])
    for path in before:
        if path not in contents:
            (folder / path).unlink()
