"""Search for small invariant ellipsoids: how far a disturbance can push an output (untrusted).

For a fixed share of the disturbances, the conditions of `nrs_design.proof.evidence` are linear in
the form, the multipliers and the level, or its square. The best share is sought; then the level is
fixed a little above the least one, and the conditions are satisfied with as much to spare as
possible.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.evidence import InvariantEllipsoid, OffsetEllipsoid
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import ROUNDING, multiplier_names
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.family import Family, separating_coordinates, to_floats
from nrs_design.search.one_form import (
    SHARE,
    Constraint,
    FormSolution,
    OneForm,
    StepUnits,
    of_roundings,
    plain_steps,
)
from nrs_design.search.rates import share_of
from nrs_design.search.work import Allowance

Array = NDArray[np.float64]

# Shares that are tried first, relative to the largest; factor between the next ones; number of
# refinements of the best; smallest share.
USUAL, STEP, REFINED = (0.38, 0.15, 0.06, 0.024, 0.009, 0.8), 1.5, 3
SMALLEST = 0.001
# Claimed levels relative to the least level; the nearer, the harder to round.
SLACKS = (1.002, 1.01, 1.02, 1.03, 1.1)
# Steps of a response that is summed for the scale.
STEPS = 4000


@dataclass(frozen=True)
class Frame:
    """StepUnits ``x = T z`` and a unit of the output, in which both are about one."""

    T: Array
    level: float

    @classmethod
    def of(
        cls, system: SwitchedSystem, channels: Sequence[Channel], output: Output
    ) -> Frame | None:
        """Return the frame of a system; None if it is beyond floating point."""
        family = Family.of(system)
        T = np.ldexp(separating_coordinates(family), family.exponents[:, None])
        sizes = [float(channel.bound) for channel in channels]
        columns = [to_floats(c.columns) * size for c, size in zip(channels, sizes, strict=True)]
        pushed = np.linalg.inv(T) @ np.concatenate(columns, axis=2)[: len(system.modes)]
        modes = np.linalg.inv(T) @ to_floats([mode.A for mode in system.modes]) @ T
        rows = to_floats(output.rows)[:, 0] @ T
        state_size, level = reach_and_level(modes, pushed, rows, system.time)
        found = (
            np.isfinite(T).all()
            and isfinite(state_size)
            and isfinite(level)
            and state_size * level > 0
        )
        return cls(state_size * T, level) if found else None


def reach_and_level(modes: Array, x: Array, rows: Array, time: Time) -> tuple[float, float]:
    """Return how far state and output go under one mode alone.

    Modes of shape (m, n, n), pushed by disturbances up to one with columns of shape (m, n, c).
    """
    dt = np.ones(len(modes))
    if time is Time.CONTINUOUS:
        from scipy.linalg import expm

        dt = 0.1 / np.maximum(np.abs(np.linalg.eigvals(modes)).max(axis=1), 1e-9)
        modes = expm(modes * dt[:, None, None])
    state_size, level = np.zeros(len(modes)), np.zeros(len(modes))
    for _ in range(STEPS):
        state_size += np.linalg.norm(x, axis=(1, 2)) * dt
        level += np.abs(rows @ x).sum(axis=2).max(axis=1) * dt
        x = modes @ x
    return float(state_size.max()), float(level.max())


@dataclass(frozen=True)
class BoundProgram:
    """The ellipsoids that bound an output under disturbances."""

    program: OneForm
    own: StepUnits
    bounds: tuple[Constraint, ...]
    disturbances: int = 0  # That have a share each

    @classmethod
    def around(
        cls,
        system: SwitchedSystem,
        channels: Sequence[Channel],
        output: Output,
        frame: Frame,
        *,
        rounding: bool = False,
    ) -> BoundProgram:
        """Take ellipsoids around the origin, with the square of the level as their level."""
        steps = plain_steps(system, [*map(system.channels.index, channels)], rounding=rounding)
        units = [float(channel.bound) for channel in channels]
        units += [1.0] * (len(system.roundings) * rounding)
        own = StepUnits(frame.T, np.array(units)).balanced(steps)
        program = OneForm.of(steps, own)
        rows = to_floats(output.rows)[:, 0] @ own.T / frame.level
        bounds = tuple(Constraint.bordered(program.basis, row, 1.0) for row in rows)
        return cls(program, own, bounds, len(channels))

    @classmethod
    def off(cls, item: OffsetEllipsoid, system: SwitchedSystem, frame: Frame) -> BoundProgram:
        """Take ellipsoids off the origin, of a state behind a one."""
        steps, n = list(item.steps(system)), system.order
        T = np.eye(n + 1)
        T[1:, 1:] = frame.T
        disturbed = StepUnits(T, np.ones(len(item.channels) + len(item.roundings)))
        units = disturbed.balanced(steps)
        ends = {
            name: sign * np.array(row.floats()[0]) @ frame.T / frame.level
            for name, row, sign in item.ends(system)
        }
        program = OneForm.of(steps, units, dict.fromkeys(ends, float(T[-1, -1])))
        basis, zero = program.basis, np.zeros((n + 1, n + 1))
        one, deflected = zero.copy(), zero.copy()
        one[0, 0], deflected[0, -1], deflected[-1, 0] = 1.0, -T[-1, -1] / 2, -T[-1, -1] / 2
        bounds = [Constraint(zero[1:, 1:], basis[:, 1:, 1:], zero[1:, 1:])]
        bounds.append(Constraint(zero[:1, :1], -basis[:, :1, :1]))
        for name, row in ends.items():
            constant = zero.copy()
            constant[0, 1:] = constant[1:, 0] = -row / 2
            bounds.append(Constraint(constant, basis, one, {name: deflected}))
        return cls(program, units, tuple(bounds))

    def solve(
        self, share: float, allowance: Allowance, level: float | None = None
    ) -> FormSolution | None:
        """Minimize the level, or leave most to spare, for a share of all disturbances together."""
        one = np.ones((1, 1))
        shares = {f"{SHARE} {k + 1}": -one for k in range(self.disturbances)}
        total = Constraint(share * one, np.zeros((len(self.program.basis), 1, 1)), None, shares)
        return self.program.solve(share, (*self.bounds, total), allowance, level)

    def best_share(self, limit: float, time: Time, allowance: Allowance) -> tuple[float, float]:
        """Return the least level found, and the share that gives it."""

        def attempt(share: float) -> float:
            found = self.solve(share, allowance)
            return np.inf if found is None else found.last

        return best_share(attempt, share_of(limit, time))


def search_ellipsoid(
    system: SwitchedSystem, channels: Sequence[Channel], output: Output, allowance: Allowance
) -> Candidates[InvariantEllipsoid]:
    """Yield ellipsoids that bound an output under disturbances at once, the smallest level first.

    The system is stable. Where the arithmetic rounds, ellipsoids that cover that come before
    others.
    """
    frame, limit = Frame.of(system, channels, output), Family.of(system).limit
    if frame is None:
        return OUT_OF_RANGE
    exact = BoundProgram.around(system, channels, output, frame)
    best, share = exact.best_share(limit, system.time, allowance)
    if not isfinite(best):
        return NO_MARGIN
    programs = [exact]
    if system.roundings:
        programs.insert(0, BoundProgram.around(system, channels, output, frame, rounding=True))
    names = tuple(channel.name for channel in channels)
    for bound_program in programs:
        for slack in SLACKS:
            found = bound_program.solve(share, allowance, best * slack**2)
            if found is None:
                continue
            shares = (found.multipliers[f"{SHARE} {k + 1}"] for k in range(len(channels)))
            claimed = (
                tuple(map(seven_digits, shares)),
                seven_digits(frame.level * sqrt(best) * slack),
            )
            for Q, log2, known in found.roundings(bound_program.own.T):
                contact_multipliers = tuple(known[name] for name in multiplier_names(system))
                yield Candidate(
                    InvariantEllipsoid(
                        names,
                        output.name,
                        Q,
                        log2,
                        *claimed,
                        contact_multipliers,
                        of_roundings(known),
                    )
                )
    return None


def search_offset_ellipsoid(
    system: SwitchedSystem, channels: Sequence[Channel], output: Output, allowance: Allowance
) -> Candidates[OffsetEllipsoid]:
    """Yield ellipsoids off the origin, as `search_ellipsoid` does; with the roundings, or none.

    Contact may be lost.
    """
    frame, limit = Frame.of(system, channels, output), Family.of(system).limit
    if frame is None:
        return OUT_OF_RANGE
    names = tuple(channel.name for channel in channels)
    empty = OffsetEllipsoid(names, output.name, (), 0, (Fraction(1, 2),), Fraction(1))
    with_roundings = replace(empty, roundings=(0,) * len(system.roundings))
    exact, whole = (BoundProgram.off(item, system, frame) for item in (empty, with_roundings))
    best, share = exact.best_share(limit, system.time, allowance)
    if not isfinite(best):
        return NO_MARGIN
    for slack in SLACKS[1:]:
        found = whole.solve(share, allowance, best * slack)
        if found is None:
            continue
        level = seven_digits(frame.level * best * slack)
        claim = replace(with_roundings, shares=(seven_digits(share),), level=level)
        for Q, log2, known in found.roundings(whole.own.T, frame.level):
            multipliers = tuple(m for name, m in known.items() if not name.startswith(ROUNDING))
            numbers = replace(claim, multipliers=multipliers, roundings=of_roundings(known))
            yield Candidate(replace(numbers, Q=Q, denominator_log2=log2))
    return None


def seven_digits(number: float) -> Fraction:
    """Return a number with seven digits."""
    return Fraction(f"{number:.6e}")


def best_share(attempt: Callable[[float], float], top: float) -> tuple[float, float]:
    """Return the least value found, and the share that gives it.

    Values are followed down from the best of usual shares, and then by parabolas through the three
    best: a solver that fails at one of them may be right at another.
    """
    values_by_share: dict[float, float] = {}

    def value(share: float) -> float:
        if share not in values_by_share:
            values_by_share[share] = attempt(share)
        return values_by_share[share]

    start = min((s * top for s in USUAL), key=value)
    best = start
    for factor in (1 / STEP, STEP):
        while SMALLEST * top < factor * best < top and value(factor * best) < value(best):
            best *= factor
        if best != start:
            break
    if best == max(values_by_share):
        value((best + top) / 2)  # A parabola needs a share on either side.
    for _ in range(REFINED if isfinite(value(best)) else 0):
        shares = sorted(values_by_share)
        k = shares.index(best)
        neighbours = shares[max(k - 1, 0) : k + 2]
        values = [value(s) for s in neighbours]
        if len(values) < 3 or not np.isfinite(values).all():
            break
        curve = np.polyfit(np.log(neighbours) - np.log(best), values, 2)
        if not curve[0] > 0:
            break
        value(best * float(np.exp(-curve[1] / (2 * curve[0]))))
        best = min(values_by_share, key=lambda share: values_by_share[share])
    return value(best), best
