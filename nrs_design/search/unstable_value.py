"""Search for a value of a constant parameter at which the system is not stable."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.constant import system_at
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

# Values of the parameter that are tried, fewer where there are many modes.
GRID, COARSE_GRID, EVALUATIONS = 257, 33, 200_000
# Local maxima of the growth that are looked at closely, and how closely.
PEAKS = 16
GOLDEN_STEPS = 40
GOLDEN = (5**0.5 - 1) / 2
# Shorter shares first: they make shorter numbers in the certificate.
DENOMINATORS = (1, 4, 16, 64, 256, 2**12, 2**20, 2**32, 2**48)
# Work for the eigenvalues of a mode at a value, and per multiplication in them.
PER_MATRIX = 5e-6
PER_PRODUCT = 3e-8
# What rounding hides, relative to the size of the matrices.
SLACK = 1e-9
# Shares at which switching is looked at: the ends have no mixture rung of their own.
SHARES = (Fraction(1, 2), Fraction(1, 4), Fraction(3, 4), Fraction(0), Fraction(1))


def search_value(family: Family) -> Candidates[GrowingSequence]:
    """Scan the parameter's range for a mode that is not stable."""
    system, matrices = family.system, family.matrices
    if not np.isfinite(matrices).all():
        return OUT_OF_RANGE
    slack = SLACK * max(float(np.abs(matrices).max()), 1.0)
    lows, highs = _ends(system, matrices)
    count = max(COARSE_GRID, min(GRID, EVALUATIONS // len(lows)))
    shares = np.linspace(0, 1, count)
    family.allowance.take(_cost(len(lows), count, lows.shape[-1]), f"looking at {count} values")
    found = False
    for k, start in _peaks(lows, highs, shares, system.time):
        share, growth = _refined(lows[k], highs[k], (start, float(shares[1])), system.time)
        if growth < -slack:
            continue
        for denominator in DENOMINATORS:
            for evidence in _unstable_modes(system, Fraction(share).limit_denominator(denominator)):
                found = True
                yield Candidate(evidence)
    return None if found else "every mode is stable at every value tried"


def search_switching_at_values(family: Family) -> Candidates[GrowingSequence]:
    """Look at some values of the parameter for an unstable average, or a growing period."""
    system = family.system
    if len(system.switching.fixed_ends) < 2 or system.switching.resets:
        return "not tried: that takes two modes at each value, and no resets"
    for share in SHARES:
        at_share = Family.of(system_at(system, share), family.allowance)
        if at_share.system.time is Time.CONTINUOUS and at_share.system.switching.is_arbitrary:
            yield from _at(share, search_mixture(at_share))
        yield from _at(share, search_period(at_share))
    return "nothing grows at the values tried"


def _cost(pairs: int, shares: int, order: int) -> Cost:
    """Predict what looking at all pairs of ends takes, at shares and closely at the peaks."""
    return Cost((pairs * shares + 2 * PEAKS * GOLDEN_STEPS) * (PER_MATRIX + PER_PRODUCT * order**3))


def _at(
    share: Fraction, candidates: Candidates[GrowingSequence]
) -> Iterator[Candidate[GrowingSequence]]:
    """Make what is found about the system at a value evidence about the parameter."""
    for candidate in candidates:
        yield Candidate(replace(candidate.evidence, share=share))


def _ends(system: SwitchedSystem, matrices: Array) -> tuple[Array, Array]:
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    pairs = np.array([(index[low], index[high]) for low, high in system.switching.fixed_ends])
    return matrices[pairs[:, 0]], matrices[pairs[:, 1]]


def _growth(low: Array, high: Array, shares: Array, time: Time) -> Array:
    """Return how far beyond the stability limit the worst eigenvalue is, at each share."""
    weights = shares[:, None, None]
    values = np.linalg.eigvals((1 - weights) * low + weights * high)
    if time is Time.CONTINUOUS:
        return np.asarray(values.real.max(axis=1))
    return np.asarray(np.abs(values).max(axis=1) - 1)


def _peaks(lows: Array, highs: Array, shares: Array, time: Time) -> list[tuple[int, float]]:
    """Return the largest local maxima of the growth: the pair of ends, and the share."""
    ends = zip(lows, highs, strict=True)
    growth = np.array([_growth(low, high, shares, time) for low, high in ends])
    padded = np.pad(growth, ((0, 0), (1, 1)), constant_values=-np.inf)
    pairs, places = np.nonzero((growth >= padded[:, :-2]) & (growth >= padded[:, 2:]))
    largest = np.argsort(-growth[pairs, places], kind="stable")[:PEAKS]
    return [(int(pairs[i]), float(shares[places[i]])) for i in largest]


def _refined(low: Array, high: Array, near: tuple[float, float], time: Time) -> tuple[float, float]:
    """Climb to a maximum near a share, no farther than a step; return it with its growth."""
    start, step = near
    a, b = max(0.0, start - step), min(1.0, start + step)
    for _ in range(GOLDEN_STEPS):
        inner = np.array([b - GOLDEN * (b - a), a + GOLDEN * (b - a)])
        left, right = _growth(low, high, inner, time)
        a, b = (a, float(inner[1])) if left > right else (float(inner[0]), b)
    found = np.array([start, (a + b) / 2])
    growth = _growth(low, high, found, time)
    best = int(growth.argmax())
    return float(found[best]), float(growth[best])


def _unstable_modes(system: SwitchedSystem, share: Fraction) -> Iterator[GrowingSequence]:
    for mode in system_at(system, share).modes:
        if not is_stable(mode.A, system.time):
            yield replace(staying(mode.name), share=share)
