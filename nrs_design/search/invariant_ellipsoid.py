"""Search for small invariant ellipsoids: how far a disturbance can push an output (untrusted).

For a fixed share a, the conditions of `nrs_design.proof.evidence.invariant_ellipsoid` are linear in
Q, the multipliers and the square of the level. A few shares are tried; then the level is fixed a
little above the best one, and the conditions are satisfied with as much to spare as possible.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import InvariantEllipsoid
from nrs_design.proof.system import Channel, Contact, Output, SwitchedSystem, Time
from nrs_design.search.allowance import Allowance
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.conewise_quadratic import (
    Motions,
    in_numerators,
    multiplied,
    numerators,
    separating_coordinates,
)
from nrs_design.search.family import Family, to_floats
from nrs_design.search.rounding import unscale
from nrs_design.search.sdp import maximize_margin, pack, program_cost, symmetric_basis

Array = NDArray[np.float64]

# Shares that are tried, and steps of a golden section around the best of them.
SHARES, REFINED = 6, 4
GOLDEN = (5**0.5 - 1) / 2
SMALLEST_SHARE = 0.02
# How far above the least level found the claimed one lies: the nearer, the harder to round.
SLACKS = (1.002, 1.01, 1.03, 1.1)
BITS = (30, 40, 50, 60)
# Steps of a response that is summed for the scale.
STEPS = 4000


@dataclass(frozen=True)
class Problem:
    """The conditions in coordinates where the state, disturbances and output are about one.

    Parameters
    ----------
    time : Time
        Continuous or discrete.
    contact, free : ndarray, shapes (m, n, n + c + r) and (f, n, n + c + r)
        Maps of state, c disturbances and r roundings.
    contact_sizes, free_sizes : ndarray, shapes (m, r, n + c) and (f, r, n + c)
        How large the roundings are at most.
    pulls : ndarray, shape (p, n)
        Forces of environments that could pull.
    rows : ndarray, shape (q, n)
        The output.
    disturbances : int
        The c.
    losable : bool
        Whether contact may be lost.
    """

    time: Time
    contact: Array
    free: Array
    contact_sizes: Array
    free_sizes: Array
    pulls: Array
    rows: Array
    disturbances: int
    losable: bool

    @property
    def order(self) -> int:
        """Number of states."""
        return int(self.contact.shape[1])

    @property
    def roundings(self) -> int:
        """How many roundings there are."""
        return int(self.contact_sizes.shape[1])

    @property
    def multipliers(self) -> int:
        """How many multipliers there are for lost contact."""
        if not self.losable:
            return 0
        if self.time is Time.CONTINUOUS:
            return len(self.free) * len(self.pulls)
        return 1 + 3 * len(self.pulls)

    def without_roundings(self) -> Problem:
        """Return the conditions of exact arithmetic."""
        width = self.order + self.disturbances
        return replace(
            self,
            contact=self.contact[:, :, :width],
            free=self.free[:, :, :width],
            contact_sizes=self.contact_sizes[:, :0],
            free_sizes=self.free_sizes[:, :0],
        )

    def distinct(self) -> Problem:
        """Return the conditions with motions that floating point cannot tell apart left out."""
        touching = _distinct(self.contact, self.contact_sizes)
        # In continuous time, every free motion has multipliers of its own for what lags.
        all_free = self.time is Time.CONTINUOUS and len(self.pulls)
        flying = slice(None) if all_free else _distinct(self.free, self.free_sizes)
        return replace(
            self,
            contact=self.contact[touching],
            free=self.free[flying],
            contact_sizes=self.contact_sizes[touching],
            free_sizes=self.free_sizes[flying],
        )

    def conditions(self, Q: Array, share: float) -> Iterator[Condition]:
        """Yield the forms of all motions, for a stack of Q and the sum of the shares."""
        n = self.order
        inner, last = Q[:, :-1, :-1], np.zeros(self.contact.shape[2])
        last[n - 1] = 1.0
        if self.time is Time.CONTINUOUS:
            for A in self.contact:
                yield Condition(_flow(Q, A, share), n)
            for A in self.free:
                yield Condition(_flow(inner, np.delete(A[:-1], n - 1, axis=1), share), n - 1)
            for k, (i, j) in enumerate(np.ndindex(len(self.free), len(self.pulls))):
                pulled = np.concatenate([self.pulls[j], np.zeros(self.disturbances)])
                yield Condition(_flow(Q, self.free[i], share), n, {k: _crossing(last, pulled)})
            return
        for A, sizes in zip(self.contact, self.contact_sizes, strict=True):
            yield Condition(_step(Q, A, Q, share), n, sizes=sizes)
            if self.losable:
                lost = _step(Q, A[:-1], inner, share)
                yield Condition(lost, n, {0: _crossing(last, A[-1])}, sizes)
        for A, sizes in zip(self.free, self.free_sizes, strict=True):
            moved, own = np.delete(A, n - 1, axis=1), np.delete(sizes, n - 1, axis=1)
            yield Condition(_step(inner, moved[:-1], inner, share), n - 1, sizes=own)
            yield Condition(_step(inner, moved, Q, share), n - 1, sizes=own)
            for k, q in enumerate(self.pulls):
                pulled = _crossing(last, np.pad(q, (0, len(last) - n)))
                yield Condition(_step(Q, A, Q, share), n, {3 * k + 1: pulled}, sizes)
                crossings = {3 * k + 2: pulled, 3 * k + 3: _crossing(last, A[-1])}
                yield Condition(_step(Q, A[:-1], inner, share), n, crossings, sizes)


@dataclass(frozen=True)
class Condition:
    """One form that must be positive: images of a stack of Q, and what the multipliers add.

    Parameters
    ----------
    images : ndarray, shape (k, s, s)
        Of every Q.
    order : int
        States in it; disturbances and roundings follow.
    crossings : mapping of int to ndarray, each of shape (s, s)
        The images of its multipliers for lost contact, by which they are.
    sizes : ndarray or None, shape (r, s - r)
        Of the roundings.
    """

    images: Array
    order: int
    crossings: Mapping[int, Array] = field(default_factory=dict)
    sizes: Array | None = None

    def stack(self, disturbances: int, multipliers: int) -> Array:
        """Return the images of Q, lambda, shares and tau in turn."""
        side, n = self.images.shape[-1], self.order
        crossings, shares = (
            np.zeros((multipliers, side, side)),
            np.zeros((disturbances, side, side)),
        )
        for k, crossing in self.crossings.items():
            crossings[k] = crossing
        for i in range(disturbances):
            shares[i, n + i, n + i] = 1.0
        sizes = np.zeros((0, side)) if self.sizes is None else self.sizes
        taus = np.zeros((len(sizes), side, side))
        for i, row in enumerate(sizes):
            taus[i, : len(row), : len(row)] = -np.outer(row, row)
            taus[i, n + disturbances + i, n + disturbances + i] = 1.0
        return np.concatenate([self.images, crossings, shares, taus])


def _distinct(maps: Array, sizes: Array) -> list[int]:
    found: dict[bytes, int] = {}
    for index, (A, q) in enumerate(zip(maps, sizes, strict=True)):
        found.setdefault(A.tobytes() + q.tobytes(), index)
    return list(found.values())


def _crossing(last: Array, row: Array) -> Array:
    return np.asarray(np.outer(last, row) + np.outer(row, last))


def _flow(Q: Array, A: Array, share: float) -> Array:
    """Return the images of Q in a motion in continuous time."""
    n, side = Q.shape[-1], A.shape[1]
    half = np.zeros((len(Q), side, side))
    half[:, :n] = Q @ A
    form = -(half + np.swapaxes(half, -1, -2))
    form[:, :n, :n] -= share * Q
    return form


def _step(before: Array, A: Array, after: Array, share: float) -> Array:
    """Return the images of Q in a step in discrete time."""
    n = before.shape[-1]
    form = -(A.T @ after @ A)
    form[:, :n, :n] += (1 - share) * before
    return form


@dataclass(frozen=True)
class Found:
    """A solution in floating point: Q, the multipliers, and the square of the level."""

    Q: Array
    crossings: Array
    shares: Array
    taus: Array
    square: float


def search_ellipsoid(
    system: SwitchedSystem, channels: Sequence[Channel], output: Output, allowance: Allowance
) -> Candidates[InvariantEllipsoid]:
    """Yield ellipsoids that bound an output under disturbances, the smallest level first.

    Where the arithmetic rounds, ellipsoids that cover that come before others.

    Parameters
    ----------
    system : SwitchedSystem
        Stable; with the disturbances and the output.
    channels : sequence of Channel
        The disturbances that act at once.
    output : Output
        What they move.
    allowance : Allowance
        Time and memory.

    Raises
    ------
    NotAffordableError
        If time or memory do not suffice.
    """
    family = Family.of(system)
    motions = Motions.of(family)
    raw = _problem(family, motions, channels, output)
    T = separating_coordinates(motions)
    size, level = _reach(raw, T)
    if not (np.isfinite(T).all() and isfinite(size) and isfinite(level) and size * level > 0):
        return OUT_OF_RANGE
    whole, units = _balanced(_transformed(raw, T, size, level))
    exact = whole.without_roundings().distinct()
    best, share = _best_share(exact, family.limit, allowance)
    if not isfinite(best):
        return NO_MARGIN
    names = tuple(channel.name for channel in channels)
    for own in [whole.distinct(), exact] if whole.roundings else [exact]:
        for slack in SLACKS:
            found = _solve(own, share, allowance, best * slack**2)
            if found is None:
                continue
            empty = InvariantEllipsoid(
                names,
                output.name,
                (),
                0,
                tuple(map(_short, found.shares.tolist())),
                _short(level * float(np.sqrt(best)) * slack),
            )
            for evidence in _roundings(family, empty, found, T, size, units):
                yield Candidate(evidence)
    return None


def _short(number: float) -> Fraction:
    return Fraction(f"{number:.6e}")


def _roundings(
    family: Family,
    empty: InvariantEllipsoid,
    found: Found,
    T: Array,
    size: float,
    units: Array,
) -> Iterator[InvariantEllipsoid]:
    """Yield roundings of a solution in coordinates ``x = size T z`` of the family.

    Unlike for a rate, the scale of Q matters: the set is ``V <= 1``.
    """
    inverse = np.linalg.inv(T) / size
    Q = inverse.T @ found.Q @ inverse
    contact = family.system.contact or Contact(())
    times = multiplied(contact, family.system.time)[: len(found.crossings)]
    multipliers = found.crossings / T[-1, -1] ** times / size**2
    multipliers = in_numerators(multipliers, contact, family.system.time)
    multipliers = np.ldexp(multipliers, -times * int(family.exponents[-1]))
    taus = found.taus * units[: len(found.taus)]
    exponent = int(np.frexp(np.abs(Q).max())[1])
    for bits in BITS:
        rows, log2 = unscale(np.ldexp(Q, -exponent), family.exponents, bits)
        log2 -= exponent
        if log2 < 0:
            rows, log2 = tuple(tuple(v << -log2 for v in row) for row in rows), 0
        yield replace(
            empty,
            Q=rows,
            denominator_log2=log2,
            multipliers=numerators(multipliers, log2),
            roundings=numerators(taus, log2),
        )


def _problem(
    family: Family, motions: Motions, channels: Sequence[Channel], output: Output
) -> Problem:
    """Join disturbances, roundings and output, in the coordinates of the family.

    Disturbances go up to one. Columns are those of the modes in contact, then of the free ones.
    """
    system, d = family.system, family.exponents
    n, count = len(d), len(system.modes)
    maps = np.concatenate([motions.contact, motions.free])
    bounds = np.array([float(channel.bound) for channel in channels])
    columns = [to_floats(c.columns)[:, :, 0] * b for c, b in zip(channels, bounds, strict=True)]
    columns += [to_floats(item.columns)[:, :, 0] for item in system.roundings]
    scaled = [np.ldexp(column, -d)[:, :, None] for column in columns]
    maps = np.concatenate([maps, *scaled], axis=2)
    acting = [n + system.channels.index(channel) for channel in channels]
    sizes = np.zeros((len(maps), len(system.roundings), n + len(channels)))
    for i, item in enumerate(system.roundings):
        rows = to_floats(item.rows)[:, 0]
        sizes[:, i, :n], sizes[:, i, n:] = np.ldexp(rows[:, :n], d), rows[:, acting] * bounds
    rows = np.ldexp(np.array([to_floats([q])[0, 0] for q in output.rows]), d[None, :])
    return Problem(
        system.time,
        maps[:count],
        maps[count:],
        sizes[:count],
        sizes[count:],
        motions.pulls,
        rows,
        len(channels),
        system.contact is not None,
    )


def _reach(problem: Problem, T: Array) -> tuple[float, float]:
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


def _transformed(problem: Problem, T: Array, size: float, level: float) -> Problem:
    n, inverse = problem.order, np.linalg.inv(T)

    def moved(maps: Array) -> Array:
        return np.concatenate(
            [inverse @ maps[:, :, :n] @ T, inverse @ maps[:, :, n:] / size], axis=2
        )

    def seen(sizes: Array) -> Array:
        return np.concatenate([sizes[:, :, :n] @ T * size, sizes[:, :, n:]], axis=2)

    return replace(
        problem,
        contact=moved(problem.contact),
        free=moved(problem.free),
        contact_sizes=seen(problem.contact_sizes),
        free_sizes=seen(problem.free_sizes),
        pulls=problem.pulls @ T,
        rows=problem.rows @ T * (size / level),
    )


def _balanced(problem: Problem) -> tuple[Problem, Array]:
    """Return the problem with every rounding in units of its own, and what a tau is in them.

    In them, what a rounding does to the state and what the state does to it are of like size.
    """
    start = problem.order + problem.disturbances
    columns = np.concatenate([problem.contact, problem.free])[:, :, start:]
    sizes = np.concatenate([problem.contact_sizes, problem.free_sizes])
    pushed = np.linalg.norm(columns, axis=1).max(axis=0)
    seen = np.linalg.norm(sizes, axis=2).max(axis=0)
    units = np.divide(pushed, seen, out=np.ones_like(pushed), where=seen > 0)
    root = np.sqrt(np.maximum(units, np.finfo(float).tiny))

    def scaled(maps: Array) -> Array:
        return np.concatenate([maps[:, :, :start], maps[:, :, start:] / root], axis=2)

    own = replace(
        problem,
        contact=scaled(problem.contact),
        free=scaled(problem.free),
        contact_sizes=problem.contact_sizes * root[:, None],
        free_sizes=problem.free_sizes * root[:, None],
    )
    return own, root**2


def _best_share(own: Problem, limit: float, allowance: Allowance) -> tuple[float, float]:
    """Return the least square of the level, relative to the scale, and its share."""
    top = 2 * limit if own.time is Time.CONTINUOUS else 1 - limit**2
    tried: dict[float, float] = {}

    def attempt(share: float) -> float:
        if share not in tried:
            found = _solve(own, share, allowance)
            tried[share] = np.inf if found is None else found.square
        return tried[share]

    shares = np.geomspace(SMALLEST_SHARE * top, 0.98 * top, SHARES).tolist()
    k = min(range(SHARES), key=lambda i: attempt(shares[i]))
    low, high = np.log(shares[max(k - 1, 0)]), np.log(shares[min(k + 1, SHARES - 1)])
    for _ in range(REFINED):
        left, right = high - (high - low) * GOLDEN, low + (high - low) * GOLDEN
        if attempt(float(np.exp(left))) <= attempt(float(np.exp(right))):
            high = right
        else:
            low = left
    best = min(tried, key=lambda share: tried[share])
    return tried[best], best


def _solve(
    own: Problem, share: float, allowance: Allowance, level: float | None = None
) -> Found | None:
    """Minimize the square of the level; or, for a given one, leave as much to spare as possible."""
    n, lost, c, basis = own.order, own.multipliers, own.disturbances, symmetric_basis(own.order)
    k, unknowns = len(basis), len(basis) + lost + c + own.roundings + 1
    blocks: list[tuple[Array, Array]] = []
    for condition in own.conditions(basis, share):
        stack = condition.stack(c, lost)
        side = stack.shape[-1]
        spare = np.eye(side) if level is not None else np.zeros((side, side))
        blocks.append((np.zeros((side, side)), np.concatenate([stack, -spare[None]])))
    for row in own.rows:
        constant, images = np.zeros((n + 1, n + 1)), np.zeros((unknowns, n + 1, n + 1))
        constant[:n, n] = constant[n, :n] = row
        images[:k, :n, :n] = basis
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
    cost = program_cost(unknowns, unknowns, [(len(constant), unknowns) for constant, _ in blocks])
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
    crossings, shares, taus = np.split(x[k:-1], [lost, lost + c])
    return Found(Q, crossings, shares, taus, float(-x[-1]))
