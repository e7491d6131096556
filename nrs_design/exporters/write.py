"""Where exported files go: all of them or none, in one folder, and over nothing foreign."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from nrs_design.errors import OutputError
from nrs_design.exporters import Format
from nrs_design.output import check_replaceable, write_output


def places(format_: Format, name: str, out: Path) -> dict[str, Path]:
    """Return where each file of a format goes, by its ending.

    Parameters
    ----------
    format_ : Format
        With one file or several.
    name : str
        Of the spec.
    out : Path
        A folder. Where the format has one file only, that may be named, with its ending.
    """
    files = {ending: out / f"{name}{ending}" for ending in format_.files}
    if len(files) == 1 and not out.is_dir():
        ((ending, path),) = files.items()
        return {ending: out if out.suffix == path.suffix else path}
    return files


def check_places(format_: Format, files: Mapping[str, Path]) -> None:
    """Refuse to go on where something else stands in the place of a file.

    Parameters
    ----------
    format_ : Format
        It says how its files begin.
    files : mapping of str to Path
        As `places` gives them.

    Raises
    ------
    OutputError
        If the folder is none, or a file is not one of this format.
    """
    for ending, path in files.items():
        if path.parent.exists() and not path.parent.is_dir():
            raise OutputError(
                "is a file, not a folder", path=path.parent, remedy="choose another --out"
            )
        check_replaceable(path, format_.files[ending])


def write_files(format_: Format, files: Mapping[str, Path], contents: Mapping[str, bytes]) -> None:
    """Write all files of an export, each whole or not at all.

    Parameters
    ----------
    format_ : Format
        It says how files that are replaced begin.
    files : mapping of str to Path
        As `places` gives them.
    contents : mapping of str to bytes
        By the same endings.

    Raises
    ------
    OutputError
        If a file cannot be written, or something else stands in its place.
    """
    check_places(format_, files)
    for ending, path in files.items():
        write_output(path, contents[ending], replaces=format_.files[ending])
