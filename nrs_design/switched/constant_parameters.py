"""Parameters that are unknown but constant: which modes are one mode at their corners."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import prod

from nrs_design.errors import AssemblyError, InternalError
from nrs_design.proof.switching import FixedParameter
from nrs_design.proof.system import SwitchedSystem

MAX_CORNERS = 50_000


@dataclass(frozen=True, slots=True)
class ConstantParameter:
    """One parameter that does not change while the robot runs."""

    said: FixedParameter  # Its name and range
    # How the name of a mode says at which of its corners the mode is, low before high: one label
    # such as ``k-min``, or several such as ``E-min/s-max``.
    labels: tuple[str, ...]
    contact: str | None = None  # The one contact that it is of; None if it is in all modes

    def is_at(self, mode: Sequence[str]) -> str | None:
        """Return at which corner a mode is, None if the parameter is not in it.

        Parameters
        ----------
        mode : sequence of str
            Its name, then its labels: those of contact and corners.
        """
        if self.contact is not None and self.contact not in mode[1:2]:
            return None
        said = set(mode[1:])
        return next((label for label in self.labels if said.issuperset(label.split("/"))), None)


def constant_sets(
    names: Iterable[str], parameters: Sequence[ConstantParameter]
) -> Iterator[tuple[str, ...]]:
    """Yield, for each mode, what it is at the corners of the constant parameters.

    A mode that a parameter is not in is the same at both of its ends.

    Parameters
    ----------
    names : iterable of str
        Of all modes, with their labels.
    parameters : sequence of ConstantParameter
        In the order in which corners turn, the last one fastest.

    Raises
    ------
    InternalError
        If a corner has no mode.
    """
    if not parameters:
        return
    # By what is not constant, and the corner of what is.
    known: dict[tuple[tuple[str, ...], tuple[str | None, ...]], str] = {}
    first: dict[tuple[tuple[str, ...], tuple[bool, ...]], None] = {}
    for name in names:
        mode = name.split("/")
        ends = tuple(parameter.is_at(mode) for parameter in parameters)
        constant = {label for end in ends if end is not None for label in end.split("/")}
        varying = (mode[0], *(label for label in mode[1:] if label not in constant))
        has = tuple(end is not None for end in ends)
        known[varying, ends] = name
        first[varying, has] = None
    for varying, has in first:
        corners = product(*(parameter.labels for parameter in parameters))
        keys = [tuple(c if h else None for c, h in zip(at, has, strict=True)) for at in corners]
        if any((varying, key) not in known for key in keys):
            raise InternalError(f"a corner of {varying[0]} has no mode")
        yield tuple(known[varying, key] for key in keys)


def with_constants(
    system: SwitchedSystem, parameters: Sequence[ConstantParameter]
) -> SwitchedSystem:
    """Return the system with parameters that do not change.

    Parameters
    ----------
    system : SwitchedSystem
        With a mode for each corner of them.
    parameters : sequence of ConstantParameter
        That have a range.

    Raises
    ------
    AssemblyError
        If they have too many corners.
    """
    if not parameters:
        return system
    corners = prod(len(parameter.labels) for parameter in parameters) * len(system.modes)
    if corners > MAX_CORNERS:
        raise AssemblyError(
            f"the modes at all corners of the constant parameters are up to {corners}, at most "
            f"{MAX_CORNERS} are looked at",
            remedy="leave out `varies: false` for some of the ranges",
        )
    sets = tuple(constant_sets((mode.name for mode in system.modes), parameters))
    said = tuple(parameter.said for parameter in parameters)
    return replace(
        system, switching=replace(system.switching, fixed_ends=sets, fixed_parameters=said)
    )
