"""Quantities that options give, and the way from a linear motion to a rotation."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from nrs_design.errors import DataError, SpecError
from nrs_design.models.contact import AbstractContactLaw
from nrs_design.spec.kinds import ANGLE, FORCE, LENGTH, LEVER_ARM, TORQUE
from nrs_design.spec.quantity import QuantityKind, parse_quantity

T = TypeVar("T")

# In m: what is longer was meant in mm.
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


def parse_offset(setting: str, text: str, *, rotational: bool) -> float | None:
    """Read ``zero``, a position, or ``tare``, a force, in SI; ``fit`` is None."""
    if text == "fit":
        return None
    kinds = {"zero": (LENGTH, ANGLE), "tare": (FORCE, TORQUE)}
    return _parse(setting, text, kinds[setting][rotational])


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


def named(
    law: AbstractContactLaw, values: Iterable[T], rotational: bool
) -> list[tuple[str, T, str]]:
    """Return name, value and unit of each parameter of a law."""
    units = parameter_units(law, rotational)
    return list(zip(law.parameters(), values, units, strict=True))


def in_words(parameters: Iterable[tuple[str, object, str]]) -> str:
    """Write parameters with their values and units."""
    return ", ".join(f"{name} = {value} {unit}".rstrip() for name, value, unit in parameters)


def parameter_units(law: AbstractContactLaw, rotational: bool) -> tuple[str, ...]:
    """Return the units of the parameters of a law, as people read them."""
    return tuple(unit.replace("*", " ") for unit in law.units(rotational=rotational))
