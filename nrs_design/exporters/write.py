"""Writing of exported files: all or none, in one folder, over no foreign file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.certificates.ownership import check_name, write_certificate
from nrs_design.errors import OutputError
from nrs_design.exporters import Format, find_remarks, format_of, rendered
from nrs_design.output import check_place, write_outputs

if TYPE_CHECKING:
    from nrs_design.exporters.export import Export

# Ending of a file, such as .txt or .h5, but no version of a folder, such as .2.
_ENDING = re.compile(r"\.[A-Za-z]\w{0,7}")


def places(format_: Format, name: str, out: Path) -> dict[str, Path]:
    """Return the path of each file of a format in a folder, by its ending.

    Where the format has one file only, `out` may be that file. An `OutputError` if a file seems to
    be meant that is none of this format.
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


def check_places(format_: Format, files: Mapping[str, Path], name: str) -> None:
    """Refuse to overwrite a link, a file of another format, or a file of another spec."""
    for ending, path in files.items():
        if path.parent.exists() and not path.parent.is_dir():
            raise OutputError(
                "is a file, not a folder", path=path.parent, remedy="choose another --out"
            )
        check_place(path, format_.files[ending])
        check_name(name, path)


def write_export(
    result: Export, format_: str, files: Mapping[str, Path], proof: Path | None, spec: Path
) -> tuple[str, ...]:
    """Write the certificate first: there is never an export without its proof; return remarks.

    `proof` is None where the certificate is in a file already; it names `spec` as its own.
    """
    contents = rendered(format_, result)
    if proof is not None and result.certificate is not None:
        write_certificate(result.certificate, spec, proof)
    kinds = format_of(format_).files
    write_outputs([(path, contents[end], kinds[end]) for end, path in files.items()])
    return find_remarks(format_, contents)
