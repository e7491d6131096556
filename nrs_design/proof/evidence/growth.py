"""TRUSTED: what repeating a sequence of steps does to a state, in enclosures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from nrs_design.proof.contact import Flights
from nrs_design.proof.enclosure import all_between, balls, eigenvector, exponential, precision
from nrs_design.proof.exact import TooLargeError
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem

# Each mode with its time in s, or number of steps.
Steps = tuple[tuple[str, Fraction], ...]
MAX_DOUBLINGS = 60
# Longer numbers in an exponential would keep a check in Python integers busy for ever.
MAX_GROWTH = 2 ** (2**16)


def has_growing_trace(
    system: SwitchedSystem, steps: Steps, edges: Sequence[int], doublings: int
) -> bool:
    """TRUSTED: decide whether ``|tr M^k| > n`` is certain, k two to the power of doublings.

    M is the `monodromy`.
    """
    with precision():
        power = monodromy(system, steps, edges)
        for _ in range(doublings):
            power = power * power
        trace = sum((power[i, i] for i in range(system.order)), start=0 * power[0, 0])
        return bool(abs(trace) > system.order)


def attained(system: SwitchedSystem, mode: str) -> Any:
    """TRUSTED: enclose what is attained of a mode, at flint's current precision.

    That is the mode itself, or some combination of the set that it is in.
    """
    modes = {mode.name: mode.A for mode in system.every_mode}
    return all_between(balls(modes[name]) for name in system.enclosure_of(mode))


def grows_throughout(matrices: Iterable[RationalMatrix]) -> bool:
    """TRUSTED: decide whether no combination of some matrices is Schur, by traces of powers.

    All eigenvalues at most one in modulus would give ``|tr M^k| <= n`` for every k.
    """
    with precision():
        power = all_between(map(balls, matrices))
        n = power.nrows()
        for _ in range(MAX_DOUBLINGS + 1):
            trace = sum((power[i, i] for i in range(n)), start=0 * power[0, 0])
            if trace.is_finite() and abs(trace) > n:
                return True
            power = power * power
    return False


def monodromy(system: SwitchedSystem, steps: Steps, edges: Sequence[int] = ()) -> Any:
    """TRUSTED: enclose the matrix of a periodic signal, at flint's current precision.

    Steps are modes with times in s, or steps. Every step is followed by the reset of the switch to
    the next mode, the last one by that of the switch back to the first; `edges` says which of
    several, by default the first. A `TooLargeError` if a mode grows too far in its time.
    """
    modes, maps = {mode.name: mode.A for mode in system.every_mode}, system.switching.maps()
    names = [name for name, _ in steps]
    product: Any = None
    counted = system.time is Time.DISCRETE
    enclosed = {name: attained(system, name) for name in {*names}} if counted else {}
    for k, (name, time) in enumerate(steps):
        switch = (name, names[(k + 1) % len(names)])
        factor = enclosed[name] ** int(time) if counted else exponential(modes[name], time, time)
        if not counted and not all(abs(entry) < MAX_GROWTH for entry in factor.entries()):
            raise TooLargeError(f"mode {name} grows too far to check")
        product = factor if product is None else factor * product
        if switch in maps:
            product = balls(maps[switch][edges[k] if edges else 0]) * product
    return product


def growth_matrix(system: SwitchedSystem, steps: Steps) -> Any:
    """TRUSTED: enclose the matrix of which a motion that grows in contact is an eigenvector.

    In continuous time that is the one mode itself: along an eigenvector no sign ever changes.
    """
    if system.time is Time.DISCRETE:
        return monodromy(system, steps)
    return next(balls(mode.A) for mode in system.every_mode if mode.name == steps[0][0])


def grows_in_contact(system: SwitchedSystem, steps: Steps, low: Fraction, high: Fraction) -> bool:
    """TRUSTED: decide whether an eigenvector that grows and keeps the signs of contact is certain.

    Along a sequence of whole numbers of steps; its eigenvalue must be between low and high.
    """
    with precision():
        v = eigenvector(growth_matrix(system, steps), low, high)
        turned = set() if v is None else {False, True}
        for name, count in steps:
            A = attained(system, name)
            for _ in range(int(count) if turned else 0):
                turned &= _signs(system, name, v)
                v = A * v
        return bool(turned)


def _signs(system: SwitchedSystem, mode: str, v: Any) -> set[bool]:
    """TRUSTED: return for which of v (False) and -v (True) a mode may be in force."""
    flights, contact = system.flights, system.contact
    if contact is not None:
        touching, flying = ([mode.name for mode in part] for part in (system.modes, system.free))
        flights = Flights(tuple(touching), tuple(flying), contact.pulls)
    assert flights is not None  # The loss of contact is to be covered
    delta = v[system.order - 1, 0]
    forces = [(balls(row) * v)[0, 0] for row in flights.pulls]
    if mode in flights.touching:
        felt = [delta, *forces]
        return {turned for turned in (False, True) if all(_is_positive(f, turned) for f in felt)}
    if mode in flights.flying:
        return {
            turned
            for turned in (False, True)
            if _is_positive(delta, not turned)
            or (forces and all(_is_positive(force, not turned) for force in forces))
        }
    return {False, True}


def _is_positive(ball: Any, turned: bool) -> bool:
    """Tell whether a number, or its negative, is certainly positive."""
    return bool(ball < 0) if turned else bool(ball > 0)
