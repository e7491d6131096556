"""The switched system in a certificate file: its exact modes and its rules of switching."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from nrs_design.proof.evidence.fields import read_object, written
from nrs_design.proof.exact import bit_length
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem

# The word for switching without rules.
WITHOUT_RULES = "arbitrary"
# Deciding a form for every mode takes about rows^3 steps each on their numbers: a minute at this.
MAX_FAMILY_WORK = 10**10
# There is a function for every step of a round.
MAX_ROUND = 100


def system_fields(system: SwitchedSystem) -> dict[str, Any]:
    """Return what a certificate says about its system, apart from the name.

    Raises
    ------
    ValueError
        If a number of a mode or a reset has more digits than a file holds.
    """
    fields: dict[str, Any] = written(system)
    del fields["name"]
    return {**fields, "switching": fields.get("switching", WITHOUT_RULES)}


def read_system(name: str, fields: Mapping[str, Any]) -> SwitchedSystem:
    """Read the system that `system_fields` has written.

    Parameters
    ----------
    name : str
        Of the spec that it comes from.
    fields : mapping
        Of a certificate; other keys are not looked at.

    Raises
    ------
    KeyError, TypeError, ValueError
        If a field is missing or malformed, a matrix has no shape or no positive denominator, two
        modes have one name, or the modes are too large to check.
    """
    own = {key: value for key, value in fields.items() if key in SwitchedSystem.__slots__}
    own |= {"name": name}
    if fields["switching"] == WITHOUT_RULES:
        del own["switching"]
    system = read_object(SwitchedSystem, own)
    _check_modes(system.modes, len(system.states))
    if system.contact is not None:
        _check_work(system.contact.free, 1 + len(system.contact.pulls))
    if system.clock is not None and not 2 <= system.clock.length <= MAX_ROUND:
        raise ValueError(f"a round has from 2 to {MAX_ROUND} steps")
    return system


def _check_modes(modes: Sequence[Mode], states: int) -> None:
    sizes = [len(mode.A.numerators) for mode in modes]
    if len({mode.name for mode in modes}) < len(modes):
        raise ValueError("two modes have the same name")
    if any(mode.A.shape[0] != mode.A.shape[1] for mode in modes):
        raise ValueError("a mode is not square")
    if not sizes or max(sizes) != states:
        raise ValueError("the largest mode does not have the states that are named")
    _check_work(modes)


def _check_work(modes: Iterable[Mode], times: int = 1) -> None:
    matrices = (mode.A.numerators for mode in modes)
    if times * sum(len(N) ** 3 * bit_length(N) for N in matrices) > MAX_FAMILY_WORK:
        raise ValueError("the modes are too large to check")
