"""What options say of records of tissue, read with units."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import isfinite

from nrs_design.errors import DataError, SpecError
from nrs_design.identification.tissue.trial import Preparation
from nrs_design.named_values import read_named_values
from nrs_design.spec.kinds import ANGLE, LENGTH, LEVER_ARM
from nrs_design.spec.quantity import QuantityKind, parse_quantity

# In m; longer arms were meant in mm.
_LONGEST_ARM = 10.0


def parse_arm(text: str | None, *, rotational: bool) -> float | None:
    """Read a lever arm such as ``0.24 m``; return it in m. Records of a rotation need none."""
    if text is None:
        return None
    arm = _parse("--lever-arm", text, LEVER_ARM)
    if rotational:
        raise DataError(
            "the records are rotational, and a lever arm is given", remedy="remove --lever-arm"
        )
    if arm <= 0:
        raise DataError(f"the lever arm {text!r} is not positive", remedy="write '0.24 m'")
    if arm > _LONGEST_ARM:
        raise DataError(
            f"the lever arm {text!r} is longer than any arm", remedy=f"did you mean '{arm:g} mm'?"
        )
    return arm


def parse_preload(text: str | None, *, rotational: bool) -> tuple[float, float] | None:
    """Read ``--preload``, such as ``1 mm..3 mm``: deflections from the contact, in SI."""
    if text is None:
        return None
    low, dots, high = (part.strip() for part in text.partition(".."))
    if not dots:
        high = low
    kind = (LENGTH, ANGLE)[rotational]
    return _parse("--preload", low, kind), _parse("--preload", high, kind)


def _parse(option: str, text: str, kind: QuantityKind) -> float:
    try:
        return parse_quantity(text, kind).si
    except SpecError as error:
        raise DataError(f"{option}: {error.message}", remedy=error.remedy) from None


def read_preparation(entries: Iterable[str]) -> Preparation:
    """Read how records are prepared; the settings are the fields of `Preparation`.

    ``start=S``, ``end=S``, ``contact=auto|given``, ``negate=true``.
    """
    readers: dict[str, Callable[[str], object]] = {
        "start": _seconds,
        "end": _seconds,
        "contact": _out_of("auto", "given"),
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
    def read(text: str) -> str:
        if text not in choices:
            raise ValueError(f"write one of {', '.join(choices)}")
        return text

    return read
