"""What a packed file unfolds to, looked at before a reader of its format unfolds it."""

from __future__ import annotations

import struct
import zlib
from typing import BinaryIO
from zipfile import ZipFile

MAX_UNPACKED = 32 * 2**20
# MATLAB's cells and structures in each other: the reader takes a piece of the stack for each.
MAX_NESTED = 1000

# Of the format of MATLAB 5 to 7: where the elements begin, and two kinds of them.
_HEADER = 128
_MATRIX = 14
_COMPRESSED = 15


def check_npz(file: BinaryIO) -> None:
    """Refuse an archive that unfolds to more than 32 MiB; end at its beginning.

    Raises
    ------
    ValueError
        If it does.
    """
    with ZipFile(file) as archive:
        _check_length(sum(item.file_size for item in archive.infolist()))
    file.seek(0)


def check_mat(content: bytes) -> None:
    """Refuse a MATLAB file that unfolds to more than 32 MiB, or is nested without end.

    Raises
    ------
    ValueError
        If it does.
    """
    if b"\0" in content[:4]:
        # MATLAB 4 neither packs nor nests.
        return
    order = "<" if content[126:_HEADER] == b"IM" else ">"
    tag = struct.pack(f"{order}I", _MATRIX)
    position, length, nested = _HEADER, 0, content.count(tag)
    while position + 8 <= len(content):
        kind, size = struct.unpack_from(f"{order}II", content, position)
        position += 8
        if kind == _COMPRESSED:
            packed = content[position : position + size]
            unpacked = zlib.decompressobj().decompress(packed, MAX_UNPACKED + 1)
            length += len(unpacked)
            nested += unpacked.count(tag)
            _check_length(length)
        position += size
    if nested > MAX_NESTED:
        raise ValueError(f"it holds more than {MAX_NESTED} matrices in each other")


def _check_length(length: int) -> None:
    if length > MAX_UNPACKED:
        raise ValueError(f"it unfolds to more than {MAX_UNPACKED} bytes")
