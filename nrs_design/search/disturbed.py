"""The conditions on a quadratic function under disturbances and errors, in floating point.

Those of `nrs_design.proof.evidence.invariant_ellipsoid`, and in discrete time those of
`nrs_design.proof.steps`: linear in Q and the multipliers (untrusted).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.contact import Contact
from nrs_design.proof.mode import Time
from nrs_design.search.family import Family, to_floats
from nrs_design.search.motions import (
    free_motions,
    in_numerators,
    multiplied,
    numerators,
    pulling_forces,
)
from nrs_design.search.rounding import unscale

Array = NDArray[np.float64]

# A constant, and what every unknown adds to it.
Block = tuple[Array, Array]

BITS = (30, 40, 50, 60)


@dataclass(frozen=True)
class DisturbedProblem:
    """The conditions in coordinates where the state, disturbances and output are about one."""

    time: Time  # Continuous or discrete
    # contact, free: maps of state, c disturbances and r errors, which are roundings.
    contact: Array
    free: Array
    # contact_sizes, free_sizes: how large the errors are at most.
    contact_sizes: Array
    free_sizes: Array
    pulls: Array  # Shape (p, n). Forces of environments that could pull.
    rows: Array  # Shape (q, n). The output.
    disturbances: int  # The c
    losable: bool  # Whether contact may be lost

    @property
    def order(self) -> int:
        """Number of states."""
        return int(self.contact.shape[1])

    @property
    def errors(self) -> int:
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

    def without_roundings(self) -> DisturbedProblem:
        """Return the conditions of exact arithmetic."""
        width = self.order + self.disturbances
        return replace(
            self,
            contact=self.contact[:, :, :width],
            free=self.free[:, :, :width],
            contact_sizes=self.contact_sizes[:, :0],
            free_sizes=self.free_sizes[:, :0],
        )

    def distinct(self) -> DisturbedProblem:
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

    def conditions(self, Q: Array, share: float) -> Iterator[MatrixInequality]:
        """Yield the forms of all motions, for a stack of Q and the sum of the shares."""
        n = self.order
        inner, last = Q[:, :-1, :-1], np.zeros(self.contact.shape[2])
        last[n - 1] = 1.0
        if self.time is Time.CONTINUOUS:
            for A, sizes in zip(self.contact, self.contact_sizes, strict=True):
                yield MatrixInequality(_flow(Q, A, share), n, sizes)
            for A, sizes in zip(self.free, self.free_sizes, strict=True):
                moved, own = np.delete(A[:-1], n - 1, axis=1), np.delete(sizes, n - 1, axis=1)
                yield MatrixInequality(_flow(inner, moved, share), n - 1, own)
            for k, (i, j) in enumerate(np.ndindex(len(self.free), len(self.pulls))):
                pull = _crossing(last, np.pad(self.pulls[j], (0, len(last) - n)))
                form = _flow(Q, self.free[i], share)
                yield MatrixInequality(form, n, self.free_sizes[i], {k: pull})
            return
        for A, sizes in zip(self.contact, self.contact_sizes, strict=True):
            yield MatrixInequality(_step(Q, A, Q, share), n, sizes)
            if self.losable:
                lost = _step(Q, A[:-1], inner, share)
                yield MatrixInequality(lost, n, sizes, {0: _crossing(last, A[-1])})
        for A, sizes in zip(self.free, self.free_sizes, strict=True):
            moved, own = np.delete(A, n - 1, axis=1), np.delete(sizes, n - 1, axis=1)
            yield MatrixInequality(_step(inner, moved[:-1], inner, share), n - 1, own)
            yield MatrixInequality(_step(inner, moved, Q, share), n - 1, own)
            for k, q in enumerate(self.pulls):
                pulled = _crossing(last, np.pad(q, (0, len(last) - n)))
                yield MatrixInequality(_step(Q, A, Q, share), n, sizes, {3 * k + 1: pulled})
                crossings = {3 * k + 2: pulled, 3 * k + 3: _crossing(last, A[-1])}
                yield MatrixInequality(_step(Q, A[:-1], inner, share), n, sizes, crossings)

    def condition_blocks(self, basis: Array, share: float, spare: float) -> list[Block]:
        """Return the conditions with so much of the last unknown to spare; others are as usual."""
        blocks = []
        for condition in self.conditions(basis, share):
            stack = condition.stack(self.disturbances, self.multipliers)
            side = stack.shape[-1]
            images = np.concatenate([stack, -spare * np.eye(side)[None]])
            blocks.append((np.zeros((side, side)), images))
        return blocks

    def bordered(self, row: Array, basis: Array) -> Block:
        """Return ``[[Q, row'], [row, 0]]``, with nothing of the other unknowns."""
        n = self.order
        unknowns = len(basis) + self.multipliers + self.disturbances + self.errors + 1
        constant, images = np.zeros((n + 1, n + 1)), np.zeros((unknowns, n + 1, n + 1))
        constant[:n, n] = constant[n, :n] = row
        images[: len(basis), :n, :n] = basis
        return constant, images


@dataclass(frozen=True)
class MatrixInequality:
    """One form that must be positive: images of a stack of Q, and what the multipliers add."""

    images: Array  # Shape (k, s, s). Of every Q.
    order: int  # States in it; disturbances and errors follow
    sizes: Array  # Shape (r, s - r). Of the errors.
    # Shape (s, s). The images of its multipliers for lost contact, by which they are.
    crossings: Mapping[int, Array] = field(default_factory=dict)

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
        taus = np.zeros((len(self.sizes), side, side))
        for i, row in enumerate(self.sizes):
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
class DisturbedSolution:
    """A solution in floating point: Q, the multipliers, and what was to be large or small.

    That is the square of the level, or what is left to spare.
    """

    Q: Array
    crossings: Array
    shares: Array
    taus: Array
    last: float


def problem_of(
    family: Family,
    channels: Sequence[Channel] = (),
    output: Output | None = None,
) -> DisturbedProblem:
    """Join disturbances, roundings and output, in the coordinates of the family.

    Disturbances go up to one; without any, it is about stability. Columns are those of the modes in
    contact, then of the free ones.
    """
    system, d = family.system, family.exponents
    n, count = len(d), len(system.modes)
    maps = np.concatenate([family.matrices, free_motions(family)])
    bounds = np.array([float(channel.bound) for channel in channels])
    columns = [to_floats(c.columns)[:, :, 0] * b for c, b in zip(channels, bounds, strict=True)]
    errors = system.roundings
    columns += [to_floats(item.columns)[:, :, 0] for item in errors]
    scaled = [np.ldexp(column, -d)[:, :, None] for column in columns]
    maps = np.concatenate([maps, *scaled], axis=2)
    acting = [n + system.channels.index(channel) for channel in channels]
    sizes = np.zeros((len(maps), len(errors), n + len(channels)))
    for i, item in enumerate(errors):
        rows = to_floats(item.rows)[:, 0]
        sizes[:, i, :n], sizes[:, i, n:] = np.ldexp(rows[:, :n], d), rows[:, acting] * bounds
    shown = () if output is None else output.rows
    rows = np.array([to_floats([q])[0, 0] for q in shown]).reshape(-1, n)
    rows = np.ldexp(rows, d[None, :])
    return DisturbedProblem(
        system.time,
        maps[:count],
        maps[count:],
        sizes[:count],
        sizes[count:],
        pulling_forces(family),
        rows,
        len(channels),
        system.contact is not None,
    )


def transformed(
    problem: DisturbedProblem, T: Array, size: float = 1.0, level: float = 1.0
) -> DisturbedProblem:
    """Return the problem in coordinates ``x = size T z``, with outputs divided by a level."""
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


def balanced(problem: DisturbedProblem) -> tuple[DisturbedProblem, Array]:
    """Return the problem with every error in units of its own, and what a tau is in them.

    In them, what an error does to the state and what the state does to it are of like size.
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


def roundings(
    family: Family, found: DisturbedSolution, T: Array, units: Array, size: float = 1.0
) -> Iterator[dict[str, Any]]:
    """Yield roundings of a solution in coordinates ``x = size T z``, as fields of evidence.

    The scale of Q is kept: a set may be ``V <= 1``. The units are as `balanced` gives them.
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
        rows, log2 = unscale(Q, family.exponents, bits - exponent)
        yield {
            "Q": rows,
            "denominator_log2": log2,
            "multipliers": numerators(multipliers, log2),
            "roundings": numerators(taus, log2),
        }
