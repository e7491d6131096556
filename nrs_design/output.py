"""Atomic writing of results, without overwriting foreign files."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from errno import EACCES, ENOTDIR
from pathlib import Path

from nrs_design.errors import OutputError
from nrs_design.files import is_device_name

# First bytes of our files, which new files of the same kind may replace.
CERTIFICATE = b'{\n  "schema": "nrs-design/certificate/'
EXPORT = b'{\n  "schema": "nrs-design/export/'
MAT = b"MATLAB 5.0 MAT-file, nrs-design export of "
C_HEADER, C_SOURCE = b"/* nrs-design C header\n", b"/* nrs-design C source\n"
C_TEST, C_TEST_HEADER = b"/* nrs-design C test\n", b"/* nrs-design C header of a test\n"
C_MONITOR = b"/* nrs-design C monitor\n"
C_MONITOR_HEADER = b"/* nrs-design C header of a monitor\n"
CMAKE = b"# nrs-design CMake file\n"
# The first archive entry: constant and without compression.
FMU = (
    b"PK\x03\x04\x14\x00\x00\x00\x00\x00\x00\x00!\x00\x8f*\x87r\x0f\x00\x00\x00\x0f\x00\x00\x00"
    b"\x1c\x00\x00\x00documentation/nrs-design.txtnrs-design fmu\n"
)
LOCK = b'{\n  "schema": "nrs-design/lock/'
PAGE = b'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta name="generator" content="nrs-design">\n'
SCHEMA = (
    b'{\n  "$schema": "http://json-schema.org/draft-07/schema#",\n  "title": "nrs-design spec",\n',
    b'{\n  "$schema": "https://json-schema.org/draft/2020-12/schema",\n'
    b'  "title": "nrs-design export",\n',
)
# Foreign records may share some columns. The pattern requires every fixed column.
RESPONSE = re.compile(
    rb"time_s,angle_rad,velocity_rad_s,torque_Nm,depth_rad,(?:[\w-]+,)*hand_rad_s,(?:[\w-]+,)*mode\n"
)
SWEEP = b"point,exit_code,message,"
# Our SARIF and JUnit files name this program.
GATE = re.compile(
    rb"spec +verdict +common quadratic +decay rate +modes +certificate\n"
    rb"|::(?:error|warning|notice) (?:[^\n]*,)?title=(?:NRS\d+|nrs-design)::"
    rb'|\{\n  "schema": "nrs-design/gate/'
    rb'|\{\n  "\$schema": "https://json\.schemastore\.org/sarif[^{]*\{\s*"tool": \{\s*"driver": \{'
    rb'\s*"name": "nrs-design"'
    rb'|<\?xml version="1\.0" encoding="UTF-8"\?>\n<testsuites name="nrs-design" '
    rb"|### [^\n]{1,4} nrs-design: "
)
# Second line of a figure in its own file.
SVG_MARK = "<!-- nrs-design figure -->\n"
SVG = f'<?xml version="1.0" encoding="utf-8" standalone="no"?>\n{SVG_MARK}'.encode()
# Metadata entry that identifies our images.
MAKER = "nrs-design"
PNG = re.compile(
    rb"\x89PNG\r\n\x1a\n.{25}\x00\x00\x00\x13tEXtSoftware\x00" + MAKER.encode(), re.DOTALL
)
# Bytes to read: more than the longest fixed beginning, and than any file for a pattern.
_LONGEST, _WHOLE = 256, 2**26

Beginning = bytes | tuple[bytes, ...] | re.Pattern[bytes]
Output = tuple[Path, str | bytes, Beginning]


def check_html(path: Path) -> None:
    """Refuse a name that is not one of a page in HTML."""
    if path.suffix.lower() not in (".html", ".htm"):
        raise OutputError("is not the name of a page in HTML", path=path, remedy="end it in .html")


def write_output(path: Path, content: str | bytes, *, replaces: Beginning = b"") -> None:
    """Write a file atomically, through a temporary file in the same folder.

    Its folder is made. A file that is there is replaced if it begins as `replaces` says, or is
    empty. A link, a folder or a device (here or on Windows) is an `OutputError`.
    """
    write_outputs([(path, content, replaces)])


def write_outputs(outputs: Collection[Output]) -> None:
    """Write all files of a result, or none of them after an error."""
    places = set[Path]()
    for path, _, replaces in outputs:
        check_place(path, replaces)
        if (place := path.absolute()) in places:
            raise OutputError("is named for two files", path=path, remedy="name another file")
        places.add(place)
    temporaries: list[tuple[str, Path]] = []
    try:
        for path, content, _ in outputs:
            with _name_file(path):
                _write_temporary(path, content, temporaries)
        while temporaries:
            temporary, path = temporaries[0]
            with _name_file(path):
                os.replace(temporary, path)
            del temporaries[0]
    finally:
        for temporary, _ in temporaries:
            os.unlink(temporary)


def _write_temporary(path: Path, content: str | bytes, temporaries: list[tuple[str, Path]]) -> None:
    """Write a temporary file into the folder of a place, and note it before it is filled."""
    # A file name that is no text may have got in; it is shown with escapes.
    data = content.encode(errors="backslashreplace") if isinstance(content, str) else content
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    temporaries.append((temporary, path))
    with os.fdopen(handle, "wb") as file:
        file.write(data)
    os.chmod(temporary, 0o644)


def check_place(path: Path, replaces: Beginning = b"") -> None:
    """Refuse, before the work, a place to which its result could not be written."""
    if is_device_name(path.name):
        raise OutputError("names a device on Windows", path=path, remedy="name another file")
    with _name_file(path):
        _refuse_links(path)
        _refuse_foreign(path, replaces)
        folder = next(folder for folder in path.parents if folder.exists())
        if not folder.is_dir():
            raise NotADirectoryError(ENOTDIR, os.strerror(ENOTDIR))
        # The temporary file needs a writable folder.
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError(EACCES, os.strerror(EACCES))


@contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Lock a folder against other processes of nrs-design; wait for the lock.

    What is read, changed and written again would lose what another one writes in between. The
    system lets go when a process ends, however it ends. Where it has no such lock (Windows, some
    network drives), nobody waits. The folder is made if it is not there.
    """
    try:
        from fcntl import LOCK_EX, flock
    except ImportError:
        yield
        return
    # The folder must exist: a lock on its parent would not exclude later processes.
    _refuse_links(folder)
    with _name_file(folder):
        folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            flock(handle, LOCK_EX)
        yield
    finally:
        os.close(handle)


@contextmanager
def _name_file(path: Path) -> Iterator[None]:
    """Turn an error of the system into one that names the file."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"cannot be written ({error.strerror})", path=path, remedy="choose a writable folder"
        ) from error


def _refuse_links(path: Path) -> None:
    """Refuse a link anywhere in a path: a repository could lead a result out of itself.

    Links in the root folder itself, such as ``/tmp`` on some systems, are the system's own.
    """
    if path.is_symlink():
        raise OutputError("is a symbolic link, not a file", path=path, remedy="name another file")
    for folder in path.parents:
        is_system_link = folder.is_absolute() and folder.parent == Path(folder.anchor)
        if folder.is_symlink() and not is_system_link:
            raise OutputError(
                f"lies behind the symbolic link {folder}",
                path=path,
                remedy="name the folder that it leads to, or remove the link",
            )


def _refuse_foreign(path: Path, beginning: Beginning) -> None:
    """Refuse a place that holds something else than a file that begins in one of these ways."""
    if not path.exists():
        return
    if not path.is_file():
        raise OutputError(
            "is a folder or a device, not a file", path=path, remedy="name another file"
        )
    with path.open("rb") as file:
        if isinstance(beginning, re.Pattern):
            found = file.read(_WHOLE)
            is_replaceable = beginning.match(found) is not None
        else:
            found = file.read(_LONGEST)
            is_replaceable = found.startswith(beginning)
    if found and not is_replaceable:
        raise OutputError(
            "exists and has another origin than nrs-design: not overwritten",
            path=path,
            remedy="name another file, or remove it",
        )
