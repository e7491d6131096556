"""What a search for regions of saturating loops works on, in floating point (untrusted)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.family import NEARLY, to_floats
from nrs_design.search.sdp import solve_blocks, symmetric_basis
from nrs_design.work import Allowance

Array = NDArray[np.float64]

H_DIGITS = 40
# The slowest decay that counts, as a share of the fastest there is, and by how much a start stays
# below the largest one: nearer to it there is no decay to speak of.
SLOWEST, BELOW = 1e-3, 0.99
# A start just inside of a region leaves nothing for rounding.
ENOUGH = 0.999
# In coordinates in which nothing saturates in the unit ball.
SMALLEST, LARGEST = 1e-7, 1e5


@dataclass(frozen=True)
class Problem:
    """The loop in floating point, with signals in units of their limits, and what may be spent."""

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
    def of(cls, system: SwitchedSystem, allowance: Allowance) -> Problem:
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
            groups = _alike(np.concatenate([row[:, :n] for row in rows], axis=1))
        return cls(A, len(free), columns, tuple(rows), starts, groups, allowance)

    @property
    def held(self) -> int:
        """How many rows h there are."""
        return len(self.rows) * (max(self.groups) + 1)

    def transformed(self, T: Array) -> Problem:
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

    def vertices(self, S: Any, Y: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Yield, with the index of its mode, ``B S`` for every B that a mode is a mixture of.

        Y are the rows ``h S``, those of a group one after the other; S the identity gives the B.
        """
        n, linear, count = self.A.shape[1], self.linear, len(self.rows)
        for k, replaced in product(range(len(self.A)), product((False, True), repeat=count)):
            B, taken = self.A[k] @ S, list[Any]()
            own = Y[self.groups[k] * count :][:count]
            for i, (row, y, other) in enumerate(zip(self.rows, own, replaced, strict=True)):
                argument = row[k, None, :n] @ S
                for share, before in zip(row[k, n:], taken, strict=True):
                    argument = argument + share * before
                taken.append(y if other else argument)
                B = B + self.columns[k, i, :, None] @ (taken[-1] - linear[k, i, None] @ S)
            yield k, B

    def is_free(self, k: int) -> bool:
        """Tell whether a mode is one of free motion."""
        return k >= len(self.A) - self.free


def _alike(rows: Array) -> tuple[int, ...]:
    """Return a number for each row, one for those that floating point hardly tells apart."""
    kept: list[Array] = []
    found = []
    for row in rows:
        near = NEARLY * np.abs(rows).max()
        k = next((k for k, other in enumerate(kept) if np.abs(other - row).max() <= near), None)
        if k is None:
            k = len(kept)
            kept.append(row)
        found.append(k)
    return tuple(found)


@dataclass(frozen=True)
class Region:
    """The ellipsoid ``z' S^-1 z <= 1``, with its H, and the largest start in it."""

    S: Array
    H: Array
    size: float


def row_unknowns(n: int, rows: int) -> tuple[Array, list[Array]]:
    """Return what each unknown makes of a symmetric matrix, and of rows.

    The last unknown makes nothing of either.
    """
    basis, total = symmetric_basis(n), n * (n + 1) // 2 + rows * n + 1
    S, Y = np.zeros((total, n, n)), [np.zeros((total, 1, n)) for _ in range(rows)]
    S[: len(basis)] = basis
    for i, row in enumerate(Y):
        first = len(basis) + i * n
        row[first : first + n, 0] = np.eye(n)
    return S, Y


def last_unknown(n: int, rows: int) -> Array:
    """Return what each unknown makes of the number that is to be large."""
    number = np.zeros((n * (n + 1) // 2 + rows * n + 1, 1, 1))
    number[-1] = 1.0
    return number


def bordered_by(S: Array, y: Array) -> Array:
    """Return ``[[S, y'], [y, 0]]`` for every unknown."""
    n = S.shape[-1]
    whole = np.zeros((len(S), n + 1, n + 1))
    whole[:, :n, :n] = S
    whole[:, n:, :n], whole[:, :n, n:] = y, np.swapaxes(y, -1, -2)
    return whole


def largest_region(
    problem: Problem,
    decreases: Callable[[Array, list[Array]], Iterable[tuple[Array, Array]]],
) -> Region | None:
    """Return the region with the largest start for which blocks of S and Y are positive."""
    n, count = problem.A.shape[1], problem.held
    (S, Y), size = row_unknowns(n, count), last_unknown(n, count)
    unit = np.linalg.norm(problem.starts, axis=1).max()
    # An ellipsoid may be long, but not without end.
    blocks = [(LARGEST * np.eye(n), -S)]
    blocks += [(np.zeros((n, n)), S - size * np.outer(x, x)) for x in problem.starts / unit]
    corner = np.zeros((n + 1, n + 1))
    corner[n, n] = 1.0
    blocks += [(corner, bordered_by(S, y)) for y in Y]
    x = solved([*blocks, *decreases(S, Y)], problem.allowance)
    if x is None:
        return None
    found = np.asarray(np.tensordot(x, S, axes=1))
    rows = np.concatenate([np.tensordot(x, y, axes=1) for y in Y])
    return Region(found, rows @ np.linalg.inv(found), float(np.sqrt(x[-1]) / unit))


def log2_of(H: Array) -> int:
    """Return with how many binary digits after the point rows are written."""
    return max(0, H_DIGITS - int(np.frexp(np.abs(H).max())[1]))


def solved(blocks: Sequence[tuple[Array, Array]], allowance: Allowance) -> Array | None:
    """Make the last unknown large where all blocks are positive; None where it is not positive."""
    x = solve_blocks(blocks, allowance)
    return x if x is not None and x[-1] > 0 else None
