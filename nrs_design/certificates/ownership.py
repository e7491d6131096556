"""Owners of the files in an output folder: a spec never overwrites files of another spec.

Files are named after the ``name:`` of their spec, and a copied spec has the same. Certificates and
pages therefore say where their spec was, relative to themselves. This is no part of any claim: it
is not checked, and a certificate holds wherever its spec is.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.errors import CertificateError, OutputError
from nrs_design.output import CERTIFICATE, PAGE, write_output
from nrs_design.spec.task_space import file_of

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate

REMEDY = "give this spec a `name` of its own, choose another place, or remove that file"
# Name of the spec in an export: in header lines, JSON or a MAT-file.
_NAMED = re.compile(
    rb"\bspec: ([a-z0-9._-]+),[\s*#]+sha256[\s*#]+[0-9a-f]{64}"
    rb'|"spec": \{\s*"name": "([a-z0-9._-]+)"'
    rb"|\AMATLAB 5.0 MAT-file, nrs-design export of ([a-z0-9._-]+) "
)
# Origin of the spec near the beginning of a page.
_PAGE_ORIGIN = re.escape(PAGE) + rb'<meta name="spec" content="([^"]{1,4096})">'


def origin_of(spec: Path, file: Path) -> str:
    """Return where a spec is, seen from the folder of a file, with forward slashes."""
    relative = os.path.relpath(os.path.realpath(spec), os.path.realpath(file.parent))
    text = Path(relative).as_posix()
    return text.encode(errors="surrogateescape").decode(errors="backslashreplace")


def write_certificate(certificate: Certificate, spec: Path, file: Path) -> None:
    """Write a certificate, which says where its spec is."""
    from nrs_design.certificates.certificate import dump

    write_output(file, dump(certificate, origin_of(spec, file)), replaces=CERTIFICATE)


def check_owner(spec: Path, name: str, folder: Path) -> None:
    """Raise an error if files of that name in a folder belong to another spec.

    That is, of one that still exists; or what is there is no certificate at all.
    """
    check_certificate(spec, folder / f"{name}.cert.json")
    check_page(spec, folder / f"{name}.html")


def check_page(spec: Path, page: Path) -> None:
    """Refuse to overwrite the page of another spec; see `check_owner`."""
    if page.is_file():
        import html

        with page.open("rb") as file:
            found = re.match(_PAGE_ORIGIN, file.read(8192))
        if found:
            _refuse_other(spec, html.unescape(found[1].decode(errors="replace")), page)


def check_name(name: str, file: Path) -> None:
    """Refuse to overwrite what says, as every export does, that it is of a spec of another name."""
    if file.is_file():
        with file.open("rb") as opened:
            found = _NAMED.search(opened.read(8192))
        owner = next(filter(None, found.groups())).decode() if found else name
        if owner != name:
            raise OutputError(f"was exported for the spec {owner}", path=file, remedy=REMEDY)


def check_certificate(spec: Path, file: Path) -> None:
    """Refuse to overwrite the certificate of another spec; see `check_owner`."""
    from nrs_design.certificates.verify import read_document

    if not file.is_file():
        return  # A folder, or a link to nothing, is refused where it is written.
    try:
        document = read_document(file)
    except CertificateError:
        document = {}
    if not str(document.get("schema")).startswith("nrs-design/certificate/"):
        raise OutputError("exists already and is not a certificate", path=file, remedy=REMEDY)
    origin = document.get("origin")
    if isinstance(origin, str):
        _refuse_other(spec, origin, file)


def _refuse_other(spec: Path, origin: str, file: Path) -> None:
    """Refuse a file of another spec; a deleted spec owns nothing."""
    owner = file.parent / origin
    if os.path.isfile(file_of(owner)) and os.path.realpath(owner) != os.path.realpath(spec):
        raise OutputError(f"belongs to {os.path.relpath(owner)}", path=file, remedy=REMEDY)
