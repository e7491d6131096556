"""Search for ellipsoids in which a loop decays although signals saturate (untrusted).

The largest region in contact gives the rows H. For them, rounded, the conditions of
`nrs_design.proof.evidence.saturated_ellipsoid` are linear in Q and all multipliers: those of lost
contact and of roundings. Where they have no solution, H is moved to what the signals are while
nothing is cut off.

With ``S = Q^-1`` and ``Y = H S`` those conditions in contact are linear in S and Y where nothing is
rounded (Hu and Lin 2001), and the largest start is found at once. In continuous time, free motion
is about a block of Q. There is ``y' M y < 0`` on a block if and only if
``(B + g e')' Q + Q (B + g e') < 0`` for some column g, e the unit vector of the deflection; for a
fixed g that is linear in S. So g is taken from the last S, beginning where
nothing saturates, and S is improved until that gains little.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.between import between
from nrs_design.proof.evidence import SaturatedEllipsoid
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import multiplier_names
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.balance import round_coordinates
from nrs_design.search.family import Family, nearly_same, separating_coordinates, to_floats
from nrs_design.search.one_form import (
    Constraint,
    FormSolution,
    OneForm,
    StepUnits,
    of_roundings,
    plain_steps,
)
from nrs_design.search.rates import position_of, rate_at, round_rate, share_of
from nrs_design.search.sdp import SemidefiniteProgram, packed_columns, symmetric_basis
from nrs_design.search.work import Allowance

Array = NDArray[np.float64]

H_DIGITS = 40
# The slowest decay that counts, as a share of the fastest there is; what is rounded needs room.
SLOWEST = {Time.CONTINUOUS: 1e-3, Time.DISCRETE: 0.02}
# Size of a start relative to the largest one, at which there is hardly any decay.
START_SHARE = 0.99
# A start just inside of a region leaves nothing for rounding.
ENOUGH = 0.999
# Distances of H from the unsaturated signals, the farthest first.
WAYS = (1.0, 0.8, 0.5, 0.0)
# Steps of a bisection of the rate, and shares of the largest one that are claimed.
BISECTIONS = 8
RATES = (0.99, 0.98, 0.9, 0.5, 0.1)
# In coordinates in which nothing saturates in the unit ball: how short and long a region may be.
SMALLEST, LARGEST = 1e-7, 1e5
# Improvements of a region in free motion, and the least gain that is worth another.
STEPS, GAIN = 12, 1.0005


@dataclass(frozen=True)
class SaturatingLoop:
    """The loop in floating point, with signals in units of their limits, and what may be spent."""

    time: Time
    # Shape (k, n, n). Modes in contact, and after them the free ones, which leave the deflection
    # where it is.
    A: Array
    free: int  # Number of free modes
    columns: Array  # Shape (k, s, n). What every signal does.
    rows: tuple[Array, ...]  # Shape (k, n + signals before). Their arguments.
    starts: Array  # Shape (c, n). States at the size one.
    # Group of rows h of each mode; in continuous time, all modes are in group 0.
    groups: tuple[int, ...]
    allowance: Allowance

    @classmethod
    def of(cls, system: SwitchedSystem, allowance: Allowance) -> SaturatingLoop:
        """Convert a system of which something saturates."""
        saturation = system.saturation
        assert saturation is not None  # only saturating systems are searched
        free = () if system.contact is None else system.contact.free
        limits = np.array([float(s.limit) for s in saturation.signals])
        A = to_floats([mode.A for mode in system.every_mode])
        columns = np.stack([to_floats(s.columns)[:, :, 0] for s in saturation.signals], axis=1)
        columns *= limits[:, None]
        if free:
            A[-len(free) :, -1] = columns[-len(free) :, :, -1] = 0.0
        n, rows = A.shape[1], list[Array]()
        for i, signal in enumerate(saturation.signals):
            row = to_floats(signal.rows)[:, 0] / limits[i]
            row[:, n:] *= limits[:i]
            rows.append(row)
        starts = to_floats(saturation.start.states)[:, :, 0]
        groups = (0,) * len(A)
        if system.time is Time.DISCRETE:
            equal_rows = nearly_same(np.concatenate([row[:, :n] for row in rows], axis=1))
            groups = tuple(sorted({*equal_rows}).index(k) for k in equal_rows)
        return cls(system.time, A, len(free), columns, tuple(rows), starts, groups, allowance)

    @property
    def held(self) -> int:
        """How many rows h there are."""
        return len(self.rows) * (max(self.groups) + 1)

    @property
    def is_finite(self) -> bool:
        """Whether floating point holds it."""
        return all(np.isfinite(part).all() for part in (self.A, self.columns, *self.rows))

    def transformed(self, T: Array) -> SaturatingLoop:
        """Return the same in coordinates ``x = T z``."""
        inverse, n = np.linalg.inv(T), len(T)
        rows = (np.concatenate([row[:, :n] @ T, row[:, n:]], axis=1) for row in self.rows)
        return replace(
            self,
            A=inverse @ self.A @ T,
            columns=self.columns @ inverse.T,
            rows=tuple(rows),
            starts=self.starts @ inverse.T,
        )

    @property
    def linear(self) -> Array:
        """The signals while nothing is cut off, as rows; shape (k, s, n)."""
        found: list[Array] = []
        n = self.A.shape[1]
        for row in self.rows:
            whole = row[:, :n].copy()
            for i, before in enumerate(found):
                whole += row[:, n + i, None] * before
            found.append(whole)
        return np.stack(found, axis=1)

    @property
    def shared(self) -> Array:
        """The same in the first mode of each group; shape (held, n)."""
        first = [self.groups.index(group) for group in range(max(self.groups) + 1)]
        return np.concatenate(self.linear[first])

    def by_mode(self, H: Array) -> list[Array]:
        """Return the rows h of every mode."""
        count = len(self.rows)
        return [H[group * count : (group + 1) * count] for group in self.groups]

    def vertices(self, S: Array, Y: Array) -> Iterator[tuple[int, Array]]:
        """Yield, with the index of its mode, ``B S`` for every B that a mode is a mixture of.

        For a stack of S and of the rows ``h S``, shape (N, held, n); S the identity gives the B.
        """
        n, linear, count = self.A.shape[1], self.linear, len(self.rows)
        for k, replaced in product(range(len(self.A)), product((False, True), repeat=count)):
            B, outputs = self.A[k] @ S, list[Array]()
            rows_of_mode = Y[:, self.groups[k] * count :]
            for i, (row, other) in enumerate(zip(self.rows, replaced, strict=True)):
                argument = row[k, None, :n] @ S
                for share, before in zip(row[k, n:], outputs, strict=True):
                    argument = argument + share * before
                outputs.append(rows_of_mode[:, i : i + 1] if other else argument)
                B = B + self.columns[k, i, :, None] @ (outputs[-1] - linear[k, i, None] @ S)
            yield k, B

    def is_free(self, k: int) -> bool:
        """Tell whether a mode is free motion."""
        return k >= len(self.A) - self.free


@dataclass(frozen=True)
class Region:
    """The ellipsoid ``z' S^-1 z <= 1``, with its H, and the largest start in it."""

    S: Array
    H: Array
    size: float


def largest_region(
    loop: SaturatingLoop, rate: float, near: Region | None = None, enough: float = np.inf
) -> Region | None:
    """Return the region with the largest start at a rate; in free motion one hard to improve."""
    near = near or Region(np.eye(loop.A.shape[1]), loop.shared, 0.0)
    best = _improved(loop, rate, near)
    for _ in range(STEPS - 1 if loop.free and loop.time is Time.CONTINUOUS else 0):
        if best is None or best.size >= enough:
            break
        found = _improved(loop, rate, best)
        if found is None or found.size <= best.size:
            break
        gain, best = found.size / best.size, found
        if gain < GAIN:
            break
    return best


def _improved(loop: SaturatingLoop, rate: float, near: Region) -> Region | None:
    """Return the region with the largest start, for the columns g that fit another."""
    n, row_count = loop.A.shape[1], loop.held
    basis = symmetric_basis(n)
    unknowns = len(basis) + row_count * n + 1
    S, Y = np.zeros((unknowns, n, n)), np.zeros((unknowns, row_count, n))
    S[: len(basis)] = basis
    Y[len(basis) : -1] = np.eye(row_count * n).reshape(-1, row_count, n)
    size = np.zeros((unknowns, 1, 1))
    size[-1] = 1.0
    unit = np.linalg.norm(loop.starts, axis=1).max()
    # An ellipsoid may be long, but not without end.
    blocks = [(LARGEST * np.eye(n), -S)]
    blocks += [(np.zeros((n, n)), S - size * np.outer(x, x)) for x in loop.starts / unit]
    corner = np.zeros((n + 1, n + 1))
    corner[n, n] = 1.0
    blocks += [(corner, _bordered(S, Y[:, i : i + 1], 0 * size)) for i in range(row_count)]
    program = SemidefiniteProgram(unknowns)
    for constant, images in [*blocks, *_decreases(loop, rate, S, Y, near)]:
        program.add(constant, [(0, packed_columns(images))])
    maximum = program.maximize(loop.allowance)
    if maximum is None or maximum.x[-1] <= 0:
        return None
    x = maximum.x
    found, rows = np.tensordot(x, S, axes=1), np.tensordot(x, Y, axes=1)
    return Region(np.asarray(found), rows @ np.linalg.inv(found), float(np.sqrt(x[-1]) / unit))


def _decreases(
    loop: SaturatingLoop, rate: float, S: Array, Y: Array, near: Region
) -> Iterator[tuple[Array, Array]]:
    """Yield the decrease at every vertex; in discrete time of those in contact only."""
    n = S.shape[-1]
    before = loop.vertices(np.eye(n)[None], near.H[None])
    for (k, form), (_, B) in zip(loop.vertices(S, Y), before, strict=True):
        if loop.time is Time.DISCRETE:
            if not loop.is_free(k):
                yield -SMALLEST * np.eye(2 * n), _bordered(rate**2 * S, form, S)
            continue
        if loop.is_free(k):
            form = form + _column(B[0], near.S, rate)[:, None] @ S[:, n - 1 : n, :]
        yield -SMALLEST * np.eye(n), -(form + np.swapaxes(form, -1, -2)) - 2 * rate * S


def _bordered(S: Array, y: Array, corner: Array) -> Array:
    """Return ``[[S, y'], [y, corner]]`` for every unknown."""
    return np.block([[S, np.swapaxes(y, -1, -2)], [y, corner]])


def _column(B: Array, S: Array, rate: float) -> Array:
    """Return the g for which free motion, at its B, decreases in all states at once."""
    Q = np.linalg.inv(S)
    M = -(B.T @ Q + Q @ B + 2 * rate * Q)
    r = M[-1].copy()
    r[-1] = (M[-1, -1] - np.abs(np.diag(M)[:-1]).max()) / 2
    return np.asarray(S @ r)


@dataclass(frozen=True)
class _RoundedRows:
    """Rows h in units of the spec, for a region that is round in coordinates ``x = T z``."""

    H: Array
    T: Array
    size: float  # Size of the largest start


@dataclass(frozen=True)
class _Search:
    """A system without modes that floating point cannot tell apart, in coordinates ``x = T z``."""

    system: SwitchedSystem
    T: Array
    loop: SaturatingLoop
    limit: float  # The fastest rate there is
    stands: tuple[int, ...]  # Index of the similar mode for each mode of the whole system
    rounding: bool = False  # Whether rounding errors are covered

    def rate(self, position: float) -> float:
        """Return the rate at a position from 0, mere stability, to 1."""
        return rate_at(position, self.limit, self.loop.time)

    @property
    def limits(self) -> Array:
        """Those of all rows h."""
        assert self.system.saturation is not None
        limits = [float(s.limit) for s in self.system.saturation.signals]
        return np.tile(limits, self.loop.held // len(limits))

    def rounded_rows(self, H: Array, way: float) -> Array:
        """Return rounded rows between those of the unsaturated signals and others."""
        mixed_rows = self.loop.shared + way * (H - self.loop.shared)
        found = self.limits[:, None] * (mixed_rows @ np.linalg.inv(self.T))
        log2 = log2_of(found)
        return np.asarray(np.ldexp(np.rint(np.ldexp(found, log2)), -log2))

    def program(self, held: _RoundedRows) -> OneForm:
        """Return the conditions for given rows."""
        rows = [[[Fraction(float(v)) for v in h] for h in H] for H in self.loop.by_mode(held.H)]
        system = between(self.system, rows, rounding=self.rounding)
        steps = plain_steps(system, rounding=self.rounding)
        own = StepUnits(held.T, np.ones(len(system.roundings) * self.rounding))
        return OneForm.of(steps, own.balanced(steps))

    def solve(
        self, held: _RoundedRows, rate: float, size: float, *, largest: bool = False
    ) -> FormSolution | None:
        """Return Q and multipliers for a start of some size, with most to spare.

        With `largest`, for the largest start, of which `last` is the square of the size over it.
        """
        program, zero = self.program(held), np.zeros((1, 1))
        rows = held.H / self.limits[:, None] @ held.T
        bounds = [Constraint.bordered(program.basis, row, 0.0, 1.0) for row in rows]
        for x in self.loop.starts @ self.T.T @ np.linalg.inv(held.T).T:
            value = -np.einsum("i,kij,j->k", size * x, program.basis, size * x)
            bounds.append(Constraint(zero, value[:, None, None], zero + 1))
        share, level = share_of(rate, self.loop.time), None if largest else 1.0
        return program.solve(share, bounds, self.loop.allowance, level)

    def largest(self, region: Region, rate: float) -> _RoundedRows | None:
        """Return rounded rows, with the size of the largest start for these rows."""
        slower = self.rate(RATES[0] * position_of(rate, self.limit, self.loop.time))
        shape = np.asarray(np.linalg.inv(region.S), dtype=np.float64)
        T = np.asarray(self.T @ round_coordinates(shape))
        for way in WAYS:
            held = _RoundedRows(self.rounded_rows(region.H, way), T, region.size)
            # The rows are made for this size, which leaves no room: a little less does.
            if way == 1.0 and self.solve(held, slower, START_SHARE * region.size):
                return held
            found = self.solve(held, rate, region.size, largest=True)
            if found is not None:
                # With roundings, the solver may exceed the largest start without roundings.
                return replace(held, size=region.size * min(1 / float(np.sqrt(found.last)), 1.0))
        return None

    def fastest(
        self, region: Region, held: _RoundedRows, level: float, slow: float
    ) -> tuple[_RoundedRows, float]:
        """Return rows for a start, and the position of the fastest rate that bisection finds."""
        fast = 1.0
        for _ in range(BISECTIONS):
            position = float(np.sqrt(slow * fast))
            nearby = largest_region(self.loop, self.rate(position), region, level / ENOUGH)
            found = None
            if nearby is not None and nearby.size * ENOUGH >= level:
                found = self.largest(nearby, self.rate(position))
            if nearby is None or found is None or found.size * ENOUGH < level:
                fast = position
            else:
                region, held, slow = nearby, found, position
        return held, slow

    def rounded(
        self, held: _RoundedRows, level: Fraction, rate: Fraction
    ) -> Iterator[SaturatedEllipsoid]:
        """Yield the region with Q and the multipliers in integers, with ever more digits."""
        found = self.solve(held, float(rate), float(level))
        if found is None:
            return
        row_blocks, log2 = [held.H], log2_of(held.H)
        if max(self.loop.groups) > 0:
            rows_by_mode = self.loop.by_mode(held.H)
            row_blocks = [rows_by_mode[k] for k in self.stands]
        rows = tuple(
            tuple(int(v) for v in row) for row in np.ldexp(np.concatenate(row_blocks), log2)
        )
        for Q, power, known in found.roundings(held.T):
            yield SaturatedEllipsoid(
                Q=Q,
                denominator_log2=power,
                rate=rate,
                H=rows,
                H_denominator_log2=log2,
                level=level,
                multipliers=tuple(known[name] for name in multiplier_names(self.system)),
                roundings=of_roundings(known),
            )


def search_saturated(
    system: SwitchedSystem, allowance: Allowance
) -> Candidates[SaturatedEllipsoid]:
    """Yield ellipsoids that hold a start, those with the fastest decay first.

    The start is the wanted one; without one, or where it is out of reach, nearly the largest. Where
    the arithmetic rounds, ellipsoids that cover that come before others.
    """
    assert system.saturation is not None  # only saturating systems are searched
    lean, equal_modes = _merge_similar_modes(system)
    family, raw = Family.of(lean), SaturatingLoop.of(lean, allowance)
    slowest = SLOWEST[system.time]
    T = _coordinates(lean, family, rate_at(slowest, family.limit, system.time), allowance)
    if T is None:
        return NO_MARGIN
    T /= np.linalg.norm(raw.linear @ T, axis=-1).max()
    loop = raw.transformed(T)
    if not (np.isfinite(T).all() and loop.is_finite):
        return OUT_OF_RANGE
    search = _Search(lean, T, loop, family.limit, equal_modes)
    required_start = system.saturation.start.wanted
    enough = np.inf if required_start is None else float(required_start) / START_SHARE**2
    region = largest_region(loop, search.rate(slowest), None, enough)
    if region is None:
        return NO_MARGIN
    for rounding in (True, False) if system.roundings else (False,):
        variant = replace(search, rounding=rounding)
        found = variant.largest(region, variant.rate(slowest))
        if found is None:
            continue
        level = Fraction(f"{START_SHARE * found.size:.4e}")
        if required_start is not None and required_start < level:
            level = required_start
        held, position = variant.fastest(region, found, float(level), slowest)
        for share in RATES:
            claimed = round_rate(variant.rate(share * position), system.time)
            yield from map(Candidate, variant.rounded(held, level, claimed))
    return NO_MARGIN


def _coordinates(
    system: SwitchedSystem, family: Family, rate: float, allowance: Allowance
) -> Array | None:
    """Return coordinates in which a form of the loop without saturation is the identity.

    They leave the deflection alone, which is zero in free motion.
    """
    T = np.ldexp(separating_coordinates(family), family.exponents[:, None])
    if not np.isfinite(T).all():
        return None
    program = OneForm.of(plain_steps(system, rounding=False), StepUnits(T, np.zeros(0)))
    one, basis = np.eye(program.order), program.basis
    bounds = [Constraint(0 * one, basis, 0 * one), Constraint(one, -basis)]
    found = program.solve(share_of(rate, system.time), bounds, allowance, 1.0)
    return None if found is None else np.asarray(T @ round_coordinates(found.Q))


def log2_of(H: Array) -> int:
    """Return with how many binary digits after the point rows are written."""
    return max(0, H_DIGITS - int(np.frexp(np.abs(H).max())[1]))


def _merge_similar_modes(system: SwitchedSystem) -> tuple[SwitchedSystem, tuple[int, ...]]:
    """Return the system with only those modes that floating point tells apart.

    With the number of the mode that stands for each mode of the whole system, in contact and free.
    """
    assert system.saturation is not None
    equal_modes = nearly_same(to_floats([mode.A for mode in system.modes]))
    if system.free:
        free = nearly_same(to_floats([mode.A for mode in system.free]))
        equal_modes += [len(system.modes) + k for k in free]
    representatives = sorted({*equal_modes})
    reduced = system.only(
        {mode.name for k, mode in enumerate(system.every_mode) if k in representatives}
    )

    def few(rows: tuple[RationalMatrix, ...]) -> tuple[RationalMatrix, ...]:
        return tuple(rows[k] for k in representatives) if rows else ()

    signals = tuple(
        replace(item, columns=few(item.columns), rows=few(item.rows), errors=few(item.errors))
        for item in system.saturation.signals
    )
    saturation = replace(system.saturation, signals=signals)
    lean = replace(reduced, flights=None, saturation=saturation, enclosures=())
    return lean, tuple(map(representatives.index, equal_modes))
