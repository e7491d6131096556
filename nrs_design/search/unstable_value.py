"""Search for a value of constant parameters at which the system is not stable."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.constant import find_odd_shares, system_at
from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.family import Family
from nrs_design.search.mixture import search_mixture
from nrs_design.search.period import search_period
from nrs_design.work import Cost

Array = NDArray[np.float64]
Shares = tuple[Fraction, ...]

ENCLOSED = "not tried: what the corners enclose need not be attained"

# Values of a parameter that are tried, fewer where there are many modes or several parameters.
GRID, COARSE_GRID, EVALUATIONS = 257, 33, 200_000
FEWEST = 3
# Local maxima of the growth that are looked at closely, and how closely.
PEAKS = 16
GOLDEN_STEPS = 40
SWEEPS = 3  # Over several parameters, one after the other
GOLDEN = (5**0.5 - 1) / 2
# Shorter shares first: they make shorter numbers in the certificate.
DENOMINATORS = (1, 4, 16, 64, 256, 2**12, 2**20, 2**32, 2**48)
# Work for the eigenvalues of a mode at a value, and per multiplication in them.
PER_MATRIX = 5e-6
PER_PRODUCT = 3e-8
# What rounding hides, relative to the size of the matrices.
SLACK = 1e-9
# Shares at which switching is looked at: the ends have no mixture rung of their own. Of several
# parameters, all together or each at its own.
SHARES = (Fraction(1, 2), Fraction(1, 4), Fraction(3, 4), Fraction(0), Fraction(1))


def search_value(family: Family) -> Candidates[GrowingSequence]:
    """Scan the parameters' ranges for a mode that is not stable."""
    system, matrices = family.system, family.matrices
    if not np.isfinite(matrices).all():
        return OUT_OF_RANGE
    if (count := _count(system)) is None:
        return ENCLOSED
    slack = SLACK * max(float(np.abs(matrices).max()), 1.0)
    corners = _corners(system, matrices)
    least = COARSE_GRID if count == 1 else FEWEST
    fitting = int((EVALUATIONS / len(corners)) ** (1 / count))
    grid = np.linspace(0, 1, max(least, min(GRID, fitting)))
    family.allowance.take(
        _cost(len(corners), len(grid) ** count, corners.shape[-1], count),
        f"looking at {len(grid) ** count} values",
    )
    found = False
    for k, start in _peaks(corners, grid, count, system.time):
        shares, growth = _refined(corners[k], start, float(grid[1]), system.time)
        if growth < -slack:
            continue
        for denominator in DENOMINATORS:
            short = tuple(Fraction(s).limit_denominator(denominator) for s in shares)
            for mode in system_at(system, short).modes:
                if not is_stable(mode.A, system.time):
                    found = True
                    yield Candidate(replace(staying(mode.name), shares=short))
    return None if found else "every mode is stable at every value tried"


def search_switching_at_values(family: Family) -> Candidates[GrowingSequence]:
    """Look at some values of the parameter for an unstable average, or a growing period."""
    system = family.system
    if len(system.switching.fixed_ends) < 2 or system.switching.resets:
        return "not tried: that takes two modes at each value, and no resets"
    if (count := _count(system)) is None:
        return ENCLOSED
    # There are many values, and the periods of each could take all that is left.
    allowance = family.allowance.part(0.5)
    for shares in product(SHARES, repeat=count) if count < 3 else ((s,) * count for s in SHARES):
        at_shares = Family.of(system_at(system, shares), allowance)
        if at_shares.system.time is Time.CONTINUOUS and at_shares.system.switching.is_arbitrary:
            yield from _at(shares, search_mixture(at_shares))
        yield from _at(shares, search_period(at_shares))
    return "nothing grows at the values tried"


def _count(system: SwitchedSystem) -> int | None:
    """Return how many constant parameters there are; None if their corners are enclosures."""
    count = len(system.switching.fixed_ends[0]).bit_length() - 1
    odd = find_odd_shares(system.switching, (Fraction(0),) * count)
    return count if odd is None else None


def _cost(sets: int, values: int, order: int, count: int) -> Cost:
    """Predict what looking at all modes takes, at a grid of values and closely at the peaks."""
    closely = 2 * PEAKS * GOLDEN_STEPS * (count if count == 1 else count * SWEEPS)
    return Cost((sets * values + closely) * (PER_MATRIX + PER_PRODUCT * order**3))


def _at(
    shares: Shares, candidates: Candidates[GrowingSequence]
) -> Iterator[Candidate[GrowingSequence]]:
    """Make what is found about the system at a value evidence about the parameters."""
    for candidate in candidates:
        yield Candidate(replace(candidate.evidence, shares=shares))


def _corners(system: SwitchedSystem, matrices: Array) -> Array:
    """Return the modes of every set, shape (sets, corners, n, n)."""
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    return matrices[[[index[name] for name in c] for c in system.switching.fixed_ends]]


def _growth(corners: Array, shares: Array, time: Time) -> Array:
    """Return how far beyond the stability limit the worst eigenvalue is.

    Of a mode at the corners, shape (c, n, n), for values of the parameters, shape (m, k).
    """
    weights = np.ones((len(shares), 1))
    for share in shares.T:
        both = np.stack([1 - share, share], axis=1)
        weights = (weights[:, :, None] * both[:, None, :]).reshape(len(shares), -1)
    values = np.linalg.eigvals(np.tensordot(weights, corners, axes=1))
    if time is Time.CONTINUOUS:
        return np.asarray(values.real.max(axis=1))
    return np.asarray(np.abs(values).max(axis=1) - 1)


def _peaks(corners: Array, grid: Array, count: int, time: Time) -> list[tuple[int, Array]]:
    """Return the largest local maxima of the growth: the set of modes, and the shares."""
    values = np.stack(np.meshgrid(*[grid] * count, indexing="ij"), axis=-1)
    growth = np.array([_growth(c, values.reshape(-1, count), time) for c in corners])
    growth = growth.reshape(-1, *values.shape[:-1])
    highest = np.ones(growth.shape, dtype=bool)
    for axis in range(1, count + 1):
        beside = [(0, 0)] * growth.ndim
        beside[axis] = (1, 1)
        padded = np.moveaxis(np.pad(growth, beside, constant_values=-np.inf), axis, 0)
        here = np.moveaxis(highest, axis, 0)
        here &= (padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:])
    places = np.argwhere(highest)
    largest = np.argsort(-growth[highest], kind="stable")[:PEAKS]
    return [(int(places[i][0]), grid[places[i][1:]]) for i in largest]


def _refined(corners: Array, start: Array, step: float, time: Time) -> tuple[Array, float]:
    """Climb to a maximum near shares, no farther than a step; return it with its growth."""
    best, growth = start, float(_growth(corners, start[None], time)[0])
    for axis in list(range(len(start))) * (1 if len(start) == 1 else SWEEPS):
        here = best.copy()
        a, b = max(0.0, start[axis] - step), min(1.0, start[axis] + step)
        for _ in range(GOLDEN_STEPS):
            inner = (b - GOLDEN * (b - a), a + GOLDEN * (b - a))
            left, right = _growth(corners, _moved(here, axis, *inner), time)
            a, b = (a, inner[1]) if left > right else (inner[0], b)
        middle = _moved(here, axis, (a + b) / 2)
        if (found := float(_growth(corners, middle, time)[0])) > growth:
            best, growth = middle[0], found
    return best, growth


def _moved(shares: Array, axis: int, *to: float) -> Array:
    """Return the shares with other ones of one parameter, a row for each."""
    rows = np.repeat(shares[None], len(to), axis=0)
    rows[:, axis] = to
    return rows
