"""Arrays as a NumPy archive that can be told from those of other programs."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


def to_archive(about: str, arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Return arrays as a NumPy archive, the same bytes for the same arrays.

    The first one, ``about``, is stored as it is, so that an archive of ours can be told from others
    by its first bytes, whatever version of Python wrote it.

    Parameters
    ----------
    about : str
        What the archive is.
    arrays : mapping of ndarray
        By name; numbers and texts.
    """
    first = {"about": np.array(about)}
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, array in (first | dict(arrays)).items():
            content = io.BytesIO()
            np.lib.format.write_array(content, array, allow_pickle=False)
            member = zipfile.ZipInfo(f"{name}.npy")
            packed = zipfile.ZIP_STORED if name in first else zipfile.ZIP_DEFLATED
            archive.writestr(member, content.getvalue(), packed)
    return file.getvalue()
