"""From a linear motion to a rotation about the pivot."""

from __future__ import annotations

from nrs_design.errors import DataError, SpecError
from nrs_design.models.contact import AbstractContactLaw
from nrs_design.spec.kinds import LEVER_ARM
from nrs_design.spec.quantity import parse_quantity


def parse_arm(text: str | None, *, rotational: bool) -> float | None:
    """Read a lever arm such as ``0.24 m``; return it in m.

    Raises
    ------
    DataError
        If it is no length, is not positive, or the records are rotational and need none.
    """
    if text is None:
        return None
    try:
        arm = parse_quantity(text, LEVER_ARM).si
    except SpecError as error:
        raise DataError(f"--lever-arm: {error.message}", remedy=error.remedy) from None
    if rotational:
        raise DataError(
            "the records are rotational, and a lever arm is given", remedy="remove --lever-arm"
        )
    if arm <= 0:
        raise DataError(f"the lever arm {text!r} is not positive", remedy="write '0.24 m'")
    return arm


def units_of(law: AbstractContactLaw, rotational: bool) -> tuple[str, ...]:
    """Return the units of the parameters of a law, as people read them."""
    return tuple(unit.replace("*", " ") for unit in law.units(rotational=rotational))
