"""Pages that are as they would be made anew: they are not drawn again.

To draw the figures of a page takes several times as long as to certify its spec. A page follows
from what its spec says, from what was found now, and from this program with its libraries. Beside
each page stands a hidden file with the hash of all that, and of the page. Where one of them
differs, or the page was changed by anybody, it is drawn again. No obligation depends on it.
"""

from __future__ import annotations

import hashlib
import json
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design import __version__
from nrs_design.certificates.certificate import dump
from nrs_design.files import open_regular
from nrs_design.gating.recorded import hash_followed
from nrs_design.output import PAGE_NOTE, write_output

if TYPE_CHECKING:
    from nrs_design.pipeline.certification import Result
    from nrs_design.search.certification import Limits

# Those that compute, draw or write something of a page.
LIBRARIES = ("numpy", "scipy", "clarabel", "control", "matplotlib", "jinja2", "python-flint")
_PACKAGE = Path(__file__).parents[1]


def page_fingerprint(result: Result, limits: Limits, origin: str) -> str:
    """Return the hash of everything that a page follows from, in hexadecimal.

    The limits of the searches are part of it, and how they went is not: what is found by one is
    found again in its certificate. The origin is the spec as seen from the page.
    """
    loaded, found = result.loaded, result.certification
    said = [
        program_hash(),
        str(loaded.path),
        origin,
        loaded.text,
        loaded.sha256,
        dict(hash_followed(loaded)),
        str(found.verdict),
        None if result.certificate is None else dump(result.certificate, origin),
        (limits.max_degree, limits.budget, limits.memory, limits.optimize_rate, limits.more),
    ]
    return hashlib.sha256(json.dumps(said).encode()).hexdigest()


def is_current(page: Path, made: str) -> bool:
    """Tell whether a page was made of just this, and is as it was written."""
    try:
        with open_regular(page) as file, open_regular(_note_of(page)) as note:
            return note.read() == _noted(made, file.read())
    except OSError:
        return False


def note_page(page: Path, made: str) -> None:
    """Note beside a page what it was made of."""
    write_output(_note_of(page), _noted(made, page.read_bytes()), replaces=PAGE_NOTE)


def _note_of(page: Path) -> Path:
    return page.with_name(f".{page.name}.made")


def _noted(made: str, content: bytes) -> bytes:
    return PAGE_NOTE + f"{made}\n{hashlib.sha256(content).hexdigest()}\n".encode()


@cache
def program_hash() -> str:
    """Return the hash of this program: every file of it, its libraries, and Python."""
    digest = hashlib.sha256(f"{__version__} {platform.python_version()}".encode())
    digest.update(" ".join((platform.machine(), *map(_version, LIBRARIES))).encode())
    for file in sorted(_PACKAGE.rglob("*")):
        if file.is_file() and "__pycache__" not in file.parts:
            digest.update(file.relative_to(_PACKAGE).as_posix().encode())
            digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return "none"
