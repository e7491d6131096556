"""Search for ellipsoids in which motions decay although signals saturate (untrusted).

With ``S = Q^-1`` and ``Y = H S`` the conditions of `nrs_design.proof.evidence.saturated_ellipsoid`
in contact are linear in S and Y (Hu and Lin), and the largest start is found at once. Free motion
is about a block of Q. There is ``y' M y < 0`` on a block if and only if ``(B + g e')' Q + Q (B + g
e') < 0`` for some column g, e the unit vector of the deflection; for a fixed g that is linear in S.
So g is taken from the last S, beginning where nothing saturates, and S is improved until that
gains little. At last H is rounded, and Q is found for it with as much to spare as possible.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from nrs_design.proof.evidence import SaturatedEllipsoid
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import round_coordinates
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.family import Family
from nrs_design.search.rounding import round_rate, unscale
from nrs_design.search.saturated_region import (
    BELOW,
    ENOUGH,
    SLOWEST,
    SMALLEST,
    Array,
    Problem,
    Region,
    bordered_by,
    largest_region,
    last_unknown,
    log2_of,
    row_unknowns,
    solved,
)
from nrs_design.work import Allowance

DIGITS = (16, 20, 24, 32, 40, 50, 60)
# Improvements of a region in free motion, and the least gain that is worth another.
STEPS, GAIN = 12, 1.003
BISECTIONS = 8
# Shares of the largest rate that are claimed.
RATES = (0.99, 0.9, 0.5, 0.1)


def search_saturated(
    system: SwitchedSystem, allowance: Allowance
) -> Candidates[SaturatedEllipsoid]:
    """Yield ellipsoids that hold a start, those with the fastest decay first.

    In continuous time. The start is the wanted one; without one, or where it is out of reach,
    nearly the largest.
    """
    assert system.saturation is not None  # who asks has looked
    family, raw = Family.of(system), Problem.of(system, allowance)
    slowest = SLOWEST * family.limit
    T = np.diag(np.ldexp(1.0, family.exponents))
    first = _unsaturated(raw.transformed(T), slowest)
    if first is None:
        return NO_MARGIN
    # A triangular change of coordinates leaves the deflection alone, which is zero in free motion.
    T = T @ round_coordinates(first)
    T /= np.linalg.norm(raw.linear @ T, axis=-1).max()
    own = raw.transformed(T)
    if not all(np.isfinite(part).all() for part in (T, own.A, own.columns, *own.rows)):
        return OUT_OF_RANGE
    start = Region(np.eye(len(T)), own.linear[0], 0.0)
    wanted = system.saturation.start.wanted
    enough = np.inf if wanted is None else float(wanted) / BELOW**2
    largest = _largest(own, slowest, start, enough)
    if largest is None:
        return NO_MARGIN
    level = Fraction(f"{BELOW * largest.size:.4e}")
    if wanted is not None and wanted < level:
        level = wanted
    region, rate = _fastest(own, largest, float(level), slowest, family.limit)
    yield from map(Candidate, _rounded(raw, system, T, region, rate, level))
    return None


def _unsaturated(problem: Problem, rate: float) -> Array | None:
    """Return a quadratic function of the loop in which nothing is cut off."""
    n = problem.A.shape[1]
    Q, t = row_unknowns(n, 0)[0], last_unknown(n, 0)
    blocks = [(np.eye(n), -Q), (np.zeros((n, n)), Q - t * np.eye(n))]
    for k, A in enumerate(problem.A):
        last = n - problem.is_free(k)
        blocks.append(_decrease(A[:last, :last], Q[:, :last, :last], t, rate))
    x = solved(blocks, problem.allowance)
    return None if x is None else np.asarray(np.tensordot(x, Q, axes=1))


def _largest(problem: Problem, rate: float, start: Region, enough: float) -> Region | None:
    """Return the region with the largest start; in free motion, one that is hard to improve."""
    best = None
    for _ in range(STEPS if problem.free else 1):
        found = _improved(problem, rate, start)
        if found is None or (best is not None and found.size < GAIN * best.size):
            return best if found is None or (best and best.size > found.size) else found
        best = start = found
        if best.size >= enough:
            break
    return best


def _improved(problem: Problem, rate: float, near: Region) -> Region | None:
    """Return the largest region for the columns g that fit another."""
    n = problem.A.shape[1]

    def decreases(S: Array, Y: list[Array]) -> Iterator[tuple[Array, Array]]:
        before = problem.vertices(np.eye(n), [h[None] for h in near.H])
        for (k, form), (_, B) in zip(problem.vertices(S, Y), before, strict=True):
            if problem.is_free(k):
                form = form + _column(B, near.S, rate)[:, None] @ S[:, n - 1 : n, :]
            yield -SMALLEST * np.eye(n), -(form + np.swapaxes(form, -1, -2)) - 2 * rate * S

    return largest_region(problem, decreases)


def _column(B: Array, S: Array, rate: float) -> Array:
    """Return the g for which free motion, at its B, decreases in all states at once."""
    Q = np.linalg.inv(S)
    M = -(B.T @ Q + Q @ B + 2 * rate * Q)
    r = M[-1].copy()
    r[-1] = (M[-1, -1] - np.abs(np.diag(M)[:-1]).max()) / 2
    return np.asarray(S @ r)


def _fastest(
    problem: Problem, region: Region, level: float, slowest: float, fastest: float
) -> tuple[Region, float]:
    """Return a region that holds the start, with the largest rate that bisection finds."""
    low, high = slowest, fastest
    for _ in range(BISECTIONS):
        rate = float(np.sqrt(low * high))
        found = _largest(problem, rate, region, level / ENOUGH)
        if found is None or found.size * ENOUGH < level:
            high = rate
        else:
            region, low = found, rate
    return region, low


def _rounded(
    raw: Problem, system: SwitchedSystem, T: Array, region: Region, rate: float, level: Fraction
) -> Iterator[SaturatedEllipsoid]:
    """Yield the region with H rounded and Q found anew for it, with ever more digits."""
    assert system.saturation is not None
    limits = np.array([float(s.limit) for s in system.saturation.signals])
    H = limits[:, None] * (region.H @ np.linalg.inv(T))
    shape = np.asarray(np.linalg.inv(region.S), dtype=np.float64)
    T = np.asarray(T @ round_coordinates(shape), dtype=np.float64)
    log2 = log2_of(H)
    rows = tuple(tuple(round(float(v)) for v in row) for row in np.ldexp(H, log2))
    kept = np.ldexp(np.array(rows, dtype=float), -log2) / limits[:, None] @ T
    for share in RATES:
        alpha = round_rate(share * rate, Time.CONTINUOUS)
        own = _fitted(raw.transformed(T), kept, float(level), float(alpha))
        if own is None:
            continue
        inverse = np.linalg.inv(T)
        Q = inverse.T @ own @ inverse
        # In these units the diagonal of Q is about one.
        shifts = -np.round(np.log2(np.diag(Q)) / 2).astype(np.int64)
        unit = np.ldexp(np.ldexp(Q, shifts[:, None]), shifts[None])
        for bits in DIGITS:
            numerators, power = unscale(unit, shifts, bits)
            yield SaturatedEllipsoid(
                Q=numerators,
                denominator_log2=power,
                rate=alpha,
                H=rows,
                H_denominator_log2=log2,
                level=level,
            )


def _fitted(problem: Problem, H: Array, level: float, rate: float) -> Array | None:
    """Return Q for a given H, where it is about the identity, with as much to spare as possible."""
    n = problem.A.shape[1]
    Q, t = row_unknowns(n, 0)[0], last_unknown(n, 0)
    blocks = []
    for h in H:
        constant = np.zeros((n + 1, n + 1))
        constant[n, :n] = constant[:n, n] = h
        constant[n, n] = 1.0
        border = bordered_by(Q, np.zeros((len(Q), 1, n)))
        blocks.append((constant, border - t * np.eye(n + 1)))
    for x in problem.starts:
        value = level**2 * (x @ Q @ x)[:, None, None]
        blocks.append((np.ones((1, 1)), -value - t))
    for k, B in problem.vertices(np.eye(n), [h[None] for h in H]):
        last = n - problem.is_free(k)
        blocks.append(_decrease(B[:last, :last], Q[:, :last, :last], t, rate))
    x = solved(blocks, problem.allowance)
    return None if x is None else np.asarray(np.tensordot(x, Q, axes=1))


def _decrease(A: Array, Q: Array, t: Array, rate: float) -> tuple[Array, Array]:
    """Return the block that wants a decrease of at least t."""
    half, identity = Q @ A, np.eye(len(A))
    return np.zeros_like(A), -(half + np.swapaxes(half, -1, -2)) - 2 * rate * Q - t * identity
