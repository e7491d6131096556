"""Writing results: whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from nrs_design.errors import OutputError
from nrs_design.files import is_device_name


def write_output(path: Path, content: str | bytes) -> None:
    """Write a file through a temporary one beside it, so that no half-written file is left.

    Parameters
    ----------
    path : Path
        Its folder is made if it does not exist.
    content : str or bytes
        Text is written as UTF-8.

    Raises
    ------
    OutputError
        If the place cannot be written to, or is a link, a folder or a device, here or on Windows.
    """
    if is_device_name(path.name):
        raise OutputError("names a device on Windows", path=path, remedy="name another file")
    if path.is_symlink() or (path.exists() and not path.is_file()):
        kind = "a symbolic link" if path.is_symlink() else "a folder or a device"
        raise OutputError(f"is {kind}, not a file", path=path, remedy="name another file")
    # A file name that is no text may have got in; it is shown with escapes.
    data = content.encode(errors="backslashreplace") if isinstance(content, str) else content
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(data)
            os.chmod(temporary, 0o644)
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise OutputError(
            f"cannot be written ({error.strerror})", path=path, remedy="choose a writable folder"
        ) from error
