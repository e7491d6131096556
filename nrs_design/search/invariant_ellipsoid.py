"""Search for small invariant ellipsoids: how far a disturbance can push an output (untrusted).

For a fixed share a, the conditions of `nrs_design.proof.evidence.invariant_ellipsoid` are linear in
Q, the multipliers and the square of the level. A few shares are tried; then the level is fixed a
little above the best one, and the conditions are satisfied with as much to spare as possible.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.evidence import InvariantEllipsoid
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.disturbed import (
    DisturbedProblem,
    DisturbedSolution,
    balanced,
    problem_of,
    roundings,
    transformed,
)
from nrs_design.search.family import Family
from nrs_design.search.motions import separating_coordinates
from nrs_design.search.sdp import solve_blocks, symmetric_basis
from nrs_design.work import Allowance

Array = NDArray[np.float64]

# Shares that are tried, and steps of a golden section around the best of them.
SHARES, REFINED = 6, 4
GOLDEN = (5**0.5 - 1) / 2
SMALLEST_SHARE = 0.02
# How far above the least level found the claimed one lies: the nearer, the harder to round.
SLACKS = (1.002, 1.01, 1.03, 1.1)
# Steps of a response that is summed for the scale.
STEPS = 4000


def search_ellipsoid(
    system: SwitchedSystem, channels: Sequence[Channel], output: Output, allowance: Allowance
) -> Candidates[InvariantEllipsoid]:
    """Yield ellipsoids that bound an output under disturbances at once, the smallest level first.

    The system is stable. Where the arithmetic rounds, ellipsoids that cover that come before
    others.
    """
    family = Family.of(system)
    frame = Frame.of(family, channels, output)
    if frame is None:
        return OUT_OF_RANGE
    whole, units = frame.problem(family, channels, output)
    exact = whole.without_roundings().distinct()

    def attempt(share: float) -> float:
        found = least_level(exact, share, allowance)
        return np.inf if found is None else found.last

    best, share = best_share(attempt, family.limit, system.time)
    if not isfinite(best):
        return NO_MARGIN
    names = tuple(channel.name for channel in channels)
    for own in [whole.distinct(), exact] if system.roundings else [exact]:
        for slack in SLACKS:
            found = least_level(own, share, allowance, best * slack**2)
            if found is None:
                continue
            empty = InvariantEllipsoid(
                names,
                output.name,
                (),
                0,
                tuple(map(seven_digits, found.shares.tolist())),
                seven_digits(frame.level * float(np.sqrt(best)) * slack),
            )
            for numbers in roundings(family, found, frame.T, units, frame.size):
                yield Candidate(replace(empty, **numbers))
    return None


def seven_digits(number: float) -> Fraction:
    """Return a number with seven digits."""
    return Fraction(f"{number:.6e}")


@dataclass(frozen=True)
class Frame:
    """Coordinates ``x = size T z`` and a unit of the output, in which both are about one."""

    T: Array
    size: float
    level: float

    @classmethod
    def of(cls, family: Family, channels: Sequence[Channel], output: Output) -> Frame | None:
        """Return the frame of a system; None if it is beyond floating point."""
        T = separating_coordinates(family)
        size, level = reach_and_level(problem_of(family, channels, output), T)
        found = np.isfinite(T).all() and isfinite(size) and isfinite(level) and size * level > 0
        return cls(T, size, level) if found else None

    def problem(
        self, family: Family, channels: Sequence[Channel], output: Output
    ) -> tuple[DisturbedProblem, Array]:
        """Return the conditions in these coordinates, and the units that `balanced` gives."""
        raw = problem_of(family, channels, output)
        return balanced(transformed(raw, self.T, self.size, self.level))


def reach_and_level(problem: DisturbedProblem, T: Array) -> tuple[float, float]:
    """Return how far state and output go under one mode alone, in coordinates ``x = T z``."""
    n = problem.order
    inverse = np.linalg.inv(T)
    size = level = 0.0
    for mode in problem.contact:
        A, x = inverse @ mode[:, :n] @ T, inverse @ mode[:, n : n + problem.disturbances]
        dt = 1.0
        if problem.time is Time.CONTINUOUS:
            from scipy.linalg import expm

            dt = 0.1 / max(float(np.abs(np.linalg.eigvals(A)).max()), 1e-9)
            A = expm(A * dt)
        reach = total = 0.0
        rows = problem.rows @ T
        for _ in range(STEPS):
            reach += float(np.linalg.norm(x)) * dt
            total += float(np.abs(rows @ x).sum(axis=1).max()) * dt
            x = A @ x
        size, level = max(size, reach), max(level, total)
    return size, level


def largest_share(limit: float, time: Time) -> float:
    """Return the share that no form can beat."""
    return 2 * limit if time is Time.CONTINUOUS else 1 - limit**2


def best_share(attempt: Callable[[float], float], limit: float, time: Time) -> tuple[float, float]:
    """Return the least value found, and the share that gives it."""
    top = largest_share(limit, time)
    tried: dict[float, float] = {}

    def value(share: float) -> float:
        if share not in tried:
            tried[share] = attempt(share)
        return tried[share]

    shares = np.geomspace(SMALLEST_SHARE * top, 0.98 * top, SHARES).tolist()
    k = min(range(SHARES), key=lambda i: value(shares[i]))
    low, high = np.log(shares[max(k - 1, 0)]), np.log(shares[min(k + 1, SHARES - 1)])
    for _ in range(REFINED):
        left, right = high - (high - low) * GOLDEN, low + (high - low) * GOLDEN
        if value(float(np.exp(left))) <= value(float(np.exp(right))):
            high = right
        else:
            low = left
    best = min(tried, key=lambda share: tried[share])
    return tried[best], best


def least_level(
    own: DisturbedProblem, share: float, allowance: Allowance, level: float | None = None
) -> DisturbedSolution | None:
    """Minimize the square of the level; or, for a given one, leave as much to spare as possible.

    In coordinates of like size, with outputs over a scale, for a share of all disturbances
    together.
    """
    n, lost, c, basis = own.order, own.multipliers, own.disturbances, symmetric_basis(own.order)
    k, unknowns = len(basis), len(basis) + lost + c + own.errors + 1
    blocks = own.condition_blocks(basis, share, 0.0 if level is None else 1.0)
    for row in own.rows:
        constant, images = own.bordered(row, basis)
        if level is None:
            images[-1, n, n] = -1.0
        else:
            constant[n, n] = level
            images[-1] = -np.eye(n + 1)
        blocks.append((constant, images))
    # Multipliers and shares are not negative, and the shares add up to what they may.
    bounds = [(0.0, {i: 1.0}) for i in range(k, unknowns - 1)]
    bounds.append((share, dict.fromkeys(range(k + lost, k + lost + c), -1.0)))
    if level is not None:
        bounds.append((1.0, {unknowns - 1: -1.0}))
    for number, weights in bounds:
        images = np.zeros((unknowns, 1, 1))
        for i, weight in weights.items():
            images[i] = weight
        blocks.append((np.full((1, 1), number), images))
    x = solve_blocks(blocks, allowance)
    if x is None or (level is not None and x[-1] <= 0) or (level is None and x[-1] >= 0):
        return None
    Q = np.asarray(np.tensordot(x[:k], basis, axes=1))
    crossings, shares, taus = np.split(x[k:-1], [lost, lost + c])
    return DisturbedSolution(Q, crossings, shares, taus, float(-x[-1]))
