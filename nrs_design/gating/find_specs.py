"""Which spec files a list of files and folders means."""

from __future__ import annotations

import os
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterable, Iterator
from pathlib import Path

from nrs_design.errors import NrsDesignError, SpecError
from nrs_design.spec.document import MAX_BYTES
from nrs_design.spec.load import SPEC_KINDS, axes_at

SUFFIXES = (".nrs.yaml", ".nrs.yml")
YAML = (".yaml", ".yml")
# The key of a spec: at the beginning of a line, or of a mapping in one line; indented if quoted.
_KIND = re.compile(
    r"^\ufeff?(?:[ \t]*\{?[ \t]*(?=[\"'])|\{\s*)?[\"']?kind[\"']?\s*:\s*[\"']?"
    rf"({'|'.join(SPEC_KINDS)})(?![\w./-])",
    re.MULTILINE,
)


def find_specs(paths: Iterable[Path]) -> tuple[Path, ...]:
    """List the spec files of files and folders, sorted, each once; a folder must have one.

    A folder stands for all ``*.nrs.yaml`` and ``*.nrs.yml`` below it, in capitals too. Hidden
    folders and links to folders are passed over; `find_passed_over` lists them, and
    `find_misnamed` what seems to be a spec by another name. A file is taken
    as it is named, whether it exists or not: reading it is where that shows.
    """
    found: dict[str, Path] = {}
    for path in paths:
        specs = sorted(_specs_below(path)) if os.path.isdir(path) else [path]
        if not specs:
            raise NrsDesignError(
                f"there is no *{SUFFIXES[0]} in this folder",
                path=path,
                remedy="name a spec file or a folder with specs",
            )
        for spec in specs:
            found.setdefault(os.path.realpath(spec), spec)
    return tuple(axis for spec in sorted(found.values()) for axis in axes_or_whole(spec))


def find_passed_over(paths: Iterable[Path]) -> tuple[Path, ...]:
    """List hidden folders, and links to folders, below the given folders."""
    return tuple(
        sorted(
            Path(folder, name)
            for path in filter(os.path.isdir, paths)
            for folder, subfolders, _ in _walk(path)
            for name in subfolders
            if name.startswith(".") or os.path.islink(os.path.join(folder, name))
        )
    )


def find_misnamed(paths: Iterable[Path]) -> tuple[Path, ...]:
    """List the files below folders that read like specs, and are passed over for their names."""
    return tuple(
        sorted(
            file
            for path in filter(os.path.isdir, paths)
            for folder, _, files in _walk(path)
            for file in (Path(folder, name) for name in files)
            if file.name.lower().endswith(YAML)
            and not file.name.lower().endswith(SUFFIXES)
            and _reads_like_a_spec(file)
        )
    )


def axes_or_whole(spec: Path) -> tuple[Path, ...]:
    """Return the axes of a spec with several axes; else, or of a wrong file, the spec itself."""
    try:
        return axes_at(spec)
    except SpecError:
        return (spec,)


def _reads_like_a_spec(file: Path) -> bool:
    """Tell whether a file says the kind of a spec; a broken one may."""
    if not file.is_file():
        return False
    try:
        with file.open("rb") as stream:
            content = stream.read(MAX_BYTES)
    except OSError:
        return False
    wide = content.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
    text = content.decode("utf-16" if wide else "utf-8-sig", errors="replace")
    return _KIND.search(text) is not None


def _specs_below(root: Path) -> Iterator[Path]:
    real_root = os.path.realpath(root)
    for folder, _, files in _walk(root):
        for name in files:
            if name.lower().endswith(SUFFIXES):
                spec = Path(folder, name)
                if os.path.commonpath([real_root, os.path.realpath(spec)]) != real_root:
                    raise SpecError(
                        "is a link that leads out of the folder",
                        path=spec,
                        remedy="name the spec itself, or remove the link",
                    )
                yield spec


def _walk(root: Path) -> Iterator[tuple[str, list[str], list[str]]]:
    for folder, subfolders, files in os.walk(root, onerror=_refuse):
        yield folder, list(subfolders), files
        subfolders[:] = [name for name in subfolders if not name.startswith(".")]


def _refuse(error: OSError) -> None:
    """Fail on a folder that cannot be listed: a spec in it would go unnoticed."""
    raise SpecError(
        f"cannot be listed ({error.strerror})",
        path=Path(os.fsdecode(error.filename)),
        remedy="make the folder readable, or name the specs one by one",
    )
