"""What a spec is read to say in the place of what its file says: one point of a sweep.

A command takes the path of a file. Within `saying_instead` that file is read as if somebody had
written other values into it; no file is written, and names of other files stay relative to its
folder. Everything keeps its line and column.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from nrs_design.spec.document import Node
from nrs_design.spec.edits import Keys, with_edits

# A place of the document, and the text that it holds there.
Change = tuple[Keys, str]

_CHANGES: ContextVar[tuple[str, tuple[Change, ...]] | None] = ContextVar("changes", default=None)


@contextmanager
def saying_instead(file: Path, changes: Sequence[Change]) -> Iterator[None]:
    """Read a file as if it said something else at places that it has; other files as they are."""
    token = _CHANGES.set((os.path.realpath(file), tuple(changes)))
    try:
        yield
    finally:
        _CHANGES.reset(token)


def as_read(root: Node, file: Path) -> Node:
    """Return the document of a file as it is to be read: changed within `saying_instead`."""
    said = _CHANGES.get()
    if said is None or said[0] != os.path.realpath(file):
        return root
    return with_edits(root, said[1])
