"""The largest region in which a saturating loop decays in contact, in floating point (untrusted).

With ``S = Q^-1`` and ``Y = H S`` the conditions of `nrs_design.proof.evidence.saturated_ellipsoid`
in contact are linear in S and Y where nothing is rounded (Hu and Lin 2001), and the largest start
is found at once. In continuous time, free motion is about a block of Q. There is ``y' M y < 0`` on
a block if and only if ``(B + g e')' Q + Q (B + g e') < 0`` for some column g, e the unit vector of
the deflection; for a fixed g that is linear in S. So g is taken from the last S, beginning where
nothing saturates, and S is improved until that gains little.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.family import nearly_same, to_floats
from nrs_design.search.sdp import SemidefiniteProgram, packed_columns, symmetric_basis
from nrs_design.work import Allowance

Array = NDArray[np.float64]

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
    free: int  # How many of them are free
    columns: Array  # Shape (k, s, n). What every signal does.
    rows: tuple[Array, ...]  # Shape (k, n + signals before). Their arguments.
    starts: Array  # Shape (c, n). States at the size one.
    # Which rows h a mode has, of those that modes share: always the first in continuous time.
    groups: tuple[int, ...]
    allowance: Allowance

    @classmethod
    def of(cls, system: SwitchedSystem, allowance: Allowance) -> SaturatingLoop:
        """Convert a system of which something saturates."""
        saturation = system.saturation
        assert saturation is not None  # who asks has looked
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
            same = nearly_same(np.concatenate([row[:, :n] for row in rows], axis=1))
            groups = tuple(sorted({*same}).index(k) for k in same)
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
            B, taken = self.A[k] @ S, list[Array]()
            own = Y[:, self.groups[k] * count :]
            for i, (row, other) in enumerate(zip(self.rows, replaced, strict=True)):
                argument = row[k, None, :n] @ S
                for share, before in zip(row[k, n:], taken, strict=True):
                    argument = argument + share * before
                taken.append(own[:, i : i + 1] if other else argument)
                B = B + self.columns[k, i, :, None] @ (taken[-1] - linear[k, i, None] @ S)
            yield k, B

    def is_free(self, k: int) -> bool:
        """Tell whether a mode is one of free motion."""
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
    n, held = loop.A.shape[1], loop.held
    basis = symmetric_basis(n)
    unknowns = len(basis) + held * n + 1
    S, Y = np.zeros((unknowns, n, n)), np.zeros((unknowns, held, n))
    S[: len(basis)] = basis
    Y[len(basis) : -1] = np.eye(held * n).reshape(-1, held, n)
    size = np.zeros((unknowns, 1, 1))
    size[-1] = 1.0
    unit = np.linalg.norm(loop.starts, axis=1).max()
    # An ellipsoid may be long, but not without end.
    blocks = [(LARGEST * np.eye(n), -S)]
    blocks += [(np.zeros((n, n)), S - size * np.outer(x, x)) for x in loop.starts / unit]
    corner = np.zeros((n + 1, n + 1))
    corner[n, n] = 1.0
    blocks += [(corner, _bordered(S, Y[:, i : i + 1], 0 * size)) for i in range(held)]
    program = SemidefiniteProgram(unknowns)
    for constant, images in [*blocks, *_decreases(loop, rate, S, Y, near)]:
        program.add(constant, [(0, packed_columns(images))])
    reached = program.maximize(loop.allowance)
    if reached is None or reached.x[-1] <= 0:
        return None
    x = reached.x
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
