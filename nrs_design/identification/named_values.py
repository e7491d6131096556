"""Settings that are typed as ``NAME=VALUE``: one option in the place of many."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from nrs_design.errors import DesignError


def read_named_values(
    entries: Iterable[str], readers: Mapping[str, Callable[[str], Any]], of: str
) -> dict[str, Any]:
    """Read settings by name, such as ``radius=1e5``; readers raise a ValueError for no value."""
    read: dict[str, Any] = {}
    for entry in entries:
        name, sign, text = entry.partition("=")
        if not sign or name not in readers:
            raise DesignError(
                f"{entry!r} is no setting of {of}",
                remedy=f"write NAME=VALUE, with one of {', '.join(readers)}",
            )
        if name in read:
            raise DesignError(f"{name} is set twice", remedy="set it once")
        try:
            read[name] = readers[name](text)
        except ValueError as error:
            raise DesignError(f"{text!r} is no value of {name}", remedy=str(error)) from None
    return read
