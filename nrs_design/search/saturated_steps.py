"""Search for ellipsoids in which a sampled loop decays although signals saturate (untrusted).

With ``S = Q^-1`` and ``Y = H S`` the conditions in contact are linear in S and Y where nothing is
rounded (Hu and Lin 2001), and the largest start gives H. For that H, rounded, the conditions of
`nrs_design.proof.evidence.saturated_ellipsoid` are linear in Q and all multipliers: those of lost
contact and of roundings. Where they have no solution, H is moved to what the signals are while
nothing is cut off.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from nrs_design.proof.between import between
from nrs_design.proof.channels import Rounding
from nrs_design.proof.evidence import SaturatedEllipsoid
from nrs_design.proof.mode import Time
from nrs_design.proof.saturation import CutOff
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
from nrs_design.search.family import Family, stand_ins, to_floats
from nrs_design.search.motions import separating_coordinates
from nrs_design.search.rounding import round_rate
from nrs_design.search.saturated_region import (
    BELOW,
    ENOUGH,
    SMALLEST,
    Array,
    Problem,
    Region,
    largest_region,
    log2_of,
)
from nrs_design.search.sdp import solve_blocks, symmetric_basis
from nrs_design.work import Allowance

# The slowest decay that counts, as a share of the fastest there is: what is rounded needs room.
SLOWEST_STEP = 0.02
# How far H is taken from what the signals are while nothing is cut off, the farthest first.
WAYS = (1.0, 0.8, 0.5, 0.0)
# How far below zero an eigenvalue may be where a form counts as positive, over its largest part.
LOOSE = 1e-6
# Steps of a bisection of the rate, and shares of the largest one that are claimed.
BISECTIONS = 5
RATES = (0.98, 0.9, 0.5)


@dataclass(frozen=True)
class _Loop:
    """A system without modes that floating point cannot tell apart, in coordinates ``x = T z``."""

    system: SwitchedSystem
    T: Array
    own: Problem
    stands: tuple[int, ...]  # For each mode of the whole system, the one that stands for it
    rounding: bool  # Whether what the arithmetic rounds is covered

    @property
    def limits(self) -> Array:
        """Those of all rows h."""
        assert self.system.saturation is not None
        limits = [float(s.limit) for s in self.system.saturation.signals]
        return np.tile(limits, self.own.held // len(limits))

    @property
    def linear(self) -> Array:
        """What the signals are while nothing is cut off, in the first mode of each group."""
        groups = self.own.groups
        first = [groups.index(group) for group in range(max(groups) + 1)]
        return np.concatenate([self.own.linear[k] for k in first])

    def by_mode(self, H: Array) -> list[Array]:
        """Return the rows h of every mode."""
        count = len(self.own.rows)
        return [H[group * count : (group + 1) * count] for group in self.own.groups]

    def whole(self, H: Array) -> tuple[Family, Array, DisturbedProblem, Array]:
        """Return the conditions for given rows, with their family, coordinates and units."""
        held = [[[Fraction(float(v)) for v in h] for h in rows] for rows in self.by_mode(H)]
        loop = between(self.system, held, rounding=self.rounding)
        family = Family.of(loop)
        T = np.ldexp(self.T, -family.exponents[:, None])
        problem = transformed(problem_of(family), T)
        problem, units = balanced(problem)
        return family, T, problem.distinct(), units


def search_saturated_steps(
    system: SwitchedSystem, allowance: Allowance
) -> Candidates[SaturatedEllipsoid]:
    """Yield ellipsoids that hold a start, those with the fastest decay first.

    In discrete time. The start is the wanted one; without one, or where it is out of reach, nearly
    the largest. Where the arithmetic rounds, ellipsoids that cover that come before others.
    """
    assert system.saturation is not None  # who asks has looked
    kept, stands = _stand_ins(system)
    lean = _lean(system, kept)
    family, raw = Family.of(lean), Problem.of(lean, allowance)
    T = np.ldexp(separating_coordinates(family), family.exponents[:, None])
    T /= np.linalg.norm(raw.linear @ T, axis=-1).max()
    own = raw.transformed(T)
    if not all(np.isfinite(part).all() for part in (T, own.A, own.columns, *own.rows)):
        return OUT_OF_RANGE
    slowest = 1 - SLOWEST_STEP * (1 - family.limit)
    first = _improved(own, slowest)
    if first is None:
        return NO_MARGIN
    wanted = system.saturation.start.wanted
    for rounding in (True, False) if system.roundings else (False,):
        loop = _Loop(lean, T, own, stands, rounding)
        found = _largest(loop, first, slowest)
        if found is None:
            continue
        H, size = found
        level, rate = Fraction(f"{BELOW * size:.4e}"), slowest
        if wanted is not None and wanted < level:
            level = wanted
            H, rate = _fastest(loop, H, float(level), family.limit, slowest)
        for share in RATES:
            claimed = round_rate(1 - share * (1 - rate), Time.DISCRETE)
            yield from map(Candidate, _rounded(loop, H, level, claimed))
    return NO_MARGIN


def _stand_ins(system: SwitchedSystem) -> tuple[list[int], tuple[int, ...]]:
    """Return modes that floating point tells apart, and for each mode which of them stands for it.

    Modes in contact and free, by their numbers.
    """
    kept: list[int] = []
    stands: list[int] = []
    first = 0
    for modes in (system.modes, system.free):
        if not modes:
            continue
        names = [mode.name for mode in modes]
        found = stand_ins(names, to_floats([mode.A for mode in modes]))
        kept += [first + k for k, name in enumerate(names) if found[name] == name]
        stands += [kept.index(first + names.index(found[name])) for name in names]
        first += len(modes)
    return kept, tuple(stands)


def _lean(system: SwitchedSystem, kept: list[int]) -> SwitchedSystem:
    """Leave out all modes but some, with what belongs to them."""
    modes, free = system.modes, system.free
    own = tuple(m for k, m in enumerate(modes) if k in kept)
    flying = tuple(m for k, m in enumerate(free, len(modes)) if k in kept)
    contact = None if system.contact is None else replace(system.contact, free=flying)

    assert system.saturation is not None
    signals = tuple(replace(signal, **_parts(signal, kept)) for signal in system.saturation.signals)
    return replace(
        system,
        modes=own,
        contact=contact,
        flights=None,
        roundings=tuple(replace(item, **_parts(item, kept)) for item in system.roundings),
        saturation=replace(system.saturation, signals=signals),
        enclosures=(),
    )


def _parts(item: Rounding | CutOff, kept: list[int]) -> dict[str, Any]:
    """Return what an item has for every mode, for some of them."""
    parts = {part: getattr(item, part, ()) for part in ("columns", "rows", "errors")}
    return {part: tuple(rows[k] for k in kept) for part, rows in parts.items() if rows}


def _improved(problem: Problem, rate: float) -> Region | None:
    """Return the region with the largest start, in contact and without roundings."""
    n = problem.A.shape[1]

    def decreases(S: Array, Y: list[Array]) -> Iterator[tuple[Array, Array]]:
        for k, form in problem.vertices(S, Y):
            if not problem.is_free(k):
                whole = np.zeros((len(S), 2 * n, 2 * n))
                whole[:, :n, :n], whole[:, n:, n:] = rate**2 * S, S
                whole[:, n:, :n], whole[:, :n, n:] = form, np.swapaxes(form, -1, -2)
                yield -SMALLEST * np.eye(2 * n), whole

    return largest_region(problem, decreases)


def _largest(loop: _Loop, region: Region, rate: float) -> tuple[Array, float] | None:
    """Return the rows, in units of the spec, and the largest start for them, rounded as it is."""
    for way in WAYS:
        H = _rows(loop, region.H, way)
        # The rows are made for this size, which leaves no room: a little less does.
        wanted = BELOW * region.size
        slower = 1 - RATES[0] * (1 - rate)
        if way == 1.0 and _solution(loop, H, slower, wanted):
            return H, region.size
        found = _solution(loop, H, rate, region.size, largest=True)
        if found is not None:
            # With roundings, the solver ends a little beyond what is possible without them.
            return H, region.size * min(1 / float(np.sqrt(found.last)), 1.0)
    return None


def _rows(loop: _Loop, H: Array, way: float) -> Array:
    """Return rows between what the signals are while nothing is cut off and others, rounded."""
    moved = loop.linear + way * (H - loop.linear)
    found = loop.limits[:, None] * (moved @ np.linalg.inv(loop.T))
    log2 = log2_of(found)
    return np.asarray(np.ldexp(np.rint(np.ldexp(found, log2)), -log2))


def _fastest(loop: _Loop, H: Array, level: float, fast: float, slow: float) -> tuple[Array, float]:
    """Return rows and the least rho that bisection finds for a start, from a slow one on."""
    for _ in range(BISECTIONS):
        rate = 1 - float(np.sqrt((1 - fast) * (1 - slow)))
        region = _improved(loop.own, rate)
        enough = region is not None and region.size * ENOUGH >= level
        found = None
        if region is not None and enough:
            found = _largest(loop, region, rate)
        if found is None or found[1] * ENOUGH < level:
            fast = rate
        else:
            H, slow = found[0], rate
    return H, slow


def _solution(
    loop: _Loop, H: Array, rate: float, level: float, *, largest: bool = False
) -> DisturbedSolution | None:
    """Return Q and multipliers for a start of some size, with most to spare; or the largest start.

    Of that, `last` is the square of the level over its size.
    """
    _, _, problem, _ = loop.whole(H)
    n, basis = problem.order, symmetric_basis(problem.order)
    k, lost = len(basis), problem.multipliers
    unknowns = k + lost + problem.errors + 1
    spare = 0.0 if largest else 1.0
    blocks = problem.condition_blocks(basis, 1 - rate**2, spare)
    for h in H / loop.limits[:, None] @ loop.T:
        constant, images = problem.bordered(h, basis)
        constant[n, n] = 1.0
        images[-1] = -spare * np.eye(n + 1)
        blocks.append((constant, images))
    for x in loop.own.starts:
        images = np.zeros((unknowns, 1, 1))
        images[:k, 0, 0] = -np.einsum("i,kij,j->k", x, basis, x) * level**2
        # Minimized, so the last unknown is less than what is to be small.
        images[-1] = -1.0
        blocks.append((np.full((1, 1), spare), images))
    for i in range(k, unknowns - 1):
        images = np.zeros((unknowns, 1, 1))
        images[i] = 1.0
        blocks.append((np.zeros((1, 1)), images))
    x = solve_blocks(blocks, loop.own.allowance)
    if x is None or (x[-1] >= 0 if largest else x[-1] <= 0):
        return None
    if largest and not _holds(blocks, x):
        return None
    Q, crossings, taus = np.tensordot(x[:k], basis, axes=1), x[k : k + lost], x[k + lost : -1]
    return DisturbedSolution(Q, crossings, np.zeros(0), taus, abs(float(x[-1])))


def _holds(blocks: Sequence[tuple[Array, Array]], x: Array) -> bool:
    """Tell whether a solution is one: a solver returns what it has where there is none."""
    for constant, images in blocks:
        parts = np.concatenate([constant[None], x[:, None, None] * images])
        if np.linalg.eigvalsh(parts.sum(axis=0))[0] < -LOOSE * np.abs(parts).max():
            return False
    return True


def _rounded(
    loop: _Loop, H: Array, level: Fraction, rate: Fraction
) -> Iterator[SaturatedEllipsoid]:
    """Yield the region with Q and the multipliers in integers, with ever more digits."""
    found = _solution(loop, H, float(rate), float(level))
    if found is None:
        return
    log2 = log2_of(H)
    each = [H] if max(loop.own.groups) == 0 else [loop.by_mode(H)[k] for k in loop.stands]
    rows = tuple(tuple(int(v) for v in row) for row in np.ldexp(np.concatenate(each), log2))
    family, T, _, units = loop.whole(H)
    for numbers in roundings(family, found, T, units):
        yield SaturatedEllipsoid(rate=rate, H=rows, H_denominator_log2=log2, level=level, **numbers)
