"""Search for small invariant ellipsoids off the origin, where contact may be lost (untrusted).

For a fixed share, the conditions of `nrs_design.proof.evidence.offset_ellipsoid` are linear in the
form, the multipliers and the level. They are made of the very steps that the exact check takes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.evidence import OffsetEllipsoid
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import CONTACT, Step
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.disturbed import BITS, balanced, problem_of, transformed
from nrs_design.search.family import NEARLY, Family
from nrs_design.search.invariant_ellipsoid import SLACKS, best_share, reach_and_level, short
from nrs_design.search.motions import Motions, numerators, separating_coordinates
from nrs_design.search.rounding import unscale
from nrs_design.search.sdp import Sparse, begin, maximize_margin, pack, program_cost, symmetric_basis
from nrs_design.work import Allowance

Array = NDArray[np.float64]


def search_offset_ellipsoid(
    system: SwitchedSystem, channels: Sequence[Channel], output: Output, allowance: Allowance
) -> Candidates[OffsetEllipsoid]:
    """Yield ellipsoids off the origin, as `search_ellipsoid` does those around it.

    Parameters
    ----------
    system, channels, output, allowance
        As there; contact may be lost.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    family = Family.of(system)
    motions = Motions.of(family)
    raw = problem_of(family, motions, channels, output)
    T = separating_coordinates(motions)
    size, level = reach_and_level(raw, T)
    if not (np.isfinite(T).all() and isfinite(size) and isfinite(level) and size * level > 0):
        return OUT_OF_RANGE
    errors = 1 / np.sqrt(balanced(transformed(raw, T, size, level))[1])
    names = tuple(channel.name for channel in channels)
    empty = OffsetEllipsoid(names, output.name, (), 0, (Fraction(1, 2),), Fraction(1))
    units = _Units(np.ldexp(size * T, family.exponents[:, None]), len(channels), errors, level)
    exact = _Program.of(empty, system, units)

    def attempt(share: float) -> float:
        found = exact.solve(share, allowance)
        return np.inf if found is None else found.last

    best, share = best_share(attempt, family.limit, system.time)
    if not isfinite(best):
        return NO_MARGIN
    every = replace(empty, roundings=(0,) * len(system.roundings))
    for item in [every, empty] if system.roundings else [empty]:
        own = _Program.of(item, system, units) if item is every else exact
        for slack in SLACKS:
            found = own.solve(share, allowance, best * slack)
            if found is not None:
                claim = replace(
                    item, shares=(short(share),), level=short(level * best * slack)
                )
                yield from map(Candidate, _rounded(claim, own, found, family.exponents))
    return None


@dataclass(frozen=True)
class _Units:
    """Coordinates in which state, disturbances, errors and output are about one."""

    states: Array  # Shape (n, n). The T of ``x = T z``.
    disturbances: int  # How many there are; each is at most one
    errors: Array
    level: float

    def of(self, states: int) -> Array:
        """Return the map to a one, the first states, disturbances and errors."""
        blocks = [np.eye(1), self.states[: states - 1, : states - 1]]
        blocks += [np.eye(self.disturbances), np.diag(self.errors)]
        ends = np.cumsum([0, *map(len, blocks)])
        found = np.zeros((ends[-1], ends[-1]))
        for block, i, j in zip(blocks, ends[:-1], ends[1:], strict=True):
            found[i:j, i:j] = block
        return found


@dataclass(frozen=True)
class _Condition:
    """A step: ``keeps Q_before - M' Q_after M``, or that of a flow, with what is known in it."""

    kind: tuple[object, ...]
    S: Array  # The state before, of z
    M: Array
    facts: dict[str, Array]  # What a multiplier takes away
    is_flow: bool

    @classmethod
    def of(cls, step: Step, units: _Units) -> _Condition:
        count = units.disturbances + len(step.errors) + step.states
        T = units.of(step.states)[:count, :count]
        after = np.linalg.inv(units.of(len(step.rows))[: len(step.rows), : len(step.rows)])

        def floats(rows: Sequence[Sequence[int]], over: int = 1) -> Array:
            found = [
                [entry / (unit * over) for entry, unit in zip(row, step.units, strict=False)]
                for row in rows
            ]
            return np.array([row + [0.0] * (count - len(row)) for row in found]) @ T

        facts = {}
        for name, left, right in step.products:
            l, r = floats([left, right])
            facts[name] = np.outer(l, r) + np.outer(r, l)
        for name, i, q, below in step.errors:
            (row,) = floats([q], below)
            e = np.eye(count)[i] * T[i, i]
            facts[name] = np.outer(row, row) - np.outer(e, e)
        kind = step.source, step.target, len(step.rows), len(facts), step.is_flow
        return cls(kind, np.eye(step.states, count), after @ floats(step.rows, step.over), facts, step.is_flow)

    def is_near(self, other: _Condition) -> bool:
        """Tell whether floating point tells it from another."""
        return self.kind == other.kind and bool(
            np.abs(self.M - other.M).max() <= NEARLY * np.abs(self.M).max()
        )


@dataclass(frozen=True)
class _Found:
    Q: Array
    multipliers: dict[str, float]
    last: float  # The level over its unit, or what is left to spare


@dataclass(frozen=True)
class _Program:
    """The conditions in floating point, of steps that it can tell apart."""

    units: _Units
    conditions: tuple[_Condition, ...]
    stands: dict[str, str]  # For every multiplier, that of the step which stands for its own
    scales: dict[str, float]  # Of the multipliers that are solved for
    ends: tuple[tuple[str, Array], ...]  # Of the output: its multiplier, and the signed row

    @classmethod
    def of(cls, item: OffsetEllipsoid, system: SwitchedSystem, units: _Units) -> _Program:
        kept, stands, scales = list[_Condition](), dict[str, str](), dict[str, float]()
        for step in item.steps(system):
            own = _Condition.of(step, units)
            like = next((other for other in kept if other.is_near(own)), None)
            if like is None:
                kept.append(own)
                like = own
            for name, other in zip(own.facts, like.facts, strict=True):
                stands.setdefault(name, other)
        for condition in kept:
            for name, form in condition.facts.items():
                scales[name] = max(scales.get(name, 0.0), float(np.abs(form).max()))
        rows = [
            (name, sign * np.array(row.floats()[0]) @ units.states / units.level)
            for name, row, sign in item.ends(system)
        ]
        stands |= {name: name for name, _ in rows}
        scales |= {name: float(units.states[-1, -1]) for name, _ in rows}
        return cls(units, tuple(kept), stands, {k: v or 1.0 for k, v in scales.items()}, tuple(rows))

    def solve(
        self, share: float, allowance: Allowance, level: float | None = None
    ) -> _Found | None:
        """Minimize the level; or, for a given one, leave as much to spare as possible."""
        side = len(self.units.states) + 1
        basis = symmetric_basis(side)
        k, names = len(basis), list(self.scales)
        place = {name: k + i for i, name in enumerate(names)}
        last = k + len(names)
        strict = level is not None
        rows, columns, values = list[Array](), list[Array](), list[Array]()
        offsets, sizes, at = list[Array](), list[int](), 0

        def add(block: Array, images: dict[int, Array], *, spare: bool = True) -> None:
            nonlocal at
            size = len(block)
            if strict and spare:
                images = {**images, last: -np.eye(size)}
            for column, image in images.items():
                entries = -pack(image)
                (where,) = np.nonzero(entries)
                rows.append(at + where)
                columns.append(np.full(len(where), column))
                values.append(entries[where])
            offsets.append(pack(block))
            sizes.append(size)
            at += size * (size + 1) // 2

        for item in self.conditions:
            before, after = len(item.S), len(item.M)
            Q = basis[:, :before, :before]
            if item.is_flow:
                half = item.S.T @ (Q @ item.M)
                stack = -(half + np.swapaxes(half, 1, 2)) - share * (item.S.T @ Q @ item.S)
            else:
                stack = (1 - share) * (item.S.T @ Q @ item.S)
                stack = stack - item.M.T @ basis[:, :after, :after] @ item.M
            images = dict(enumerate(stack))
            images |= {place[f]: -form / self.scales[f] for f, form in item.facts.items()}
            add(np.zeros(stack.shape[1:]), images)
        add(np.zeros((side - 1, side - 1)), dict(enumerate(basis[:, 1:, 1:])))
        add(np.zeros((1, 1)), dict(enumerate(-basis[:, :1, :1])), spare=False)
        for name, row in self.ends:
            block, image = np.zeros((side, side)), np.zeros((side, side))
            block[0, 1:] = block[1:, 0] = -row / 2
            image[0, -1] = image[-1, 0] = -0.5
            images = {**dict(enumerate(basis)), place[name]: image}
            one = np.zeros((side, side))
            one[0, 0] = 1.0
            if strict:
                block = block + level * one
            else:
                images[last] = -one
            add(block, images)
        for name in names:
            add(np.zeros((1, 1)), {place[name]: np.ones((1, 1))}, spare=False)
        if strict:
            add(np.ones((1, 1)), {last: -np.ones((1, 1))}, spare=False)
        cones = [(size, min(last + 1, k + size)) for size in sizes]
        begun = begin(allowance, program_cost(last + 1, last + 1, cones), "an ellipsoid off the origin")
        matrix = Sparse.of(*map(np.concatenate, (values, rows, columns)), (at, last + 1))
        x = maximize_margin(matrix, np.concatenate(offsets), sizes, begun)
        if x is None or (strict and x[-1] <= 0) or (not strict and x[-1] >= 0):
            return None
        found = {name: float(x[place[name]] / self.scales[name]) for name in names}
        Q = np.asarray(np.tensordot(x[:k], basis, axes=1))
        return _Found(Q, found, float(-x[-1]))


def _rounded(
    item: OffsetEllipsoid, program: _Program, found: _Found, exponents: NDArray[np.int64]
) -> Iterator[OffsetEllipsoid]:
    """Yield the ellipsoid in the coordinates of the spec, with more and more digits."""
    units = program.units
    inverse = np.linalg.inv(units.of(len(units.states) + 1)[: len(found.Q), : len(found.Q)])
    Q = units.level * inverse.T @ found.Q @ inverse
    size = int(np.frexp(np.abs(np.diag(Q)[1:] * 4.0**exponents).max())[1]) // 2
    shifts = np.concatenate([[0], exponents - size]).astype(np.int64)
    near = np.ldexp(Q, shifts[:, None] + shifts[None, :])
    given = np.array([found.multipliers[program.stands[name]] for name in program.stands])
    for bits in BITS:
        rows, log2 = unscale(near, shifts, bits)
        if log2 < 0:
            rows, log2 = tuple(tuple(v << -log2 for v in row) for row in rows), 0
        known = dict(zip(program.stands, numerators(units.level * given, log2), strict=True))
        taus = tuple(known[f"rounding {i}"] for i, _ in enumerate(item.roundings, 1))
        own = tuple(m for name, m in known.items() if not name.startswith("rounding "))
        yield replace(item, Q=rows, denominator_log2=log2, multipliers=own, roundings=taus)
