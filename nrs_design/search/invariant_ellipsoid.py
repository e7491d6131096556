"""Search for small invariant ellipsoids: how far a disturbance can push an output (untrusted).

For a fixed share a, the conditions of `nrs_design.proof.evidence.invariant_ellipsoid` are linear in
Q, the multipliers and the square of the level. A few shares are tried; then the level is fixed a
little above the best one, and the conditions are satisfied with as much to spare as possible.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import InvariantEllipsoid
from nrs_design.proof.system import Channel, Output, SwitchedSystem, Time
from nrs_design.search.allowance import Allowance
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.conewise_quadratic import Motions, numerators, separating_coordinates
from nrs_design.search.family import Family, to_floats
from nrs_design.search.rounding import unscale
from nrs_design.search.sdp import maximize_margin, pack, program_cost, symmetric_basis

Array = NDArray[np.float64]

# Shares that are tried, and those around the best of them.
SHARES, REFINED = 12, 6
SMALLEST_SHARE = 0.02
# How far above the least level found the claimed one lies: the nearer, the harder to round.
SLACKS = (1.002, 1.01, 1.03, 1.1)
BITS = (30, 40, 50, 60)
# Steps of a response that is summed for the scale.
STEPS = 4000


@dataclass(frozen=True)
class Problem:
    """The conditions in coordinates where the state, disturbance and output are about one.

    Parameters
    ----------
    time : Time
        Continuous or discrete.
    contact, free : ndarray, shapes (m, n, n + 1) and (f, n, n + 1)
        Maps of state and disturbance.
    pulls : ndarray, shape (p, n)
        Forces of environments that could pull.
    rows : ndarray, shape (r, n)
        The output.
    losable : bool
        Whether contact may be lost.
    """

    time: Time
    contact: Array
    free: Array
    pulls: Array
    rows: Array
    losable: bool

    @property
    def order(self) -> int:
        """Number of states."""
        return int(self.contact.shape[1])

    @property
    def multipliers(self) -> int:
        """How many multipliers there are."""
        if not self.losable:
            return 0
        return len(self.free) * len(self.pulls) if self.time is Time.CONTINUOUS else 1

    def conditions(self, Q: Array, share: float) -> Iterator[tuple[Array, Array, list[Array]]]:
        """Yield for a stack of Q the constant part, the images and those of the multipliers."""
        n = self.order
        inner, last = Q[:, :-1, :-1], np.zeros(n + 1)
        last[n - 1] = 1.0

        def crossing(row: Array) -> Array:
            return np.asarray(np.outer(last, row) + np.outer(row, last))

        nothing = [np.zeros((n + 1, n + 1))] * self.multipliers
        if self.time is Time.CONTINUOUS:
            for A in self.contact:
                yield (*_flow(Q, A, share), nothing)
            for A in self.free:
                block = np.delete(A[:-1], n - 1, axis=1)
                yield (*_flow(inner, block, share), [np.zeros((n, n))] * self.multipliers)
            for k, (i, j) in enumerate(np.ndindex(len(self.free), len(self.pulls))):
                own = list(nothing)
                own[k] = crossing(np.append(self.pulls[j], 0.0))
                yield (*_flow(Q, self.free[i], share), own)
            return
        for A in self.contact:
            yield (*_step(Q, A, Q, share), nothing)
            if self.losable:
                yield (*_step(Q, A[:-1], inner, share), [crossing(A[-1])])
        for A in self.free:
            moved = np.delete(A, n - 1, axis=1)
            none = [np.zeros((n, n))]
            yield (*_step(inner, moved[:-1], inner, share), none)
            yield (*_step(inner, moved, Q, share), none)


def _flow(Q: Array, A: Array, share: float) -> tuple[Array, Array]:
    """Return the constant part and the images of a motion in continuous time."""
    n = Q.shape[-1]
    half = np.zeros((len(Q), n + 1, n + 1))
    half[:, :n] = Q @ A
    form = -(half + np.swapaxes(half, -1, -2))
    form[:, :n, :n] -= share * Q
    constant = np.zeros((n + 1, n + 1))
    constant[n, n] = share
    return constant, form


def _step(before: Array, A: Array, after: Array, share: float) -> tuple[Array, Array]:
    """Return the constant part and the images of a step in discrete time."""
    n = before.shape[-1]
    form = -(A.T @ after @ A)
    form[:, :n, :n] += (1 - share) * before
    constant = np.zeros((n + 1, n + 1))
    constant[n, n] = share
    return constant, form


def search_ellipsoid(
    system: SwitchedSystem, channel: Channel, output: Output, allowance: Allowance
) -> Candidates[InvariantEllipsoid]:
    """Yield ellipsoids that bound an output under a disturbance, the smallest level first.

    Parameters
    ----------
    system : SwitchedSystem
        Stable; with the disturbance and the output.
    channel : Channel
        The disturbance.
    output : Output
        What it moves.
    allowance : Allowance
        Time and memory.

    Raises
    ------
    NotAffordableError
        If time or memory do not suffice.
    """
    family = Family.of(system)
    motions = Motions.of(family)
    raw = _problem(family, motions, channel, output)
    T = separating_coordinates(motions)
    size, level = _reach(raw, T)
    if not (np.isfinite(T).all() and isfinite(size) and isfinite(level) and size * level > 0):
        return OUT_OF_RANGE
    own = _transformed(raw, T, size, level)
    best, share = _best_share(own, family.limit, allowance)
    if not isfinite(best):
        return NO_MARGIN
    for slack in SLACKS:
        found = _solve(own, share, allowance, best * slack**2)
        if found is not None:
            claimed = Fraction(level * float(np.sqrt(best)) * slack).limit_denominator(10**6)
            empty = InvariantEllipsoid(
                channel.name, output.name, (), 0, Fraction(share).limit_denominator(10**6), claimed
            )
            for evidence in _roundings(family, empty, found, T, size):
                yield Candidate(evidence)
    return None


def _roundings(
    family: Family,
    empty: InvariantEllipsoid,
    found: tuple[Array, Array, float],
    T: Array,
    size: float,
) -> Iterator[InvariantEllipsoid]:
    """Yield roundings of a solution in coordinates ``x = size T z`` of the family.

    Unlike for a rate, the scale of Q matters: the set is ``V <= 1``.
    """
    inverse = np.linalg.inv(T) / size
    Q = inverse.T @ found[0] @ inverse
    times = 1 if family.system.time is Time.CONTINUOUS else 2
    multipliers = found[1] / T[-1, -1] ** times / size**2
    exponent = int(np.frexp(np.abs(Q).max())[1])
    for bits in BITS:
        rows, log2 = unscale(np.ldexp(Q, -exponent), family.exponents, bits)
        log2 -= exponent
        if log2 < 0:
            rows, log2 = tuple(tuple(v << -log2 for v in row) for row in rows), 0
        integers = numerators(multipliers, log2 - times * int(family.exponents[-1]))
        yield replace(empty, Q=rows, denominator_log2=log2, multipliers=integers)


def _problem(family: Family, motions: Motions, channel: Channel, output: Output) -> Problem:
    """Join disturbance and output, in the coordinates of the family, with a disturbance up to one.

    The columns of the disturbance are those of the modes in contact, then of the free ones.
    """
    system, d = family.system, family.exponents
    columns = np.ldexp(to_floats(channel.columns)[:, :, 0] * float(channel.bound), -d[None, :])
    maps = np.concatenate([motions.contact, motions.free])
    maps = np.concatenate([maps, columns[:, :, None]], axis=2)
    rows = np.ldexp(np.array([to_floats([q])[0, 0] for q in output.rows]), d[None, :])
    count, losable = len(system.modes), system.contact is not None
    return Problem(system.time, maps[:count], maps[count:], motions.pulls, rows, losable)


def _reach(problem: Problem, T: Array) -> tuple[float, float]:
    """Return how far state and output go under one mode alone, in coordinates ``x = T z``."""
    n = problem.order
    inverse = np.linalg.inv(T)
    size = level = 0.0
    for mode in problem.contact:
        A, x = inverse @ mode[:, :n] @ T, inverse @ mode[:, n]
        dt = 1.0
        if problem.time is Time.CONTINUOUS:
            from scipy.linalg import expm

            dt = 0.1 / max(float(np.abs(np.linalg.eigvals(A)).max()), 1e-9)
            A = expm(A * dt)
        reach = total = 0.0
        rows = problem.rows @ T
        for _ in range(STEPS):
            reach += float(np.linalg.norm(x)) * dt
            total += float(np.abs(rows @ x).max()) * dt
            x = A @ x
        size, level = max(size, reach), max(level, total)
    return size, level


def _transformed(problem: Problem, T: Array, size: float, level: float) -> Problem:
    n, inverse = problem.order, np.linalg.inv(T)

    def moved(maps: Array) -> Array:
        return np.concatenate(
            [inverse @ maps[:, :, :n] @ T, inverse @ maps[:, :, n:] / size], axis=2
        )

    return Problem(
        problem.time,
        moved(problem.contact),
        moved(problem.free),
        problem.pulls @ T,
        problem.rows @ T * (size / level),
        problem.losable,
    )


def _best_share(own: Problem, limit: float, allowance: Allowance) -> tuple[float, float]:
    """Return the least square of the level, relative to the scale, and its share."""
    top = 2 * limit if own.time is Time.CONTINUOUS else 1 - limit**2
    tried: dict[float, float] = {}

    def attempt(shares: Array) -> None:
        for share in shares.tolist():
            if share not in tried:
                found = _solve(own, share, allowance)
                tried[share] = np.inf if found is None else found[2]

    attempt(np.geomspace(SMALLEST_SHARE * top, 0.98 * top, SHARES))
    best = min(tried, key=lambda share: tried[share])
    ratio = (1 / SMALLEST_SHARE) ** (1 / SHARES)
    attempt(np.geomspace(best / ratio, min(best * ratio, 0.99 * top), REFINED))
    best = min(tried, key=lambda share: tried[share])
    return tried[best], best


def _solve(
    own: Problem, share: float, allowance: Allowance, level: float | None = None
) -> tuple[Array, Array, float] | None:
    """Minimize the square of the level; or, for a given one, leave as much to spare as possible."""
    n, count = own.order, own.multipliers
    basis = symmetric_basis(n)
    k = len(basis)
    blocks: list[tuple[Array, Array]] = []
    for constant, images, others in own.conditions(basis, share):
        spare = np.eye(len(constant)) if level is not None else np.zeros_like(constant)
        stack = np.concatenate([images, np.array(others).reshape(-1, *constant.shape)])
        blocks.append((constant, np.concatenate([stack, -spare[None]])))
    for row in own.rows:
        constant, images = np.zeros((n + 1, n + 1)), np.zeros((k + count + 1, n + 1, n + 1))
        constant[:n, n] = constant[n, :n] = row
        images[:k, :n, :n] = basis
        if level is None:
            images[-1, n, n] = -1.0
        else:
            constant[n, n] = level
            images[-1] = -np.eye(n + 1)
        blocks.append((constant, images))
    for i in range(count):
        images = np.zeros((k + count + 1, 1, 1))
        images[k + i] = 1.0
        blocks.append((np.zeros((1, 1)), images))
    if level is not None:
        images = np.zeros((k + count + 1, 1, 1))
        images[-1] = -1.0
        blocks.append((np.ones((1, 1)), images))
    unknowns = k + count + 1
    cost = program_cost(unknowns, unknowns, [(len(c), unknowns) for c, _ in blocks])
    allowance.take(cost, f"a program of {unknowns} unknowns and {len(blocks)} blocks")
    x = maximize_margin(
        np.concatenate([-pack(images).T for _, images in blocks]),
        np.concatenate([pack(constant) for constant, _ in blocks]),
        [len(constant) for constant, _ in blocks],
        time_limit=allowance.left,
    )
    if x is None or (level is not None and x[-1] <= 0) or (level is None and x[-1] >= 0):
        return None
    Q = np.asarray(np.tensordot(x[:k], basis, axes=1))
    return Q, x[k : k + count], float(-x[-1])
