"""What stops the build."""

from __future__ import annotations

from collections.abc import Iterable


class DocumentationError(Exception):
    """The documentation is not whole; the build fails with this message."""


def refuse(what: str, where: Iterable[str]) -> None:
    """Stop the build if anything is listed."""
    if listed := sorted(where):
        raise DocumentationError(f"{what}: {', '.join(listed)}")
