"""Search for small invariant ellipsoids off the origin, where contact may be lost (untrusted).

For a fixed share, the conditions of `nrs_design.proof.evidence.offset_ellipsoid` are linear in the
form, the multipliers and the level. They are made of the very steps that the exact check takes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.evidence import OffsetEllipsoid
from nrs_design.proof.steps import Step
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.disturbed import BITS
from nrs_design.search.family import NEARLY, Family
from nrs_design.search.invariant_ellipsoid import (
    SLACKS,
    SMALLEST_SHARE,
    Frame,
    largest_share,
    seven_digits,
)
from nrs_design.search.motions import numerators
from nrs_design.search.rounding import unscale
from nrs_design.search.sdp import (
    Blocks,
    begin,
    program_cost,
    symmetric_basis,
)
from nrs_design.work import Allowance, Cost

Array = NDArray[np.float64]

# Where shares are tried first, relative to the largest, and by what factor the next one differs.
USUAL, STEP = 0.38, 1.25
# How much less than the others a disturbance pushes whose products are left out.
WEAK = 1e-3
# What is less in a product, relative to it, is no factor of it.
FELT = 1e-2
# Programs that are solved, at most as a rule, before the roundings are added.
PROGRAMS = 4
WHAT = "an ellipsoid off the origin"


def search_offset_ellipsoid(
    system: SwitchedSystem, channels: Sequence[Channel], output: Output, allowance: Allowance
) -> Candidates[OffsetEllipsoid]:
    """Yield ellipsoids off the origin, as `search_ellipsoid` does; with the roundings, or none.

    Contact may be lost.
    """
    family = Family.of(system)
    frame = Frame.of(family, channels, output)
    if frame is None:
        return OUT_OF_RANGE
    moved, balance = frame.problem(family, channels, output)
    pushes = np.abs(moved.contact[:, :, moved.order :][:, :, : len(channels)]).max(axis=(0, 1))
    names = tuple(channel.name for channel in channels)
    empty = OffsetEllipsoid(names, output.name, (), 0, (Fraction(1, 2),), Fraction(1))
    units = _Units(
        np.ldexp(frame.size * frame.T, family.exponents[:, None]),
        len(channels),
        balance**-0.5,
        frame.level,
        tuple(np.flatnonzero(pushes < WEAK * pushes.max())),
    )
    every = replace(empty, roundings=(0,) * len(system.roundings))
    exact, whole = (_Program.of(item, system, units) for item in (empty, every))
    work = PROGRAMS * exact.cost.work + whole.cost.work
    allowance.require(replace(whole.cost, work=work), WHAT)

    def attempt(share: float) -> float:
        found = exact.solve(share, allowance)
        return np.inf if found is None else found.last

    best, share = _downhill(attempt, largest_share(family.limit, system.time))
    if not isfinite(best):
        return NO_MARGIN
    for slack in SLACKS[1:]:
        found = whole.solve(share, allowance, best * slack)
        if found is not None:
            level = seven_digits(frame.level * best * slack)
            claim = replace(every, shares=(seven_digits(share),), level=level)
            yield from map(Candidate, _rounded(claim, whole, found, family.exponents))
    return None


def _downhill(attempt: Callable[[float], float], top: float) -> tuple[float, float]:
    """Follow the values of shares down from a usual one, and return the least with its share."""
    start = USUAL * top
    best = attempt(start), start
    for factor in (1 / STEP, STEP):
        share = factor * start
        while SMALLEST_SHARE * top < share < top and (found := (attempt(share), share)) < best:
            best, share = found, factor * share
        if best[1] != start:
            break
    return best


@dataclass(frozen=True)
class _Units:
    """Coordinates in which state, disturbances, errors and output are about one."""

    states: Array  # Shape (n, n). The T of ``x = T z``.
    disturbances: int  # How many there are; each is at most one
    errors: Array
    level: float
    weak: tuple[int, ...]  # Disturbances that do next to nothing: little is to be gained from them

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
    facts: dict[str, Array]  # What each multiplier takes away
    names: tuple[str, ...]  # Of the multipliers; those without a fact are zero
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

        facts, names = dict[str, Array](), list[str]()
        weak = [step.states + k for k in units.weak]
        for name, left, right in step.products:
            one, other = floats([left, right])
            form = np.outer(one, other) + np.outer(other, one)
            felt = [k for k in weak if np.abs(form[k]).max() > FELT * np.abs(form).max()]
            # The square of a disturbance is needed whatever it does.
            if all(form[k, k] for k in felt):
                facts[name] = form
            names.append(name)
        for name, i, q, below in step.errors:
            (row,) = floats([q], below)
            e = np.eye(count)[i] * T[i, i]
            facts[name] = np.outer(row, row) - np.outer(e, e)
            names.append(name)
        kind = step.source, step.target, len(step.rows), len(facts), step.is_flow
        M = after @ floats(step.rows, step.over)
        return cls(kind, np.eye(step.states, count), M, facts, tuple(names), step.is_flow)

    def images(self, basis: Array, share: float) -> Array:
        """Return what it makes of every form of a basis."""
        S, M = self.S, self.M
        before = basis[:, : len(S), : len(S)]
        if self.is_flow:
            half = S.T @ (before @ M)
            return np.asarray(-(half + np.swapaxes(half, 1, 2)) - share * (S.T @ before @ S))
        after = basis[:, : len(M), : len(M)]
        return np.asarray((1 - share) * (S.T @ before @ S) - M.T @ after @ M)

    def is_near(self, other: _Condition) -> bool:
        """Tell whether floating point can hardly tell it from another."""
        numbers = ([one.M, *one.facts.values()] for one in (self, other))
        return self.kind == other.kind and all(
            np.abs(one - two).max() <= NEARLY * np.abs(one).max()
            for one, two in zip(*numbers, strict=True)
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
            for name, other in zip(own.names, like.names, strict=True):
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
        return cls(
            units, tuple(kept), stands, {k: v or 1.0 for k, v in scales.items()}, tuple(rows)
        )

    @property
    def order(self) -> int:
        """Entries of the form."""
        return len(self.units.states) + 1

    @property
    def cost(self) -> Cost:
        """What solving it is predicted to take."""
        k = self.order * (self.order + 1) // 2
        felt = Counter(name for item in self.conditions for name in item.facts)
        shared = k + 1 + sum(count > 1 for count in felt.values())
        cones = [(item.M.shape[1], k + 1 + len(item.facts)) for item in self.conditions]
        cones += [(self.order, k + 2)] * (1 + len(self.ends)) + [(1, 1)] * len(self.scales)
        return program_cost(k + 1 + len(self.scales), shared, cones)

    def solve(
        self, share: float, allowance: Allowance, level: float | None = None
    ) -> _Found | None:
        """Minimize the level; or, for a given one, leave as much to spare as possible."""
        begun = begin(allowance, self.cost, WHAT)
        basis = symmetric_basis(self.order)
        place = {name: len(basis) + i for i, name in enumerate(self.scales)}
        blocks, last = Blocks(), len(basis) + len(place)

        def add(images: dict[int, Array], block: Array | float = 0.0) -> None:
            """Leave something to spare in a block, or let the level enter it as it does."""
            if level is not None:
                images = {**images, last: -np.eye(len(images[0]))}
            blocks.add(block, images)

        for item in self.conditions:
            images = dict(enumerate(item.images(basis, share)))
            add(images | {place[f]: -form / self.scales[f] for f, form in item.facts.items()})
        add(dict(enumerate(basis[:, 1:, 1:])))
        blocks.add(0.0, dict(enumerate(-basis[:, :1, :1])))
        one = np.zeros((self.order, self.order))
        one[0, 0] = 1.0
        for name, row in self.ends:
            block, image = np.zeros_like(one), np.zeros_like(one)
            block[0, 1:] = block[1:, 0] = -row / 2
            image[0, -1] = image[-1, 0] = -0.5
            images = {**dict(enumerate(basis)), place[name]: image}
            if level is None:
                images[last] = -one
            add(images, block + (level or 0.0) * one)
        for column in place.values():
            blocks.add(0.0, {column: np.ones((1, 1))})
        if level is not None:
            blocks.add(1.0, {last: -np.ones((1, 1))})
        reached = blocks.maximize(last + 1, begun)
        if reached is None or (level is None) == (reached.x[-1] >= 0) or not reached.x[-1]:
            return None
        x = reached.x
        found = {name: float(x[place[name]] / scale) for name, scale in self.scales.items()}
        Q = np.asarray(np.tensordot(x[: len(basis)], basis, axes=1))
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
    given = np.array([found.multipliers.get(name, 0.0) for name in program.stands.values()])
    for bits in BITS:
        rows, log2 = unscale(near, shifts, bits)
        known = dict(zip(program.stands, numerators(units.level * given, log2), strict=True))
        taus = tuple(known[f"rounding {i}"] for i, _ in enumerate(item.roundings, 1))
        own = tuple(m for name, m in known.items() if not name.startswith("rounding "))
        yield replace(item, Q=rows, denominator_log2=log2, multipliers=own, roundings=taus)
