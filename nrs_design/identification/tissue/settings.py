"""Settings for the preparation of records, and their reading from ``NAME=VALUE``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any, Literal

from nrs_design.errors import DesignError


@dataclass(frozen=True, slots=True)
class Preparation:
    """Settings for the preparation of all records."""

    # start, end: part of the record, in s from its beginning.
    start: float | None = None
    end: float | None = None
    # auto: detect air. given: all samples are in contact.
    contact: Literal["auto", "given"] = "auto"
    negate: bool = False  # Change the sign of the force


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise ValueError("write seconds from the beginning of the record, such as 2.5")
    return value


def _one_of(choices: Mapping[str, Any]) -> Callable[[str], Any]:
    def read(text: str) -> Any:
        if text not in choices:
            raise ValueError(f"write one of {', '.join(choices)}")
        return choices[text]

    return read


_READERS: Mapping[str, Callable[[str], Any]] = {
    "start": _seconds,
    "end": _seconds,
    "contact": _one_of({"auto": "auto", "given": "given"}),
    "negate": _one_of({"true": True, "false": False}),
}


def read_preparation(entries: Iterable[str]) -> Preparation:
    """Read how records are prepared; the settings are the fields of `Preparation`.

    ``start=S``, ``end=S``, ``contact=auto|given``, ``negate=true``.
    """
    settings: dict[str, Any] = {}
    for entry in entries:
        name, sign, text = entry.partition("=")
        if not sign or name not in _READERS:
            raise DesignError(
                f"{entry!r} is no setting of a record",
                remedy=f"write NAME=VALUE, with one of {', '.join(_READERS)}",
            )
        if name in settings:
            raise DesignError(f"{name} is set twice", remedy="set it once")
        try:
            settings[name] = _READERS[name](text)
        except ValueError as error:
            raise DesignError(f"{text!r} is no value of {name}", remedy=str(error)) from None
    return Preparation(**settings)
