"""The system at one value of a parameter that is unknown but constant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.switching import Stay, Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import exact_text


def system_at(system: SwitchedSystem, share: Fraction) -> SwitchedSystem:
    """TRUSTED: return the modes at one value of the constant parameter, under the same rules.

    A switch is allowed, and a stay long and short enough, if it is so at both ends of the
    parameter. Resets are left out.

    Parameters
    ----------
    system : SwitchedSystem
        With the two ends of the parameter in `Switching.fixed_ends`.
    share : Fraction
        From 0 (low end) to 1 (high end): the modes are ``(1 - share) low + share high``.

    Raises
    ------
    KeyError
        If an end is no mode of the system.
    """
    matrices = {mode.name: mode.A.fractions() for mode in system.modes}
    pairs = [(name_between(low, high), low, high) for low, high in system.switching.fixed_ends]
    modes = []
    for name, low, high in pairs:
        rows = [
            [(1 - share) * a + share * b for a, b in zip(*ends, strict=True)]
            for ends in zip(matrices[low], matrices[high], strict=True)
        ]
        modes.append(Mode(name, RationalMatrix.from_rows(rows)))
    allowed = system.switching.transitions
    transitions = None
    if allowed is not None:
        listed = frozenset(allowed)
        transitions = tuple(
            (source, target)
            for source, *ends in pairs
            for target, *others in pairs
            if source != target and listed.issuperset(zip(ends, others, strict=True))
        )
    own = {name for name, _ in system.switching.stays}
    switching = replace(
        system.switching,
        transitions=transitions,
        resets=(),
        fixed_ends=(),
        fixed_parameter=None,
        stays=tuple(
            (name, _common_stay(system.switching, ends))
            for name, *ends in pairs
            if own.intersection(ends)
        ),
    )
    return system.with_modes(tuple(modes), system.states, switching)


def _common_stay(switching: Switching, modes: Sequence[str]) -> Stay:
    """Return what all modes allow."""
    stays = [switching.stay(mode) for mode in modes]
    ends = [stay.longest for stay in stays if stay.longest is not None]
    return Stay(max(stay.shortest for stay in stays), min(ends, default=None))


def value_text(system: SwitchedSystem, share: Fraction) -> str:
    """Say which value of the constant parameter it is, such as ``At k = 12.5``."""
    parameter = system.switching.fixed_parameter
    if parameter is None:
        return f"At {share} of the way from the low to the high end of the parameter"
    value = parameter.low + share * (parameter.high - parameter.low)
    return f"At {parameter.name} = {exact_text(value)}"


def name_between(low: str, high: str) -> str:
    """Name what two ends have in common, such as ``a`` for ``a/m-min`` and ``a/m-max``."""
    same = [a for a, b in zip(low.split("/"), high.split("/"), strict=False) if a == b]
    return "/".join(same) or f"{low} to {high}"
