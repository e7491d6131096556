"""What a model for co-simulation holds: a stranger's archive, read in a process of its own."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO
from xml.etree import ElementTree

from nrs_design.confined import read_confined
from nrs_design.files import open_regular

# No export holds more.
LARGEST_ENTRY, MOST_ENTRIES = 2**22, 16
LARGEST_FILE = MOST_ENTRIES * LARGEST_ENTRY
_XML = b'<?xml version="1.0" encoding="UTF-8"?>'
# It names the release that wrote the file.
_RELEASE = "generationTool"

# Bytes of the format ZIP: for each entry twice, beside name and content, and once at the end.
_OF_AN_ENTRY, _OF_THE_END = 30 + 46, 22

# Tag, attributes by name, text.
Element = tuple[str, tuple[tuple[str, str], ...], str]


@dataclass(frozen=True, slots=True)
class Archive:
    """What an archive holds."""

    entries: Mapping[str, bytes]  # By path
    # The elements of each XML document with their attributes, without the release that wrote it; or
    # what is wrong with it.
    documents: Mapping[str, list[Element] | str]


def read_archive(path: Path) -> Archive | None:
    """Return what an archive holds; None if no export is like that.

    Raises
    ------
    OSError
        If it cannot be opened, or is no regular file.
    DataError
        If it cannot be read.
    """
    with open_regular(path) as file:
        if os.fstat(file.fileno()).st_size > LARGEST_FILE:
            return None
        found = read_confined(unpack_archive, (), file, path, "export it again")
    if found is None:
        return None
    archive = Archive(*found)
    parsed = {name for name in archive.entries if name.endswith(".xml")}
    return archive if parsed == archive.documents.keys() else None


def unpack_archive(
    file: BinaryIO, path: Path
) -> tuple[dict[str, bytes], dict[str, list[Element] | str]] | None:
    """Return entries and documents as `Archive` has them; None if no export is like that.

    Parameters
    ----------
    file : binary file
        At its beginning.
    path : Path
        Not needed: nothing about the file is an error.
    """
    del path
    try:
        with zipfile.ZipFile(file) as archive:
            listed = archive.infolist()
            plain = len(listed) <= MOST_ENTRIES and all(
                info.compress_type == zipfile.ZIP_STORED and info.file_size <= LARGEST_ENTRY
                for info in listed
            )
            # Whatever else there is could be another archive to another reader.
            said = sum(2 * len(info.filename) + info.file_size for info in listed)
            plain &= file.seek(0, os.SEEK_END) == said + len(listed) * _OF_AN_ENTRY + _OF_THE_END
            if not plain or len({info.filename for info in listed}) < len(listed):
                return None
            entries = {info.filename: archive.read(info) for info in listed}
    except (zipfile.BadZipFile, ValueError, NotImplementedError, RuntimeError, OSError):
        return None
    return entries, {name: elements(entries[name]) for name in entries if name.endswith(".xml")}


def elements(content: bytes) -> list[Element] | str:
    """Return the elements of a document with their attributes; or what is wrong with it."""
    # A document with definitions of its own could grow without bound.
    if b"<!" in content or not content.startswith(_XML):
        return "it begins otherwise than an export, or has definitions of its own"
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError:
        return "it is no XML"
    return [(e.tag, _attributes(e), (e.text or "").strip()) for e in root.iter()]


def _attributes(element: ElementTree.Element) -> tuple[tuple[str, str], ...]:
    return tuple(sorted((k, v) for k, v in element.attrib.items() if k != _RELEASE))
