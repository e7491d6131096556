"""Where exported files go: all of them or none, in one folder, and over nothing foreign."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import dump
from nrs_design.errors import OutputError
from nrs_design.exporters import Format, format_of, remarks_on, rendered
from nrs_design.output import CERTIFICATE, check_place, write_output, write_outputs
from nrs_design.ownership import check_name, origin_of

if TYPE_CHECKING:
    from nrs_design.exporters.export import Export

# Of a file, such as .txt or .h5; a version of a folder, such as .2, is not one.
_ENDING = re.compile(r"\.[A-Za-z]\w{0,7}")


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

    Raises
    ------
    OutputError
        If a file seems to be meant that is none of this format.
    """
    stem = re.sub(r"\W|^(?=\d)", "_", name) if format_.identifier else name
    files = {ending: out / f"{stem}{ending}" for ending in format_.files}
    if out.is_dir():
        return files
    if len(files) == 1:
        ((ending, path),) = files.items()
        if out.suffix == path.suffix:
            return {ending: out}
    if _ENDING.fullmatch(out.suffix) and not out.exists():
        endings = ", ".join(format_.files)
        raise OutputError(
            f"seems to be a file, and this format writes {name} with {endings}",
            path=out,
            remedy="name a folder (one with such a name must be there already)"
            + (f", or a file that ends in {endings}" if len(files) == 1 else ""),
        )
    return files


def check_places(format_: Format, files: Mapping[str, Path], name: str | None = None) -> None:
    """Refuse to go on where something else stands in the place of a file.

    Parameters
    ----------
    format_ : Format
        It says how its files begin.
    files : mapping of str to Path
        As `places` gives them.
    name : str, optional
        Of the spec of a design; a file that says that it is another's stays.

    Raises
    ------
    OutputError
        If the folder is none or lies behind a link, or a file is a link, or none of this format or
        of this spec.
    """
    for ending, path in files.items():
        if path.parent.exists() and not path.parent.is_dir():
            raise OutputError(
                "is a file, not a folder", path=path.parent, remedy="choose another --out"
            )
        check_place(path, format_.files[ending])
        if name is not None:
            check_name(name, path)


def write_files(format_: Format, files: Mapping[str, Path], contents: Mapping[str, bytes]) -> None:
    """Write all files of an export, or none.

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
    write_outputs([(path, contents[end], format_.files[end]) for end, path in files.items()])


def write_export(
    result: Export, format_: str, files: Mapping[str, Path], proof: Path | None, spec: Path
) -> tuple[str, ...]:
    """Write the certificate first: there is never an export without its proof; return remarks.

    Parameters
    ----------
    result : Export
        That may be written.
    format_ : str
        Name of the format.
    files : mapping of str to Path
        As `places` gives them.
    proof : Path or None
        Where the certificate goes; None if it is in a file already.
    spec : Path
        That the certificate names as its own.
    """
    contents = rendered(format_, result)
    if proof is not None and result.certificate is not None:
        text = dump(result.certificate, origin_of(spec, proof))
        write_output(proof, text, replaces=CERTIFICATE)
    write_files(format_of(format_), files, contents)
    return remarks_on(format_, contents)
