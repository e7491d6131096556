"""The system at one value of parameters that are unknown but constant."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from math import prod

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.switching import FixedParameter, Stay, Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import exact_text


def find_odd_shares(switching: Switching, shares: Sequence[Fraction]) -> str | None:
    """TRUSTED: say why shares are not those of a value that constant parameters attain, or None."""
    sets, parameters = switching.fixed_ends, switching.fixed_parameters
    if not sets or not shares:
        return "no parameter is constant, or no share is given"
    if any(len(corners) != 2 ** len(shares) for corners in sets):
        return "there is not one share for each constant parameter, or values are enclosed only"
    if any(parameter.enclosed for parameter in parameters):
        return "values are enclosed only"
    if parameters and len(parameters) != len(shares):
        return "there is not one share for each constant parameter"
    return None if all(0 <= s <= 1 for s in shares) else "a share is not between 0 and 1"


def corner_weights(shares: Sequence[Fraction]) -> list[Fraction]:
    """TRUSTED: return the weights of the corners at a value, the last parameter turning fastest.

    A share is how far a parameter is on the way from its low to its high end.
    """
    return [prod(factors, start=Fraction(1)) for factors in product(*((1 - s, s) for s in shares))]


def system_at(system: SwitchedSystem, shares: Sequence[Fraction]) -> SwitchedSystem:
    """TRUSTED: return the modes at one value of the constant parameters, under the same rules.

    A switch is allowed, and a stay long and short enough, if it is so at all corners of the
    parameters, those of `Switching.fixed_ends`. Resets are left out. Shares go from 0 (low end) to
    1 (high end). A KeyError if an end is no mode, a ValueError if there is not one share for each
    parameter.
    """
    if (odd := find_odd_shares(system.switching, shares)) is not None:
        raise ValueError(odd)
    weights = corner_weights(shares)
    matrices = {mode.name: mode.A.fractions() for mode in system.modes}
    sets = [(name_between(*corners), *corners) for corners in system.switching.fixed_ends]
    modes = []
    for name, *corners in sets:
        rows = [
            [_mean(weights, entries) for entries in zip(*row, strict=True)]
            for row in zip(*(matrices[corner] for corner in corners), strict=True)
        ]
        modes.append(Mode(name, RationalMatrix.from_rows(rows)))
    switches = system.switching.transitions
    transitions = None
    if switches is not None:
        pairs = frozenset(switches)
        transitions = tuple(
            (source, target)
            for source, *ends in sets
            for target, *others in sets
            if source != target and pairs.issuperset(zip(ends, others, strict=True))
        )
    own = {name for name, _ in system.switching.stays}
    switching = replace(
        system.switching,
        transitions=transitions,
        resets=(),
        fixed_ends=(),
        fixed_parameters=(),
        stays=tuple(
            (name, _common_stay(system.switching, ends))
            for name, *ends in sets
            if own.intersection(ends)
        ),
    )
    enclosures = tuple(_enclosures_at(system, sets))
    return system.with_modes(tuple(modes), system.states, switching, enclosures)


def _enclosures_at(
    system: SwitchedSystem, sets: Sequence[tuple[str, ...]]
) -> Iterator[tuple[str, ...]]:
    """TRUSTED: yield what the sets of modes are at a value; they have one weight at all corners.

    Where sets at the corners are not of one size, or a mode is not at one place in each of them,
    one is yielded that no system has.
    """
    places = {
        name: (k, i, len(names))
        for k, names in enumerate(system.enclosures)
        for i, name in enumerate(names)
    }
    found: dict[tuple[int, ...], dict[int, str]] = {}
    sizes: dict[tuple[int, ...], int] = {}
    for name, *corners in sets:
        at = [places[corner] for corner in corners if corner in places]
        if not at:
            continue
        if len(at) < len(corners) or len({(i, size) for _, i, size in at}) > 1:
            yield ()
            return
        key = tuple(k for k, _, _ in at)
        found.setdefault(key, {})[at[0][1]] = name
        sizes[key] = at[0][2]
    for key, names in found.items():
        yield tuple(names[i] for i in sorted(names)) if len(names) == sizes[key] else ()


def _common_stay(switching: Switching, modes: Sequence[str]) -> Stay:
    """Return what all modes allow."""
    stays = [switching.stay(mode) for mode in modes]
    ends = [stay.longest for stay in stays if stay.longest is not None]
    return Stay(max(stay.shortest for stay in stays), min(ends, default=None))


def _mean(weights: Sequence[Fraction], entries: Sequence[Fraction]) -> Fraction:
    if all(entry == entries[0] for entry in entries):
        return entries[0]
    return sum((w * entry for w, entry in zip(weights, entries, strict=True)), Fraction(0))


def value_at(parameter: FixedParameter, share: Fraction) -> Fraction:
    """Return the value of a constant parameter at a share of the way between its ends."""
    low, high = parameter.low, parameter.high
    if parameter.inverse:
        return 1 / ((1 - share) / low + share / high)
    return low + share * (high - low)


def value_text(system: SwitchedSystem, shares: Sequence[Fraction]) -> str:
    """Return the value of the constant parameters in words, such as ``At k = 12.5``."""
    parameters = system.switching.fixed_parameters
    if not parameters:
        ways = " and ".join(map(str, shares))
        return f"At {ways} of the way from the low to the high end of the parameter"
    values = (
        f"{p.name} = {exact_text(value_at(p, share))}{' ' * bool(p.unit)}{p.unit}"
        for p, share in zip(parameters, shares, strict=True)
    )
    return f"At {' and '.join(values)}"


def name_between(*corners: str) -> str:
    """Name what corners have in common, such as ``a`` for ``a/m-min`` and ``a/m-max``."""
    parts = zip(*(corner.split("/") for corner in corners), strict=False)
    same = [labels[0] for labels in parts if len({*labels}) == 1]
    return "/".join(same) or " to ".join(dict.fromkeys(corners))
