"""What ``--set`` says of a record of tissue, read with units."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import isfinite

from nrs_design.identification.lever import parse_offset
from nrs_design.identification.tissue.trial import Preparation
from nrs_design.named_values import read_named_values


def read_preparation(entries: Iterable[str], *, rotational: bool) -> Preparation:
    """Read how records are prepared; the settings are the fields of `Preparation`.

    ``start=S``, ``end=S``, ``contact=auto|given``, ``zero=POSITION``, ``tare=FORCE``,
    ``drift=auto|fit|none``, ``negate=true``.
    """
    readers: dict[str, Callable[[str], object]] = {
        "start": _seconds,
        "end": _seconds,
        "contact": _out_of("auto", "given"),
        "zero": lambda text: parse_offset("zero", text, rotational=rotational),
        "tare": lambda text: parse_offset("tare", text, rotational=rotational),
        "drift": _out_of("auto", "fit", "none"),
        "negate": lambda text: _out_of("true", "false")(text) == "true",
    }
    return Preparation(**read_named_values(entries, readers, "a record"))


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise ValueError("write seconds from the beginning of the record, such as 2.5")
    return value


def _out_of(*choices: str) -> Callable[[str], str]:
    def chosen(text: str) -> str:
        if text not in choices:
            raise ValueError(f"write one of {', '.join(choices)}")
        return text

    return chosen
