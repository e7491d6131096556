"""TRUSTED: the steps of a system that keeps rules of switching: the place is the mode in force.

A mode is left after a stay, by a switch that may move the state. A stay is followed in two ways:
in steps of its own (a flow, or single steps) until the shortest stay is left, which is one step
together with the switch; or, in modes that must be left, by one step for every length that it may
have. Then the mode itself may grow.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import comb
from typing import Any

from nrs_design.proof.exact import MAX_WORK, IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix, identity
from nrs_design.proof.matrix import multiply as rational_product
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import Stays, Step, flow_step, map_step
from nrs_design.proof.switching import Edge, Stay
from nrs_design.proof.system import SwitchedSystem

MAX_DWELL_STEPS = 4096
MAX_PIECES = 4096
MAX_ENCLOSED = 2**18
MAX_SWITCHES = 2**20
MAX_POWER_BITS = 10**6


@dataclass(frozen=True, slots=True)
class EnclosedStep:
    """A stay in continuous time, of any length in a range, and then a switch."""

    where: str
    edge: Edge
    begin: Fraction  # The shortest and the longest length, in s
    end: Fraction
    facts: tuple[str, ...] = ()
    is_flow: bool = False
    time: int = 1

    @property
    def mode(self) -> str:
        """The mode that is left."""
        return self.edge.source.name

    @property
    def source(self) -> str:
        """The place before."""
        return self.edge.source.name

    @property
    def target(self) -> str:
        """The place after."""
        return self.edge.target.name

    def form(self, before: IntegerMatrix, after: IntegerMatrix, rate: Fraction) -> IntegerMatrix:
        """Return integers below ``T' (F - E' G E) T`` for all its lengths, times a positive number.

        F is before, G after; E is the exponential of the mode plus the rate, in 1/s, and then the
        switch, in balls. With B its derivative, m the middle of the lengths, h half of their range
        and d the way from m, what comes after is ``g(d) = exp(C d)' g(0) exp(C d)`` with
        ``C = T^-1 B T``. Of second order in h, it is between the ends: with ``s = (1 + d/h)/2`` and
        the second derivative g'', ``g(d) = (1 - s) g(-h) + s g(h) - r g''`` with
        ``0 <= r <= h^2/2``, entry by entry, each at a length of its own. So what is positive
        definite at both ends for every such r and g'' is so in between: both are the blocks of the
        form. The form of F is nearly that of the identity for T, so the balls are no larger than it
        moves; what is positive definite for any T is without it.
        """
        from nrs_design.proof.enclosure import (
            balls,
            between_zero_and,
            exponential,
            lower_integers,
            precision,
        )

        middle, half = (self.begin + self.end) / 2, (self.end - self.begin) / 2
        with precision():
            B = shifted(self.edge.source.A, rate)
            E = exponential(B, middle, middle)
            if self.edge.map is not None:
                E = balls(self.edge.map) * E
            F, G = (balls(RationalMatrix(tuple(map(tuple, Q)))) for Q in (before, after))
            left = E.transpose() * G * E
            if half == 0:
                return lower_integers(F - left)
            T, C, motion, *ways = _own_coordinates(B, tuple(map(tuple, before)), half)
            F, left = (T.transpose() * Q * T for Q in (F, left))
            slope = C.transpose() * left + left * C
            curvature = motion.transpose() * (C.transpose() * slope + slope * C) * motion
            F += curvature * between_zero_and(half**2 / 2)
            ends = (lower_integers(F - way.transpose() * left * way) for way in ways)
            return _in_blocks(*ends)


def _in_blocks(first: IntegerMatrix, second: IntegerMatrix) -> IntegerMatrix:
    """Return the form of two forms, each on states of its own."""
    nothing = [0] * len(first)
    return [[*row, *nothing] for row in first] + [[*nothing, *row] for row in second]


@lru_cache(maxsize=64)
def _own_coordinates(
    B: RationalMatrix, form: tuple[tuple[int, ...], ...], half: Fraction
) -> tuple[Any, ...]:
    """Return coordinates T in which a form is nearly round, and what moves the state there.

    That is ``C = T^-1 B T``; then ``exp(C d)`` for all d from ``-half`` to ``half``, at the first
    of them, and at the last.
    """
    from nrs_design.proof.enclosure import (
        ball_around,
        balls,
        exponential_near_zero,
        unit_coordinates,
    )

    T, h = unit_coordinates(balls(RationalMatrix(form))), ball_around(half)
    C = T.inv() * balls(B) * T
    return T, C, exponential_near_zero(C, half), (C * -h).exp(), (C * h).exp()


def steps_of_stays(
    system: SwitchedSystem, stays: Stays, grain: Callable[[int], int]
) -> Iterator[Step | EnclosedStep]:
    """Yield every step of a system with the modes, of any sizes, as places.

    `find_odd_stays` finds nothing; `grain` is the unit that those of a map of so many steps are
    multiples of.
    """
    flows, durations = system.time is Time.CONTINUOUS, system.stays()
    for mode in system.modes:
        if mode.name not in stays.leaving:
            description = f"in mode {mode.name}"
            if flows:
                yield flow_step(description, mode.name, mode.name, mode.A)
            else:
                yield map_step(description, mode.name, (mode.name, mode.name), mode.A, grain(1))
    for edge in system.edges():
        name, stay = edge.source.name, durations[edge.source.name]
        left = name in stays.leaving
        stay_text = "some stay" if left else "the dwell time"
        description = f"after {stay_text}, from {name} to {edge.target.name}"
        if not flows:
            last = stay.longest if left and stay.longest is not None else stay.shortest
            for count in range(int(stay.shortest), int(last) + 1):
                jump = power(edge.source.A, count)
                if edge.map is not None:
                    rows = rational_product(edge.map.fractions(), jump.fractions())
                    jump = RationalMatrix.from_rows(rows)
                yield map_step(
                    description, name, (name, edge.target.name), jump, grain(count), count
                )
        elif left and stay.longest is not None:
            width = (stay.longest - stay.shortest) / stays.pieces
            for k in range(stays.pieces):
                begin = stay.shortest + k * width
                yield EnclosedStep(description, edge, begin, begin + width)
        elif stay.shortest > 0:
            yield EnclosedStep(description, edge, stay.shortest, stay.shortest)
        else:
            jump = edge.map or identity(edge.source.A.shape[0])
            moment = f"at the switch from {name} to {edge.target.name}"
            yield map_step(moment, name, (name, edge.target.name), jump, 1, time=0)


def find_odd_stays(system: SwitchedSystem, stays: Stays, bits: int, degree: int = 1) -> str | None:
    """Say why stays cannot be followed so, or None: switches fit, stays are few, short and whole.

    `bits` are those of the rate, to the power of the degree of the monomials.
    """
    if (odd := _find_odd_switch(system)) is not None:
        return odd
    every, leaving = system.stays(), stays.leaving
    if len(set(leaving)) < len(leaving) or not set(leaving) <= every.keys():
        return "the modes that must be left are not those of the system"
    if any(every[name].longest is None for name in leaving):
        return "a mode in which the function need not decrease has no longest dwell time"
    if not set(leaving) <= {edge.source.name for edge in system.edges()}:
        return "no switch leads from a mode that must be left"
    times = [stay.shortest for stay in every.values()]
    times += [longest for stay in every.values() if (longest := stay.longest) is not None]
    if max(times) > MAX_DWELL_STEPS:
        return "the dwell time is too long"
    discrete = system.time is Time.DISCRETE
    if discrete and any(time.denominator != 1 for time in times):
        return "the dwell time is not a whole number of steps"
    enclosed = stays.pieces * sum(edge.source.name in leaving for edge in system.edges())
    if not 1 <= stays.pieces <= MAX_PIECES or enclosed > MAX_ENCLOSED:
        return "the stays are enclosed in too few or too many pieces"
    if discrete and _power_is_too_large(system, leaving, bits, degree):
        return "the dwell time is too long for such large numbers"
    return None


def _find_odd_switch(system: SwitchedSystem) -> str | None:
    """Say which switch has no reset that fits; or that they are so many that it takes minutes."""
    count, transitions = len(system.modes), system.switching.transitions
    switches = count * (count - 1) if transitions is None else len(transitions)
    switches += len(system.switching.resets)
    # To find those that are allowed, all pairs are looked at.
    pairs = count**2 // 16
    if max(switches, pairs) > MAX_SWITCHES or switches * system.order**3 > MAX_WORK:
        return "there are too many switches to check"
    for edge in system.edges():
        given = edge.source.A.shape if edge.map is None else edge.map.shape
        if given != (edge.target.A.shape[0], edge.source.A.shape[0]):
            switch = f"from {edge.source.name} to {edge.target.name}"
            return f"the switch {switch} has no fitting reset"
    return None


def _power_is_too_large(
    system: SwitchedSystem, leaving: tuple[str, ...], bits: int, degree: int
) -> bool:
    """Tell whether the powers would take more than some seconds, one by one or all together."""
    numbers = [v for mode in system.modes for row in mode.A.numerators for v in row]
    numbers += [mode.A.denominator for mode in system.modes]
    bits = max(bits, *(degree * abs(v).bit_length() for v in numbers))
    every, total, largest = system.stays(), 0, 0
    for edge in system.edges():
        stay: Stay = every[edge.source.name]
        if edge.source.name in leaving and stay.longest is not None:
            total += sum(range(int(stay.shortest), int(stay.longest) + 1))
            largest = max(largest, int(stay.longest))
        largest = max(largest, int(stay.shortest))
    work = comb(system.order + degree - 1, degree) ** 3 * bits
    return largest * bits > MAX_POWER_BITS or largest * work > MAX_WORK or total * work > MAX_WORK


# Cached, as every switch from a mode needs it.
@lru_cache(maxsize=256)
def power(A: RationalMatrix, exponent: int) -> RationalMatrix:
    """Return the power of a square matrix."""
    result = identity(A.shape[0])
    for bit in bin(exponent)[2:]:
        result = RationalMatrix.from_rows(rational_product(result.fractions(), result.fractions()))
        if bit == "1":
            result = RationalMatrix.from_rows(rational_product(A.fractions(), result.fractions()))
    return result


# Cached, as every length of a stay needs it.
@lru_cache(maxsize=256)
def shifted(A: RationalMatrix, rate: Fraction) -> RationalMatrix:
    """Return ``A + rate I``."""
    rows = A.fractions()
    for i, row in enumerate(rows):
        row[i] += rate
    return RationalMatrix.from_rows(rows)
