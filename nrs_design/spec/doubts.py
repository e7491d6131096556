"""Reasons to doubt a spec that is valid: warnings, not errors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nrs_design.spec.load import Spec


@dataclass(frozen=True, slots=True)
class Doubt:
    """Something that is allowed, and probably not meant.

    Parameters
    ----------
    at : tuple of str
        Keys that lead to it in the spec.
    message : str
        What is doubtful; one line.
    """

    at: tuple[str, ...]
    message: str

    def __str__(self) -> str:
        """Return the message."""
        return self.message


def doubt_spec(spec: Spec) -> Iterator[Doubt]:
    """Yield what is doubtful about a spec, before anything is designed."""
    if spec.kind != "interaction-design":
        return
    for at, item in spec.identified.items():
        if item.doubts and item.accept_doubt is None:
            yield Doubt(
                (*at, "doubts"),
                f"the identification of {at[-1]} is in doubt, and nothing says why that is "
                "accepted (record again, or add accept_doubt)",
            )
    for name in spec.environments:
        if name not in spec.touched:
            yield Doubt(
                ("environments", name),
                f"environment {name} is touched by no controller, so nothing is shown about it "
                "(list it in the contacts of a controller, or remove it)",
            )
