"""The spec of a case with the files that it names, laid out as they lie to each other."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path, PurePath

from nrs_design.errors import OutputError
from nrs_design.files import open_regular
from nrs_design.gating.recorded import recorded_files
from nrs_design.spec import LoadedSpec
from nrs_design.spec.robot_bounds import bounds_file

FOLDER = "spec"


def sources_of(loaded: LoadedSpec) -> tuple[str, dict[str, bytes]]:
    """Return where the spec goes in the folder of a case, and it and all that it names as bytes.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec; its robot, the bounds of that, and recorded commands go with it.

    Raises
    ------
    OutputError
        If one of the files cannot be read.
    """
    files = [Path(os.path.normpath(file.absolute())) for file in _named(loaded)]
    above = Path(os.path.commonpath([file.parent for file in files]))
    places = {file: _place(file.relative_to(above)) for file in files}
    return places[files[0]], {place: read_file(file) for file, place in places.items()}


def read_file(path: Path) -> bytes:
    """Read a file whole.

    Raises
    ------
    OutputError
        If it cannot be read, or is no regular file.
    """
    try:
        with open_regular(path) as stream:
            return stream.read()
    except OSError as error:
        raise OutputError(f"cannot be read ({error.strerror})", path=path) from error


def _named(loaded: LoadedSpec) -> Iterator[Path]:
    yield loaded.path
    if loaded.robot is not None:
        yield loaded.robot
        yield bounds_file(loaded.robot)
    yield from (loaded.path.parent / name for name in recorded_files(loaded))


def _place(relative: PurePath) -> str:
    return f"{FOLDER}/{relative.as_posix()}"
