"""TRUSTED: steps for functions of the state and one, and the products that are known in them.

The number one is a state in front of the others, that never changes. So a function ``[1; w]' W
[1; w]`` is a form of the states, and what is known of the signs of linear forms multiplies:

- in contact that may be lost, the deflection is positive; in discrete time, of the row that gives
  the next one the sign is known where such contact stays, is lost or is made. Where the axis cannot
  leave what it touches, nothing is known of either (`nrs_design.proof.steps.KEPT`);
- ``1 + d >= 0`` and ``1 - d >= 0`` for every disturbance d, in units of its bound.

*Averages of modes.* A product of a row of the mode has one multiplier for all modes of a place: it
is affine in the row, so an average of these products is the product for the average. A product of
the others is the same in all modes, so every mode may have a multiplier of its own. Two rows of the
mode are not multiplied with each other, nor one with itself: that would not be affine.

*Landing.* In the air the deflection is not followed. After landing it is anywhere from zero to the
row of the mode: the surface may come to meet the axis, at any moment. The function is convex in the
deflection, so both ends suffice, and the end at zero is a step in the air.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from nrs_design.proof.channels import Channel, Rounding
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.steps import CONTACT, FREE, Acting, Row, Step, steps_of
from nrs_design.proof.system import SwitchedSystem

Matrices = tuple[RationalMatrix, ...]


def offset_steps(
    system: SwitchedSystem, channels: Sequence[Channel], grain: int, *, rounding: bool
) -> Iterator[Step]:
    """Yield every step that takes time, for the state behind a one, with its products.

    Of one axis, under disturbances at once; `grain` as of `steps_of`.
    """
    acting = Acting(
        tuple(map(system.channels.index, channels)), (Fraction(0),) * len(channels), rounding
    )
    for step in steps_of(_with_one(system), acting, grain, lost=True):
        lands = step.source == FREE and step.target == CONTACT and len(step.rows) <= system.order
        if step.time and not lands:
            yield replace(step, crossings=(), products=tuple(_products(step, len(channels))))


def _products(step: Step, channels: int) -> Iterator[tuple[str, Row, Row]]:
    """Yield every known product: its name, and two factors that are not negative."""
    n, units = step.states, step.units
    pairs = [
        [_row(step, {0: units[0], k: sign * units[k]}) for sign in (1, -1)]
        for k in range(n, n + channels)
    ]
    sides = [side for pair in pairs for side in pair]
    deflected = [_row(step, {n - 1: units[n - 1]})] if step.source == CONTACT else []
    factors = [*pairs, *([deflected[0], side] for side in sides if deflected)]
    for i, (left, right) in enumerate(factors):
        yield f"{step.where}: {i}", left, right
    # What crosses the surface, or pulls, is not positive; what stays in contact is.
    signs: list[tuple[str, Row]] = []
    signs += ((name, [-entry for entry in row]) for name, row, _ in step.crossings)
    if not step.is_flow and step.target == CONTACT:
        signs.append(("after", step.rows[-1]))
    kind = step.where.removesuffix(step.mode)
    for name, row in signs:
        for i, other in enumerate((*deflected, *sides)):
            yield f"{kind}{name}: {i}", row, other


def _row(step: Step, entries: dict[int, int]) -> Row:
    return [entries.get(i, 0) for i in range(len(step.units))]


def _with_one(system: SwitchedSystem) -> SwitchedSystem:
    """Return the system with a state in front that is one, and disturbances up to one."""
    contact, corner = system.contact, int(system.time is Time.DISCRETE)

    def moved(modes: Sequence[Mode]) -> tuple[Mode, ...]:
        return tuple(replace(mode, A=_bordered(mode.A, corner)) for mode in modes)

    def below(columns: Sequence[RationalMatrix], size: Fraction | int = 1) -> Matrices:
        return tuple(
            RationalMatrix.from_rows([(0,), *((size * b,) for (b,) in column.fractions())])
            for column in columns
        )

    def behind(row: RationalMatrix) -> RationalMatrix:
        sizes = [*(Fraction(1) for _ in system.states), *(c.bound for c in system.channels)]
        scaled = (x * size for x, size in zip(row.fractions()[0], sizes, strict=True))
        return RationalMatrix.from_rows([(Fraction(0), *scaled)])

    if contact is not None:
        pull_rows = (RationalMatrix(((0, *q.numerators[0]),), q.denominator) for q in contact.pulls)
        contact = replace(contact, free=moved(contact.free), pulls=tuple(pull_rows))
    return replace(
        system,
        states=("one", *system.states),
        modes=moved(system.modes),
        contact=contact,
        channels=tuple(replace(c, columns=below(c.columns, c.bound)) for c in system.channels),
        roundings=tuple(
            Rounding(r.name, below(r.columns), tuple(map(behind, r.rows))) for r in system.roundings
        ),
    )


def _bordered(A: RationalMatrix, corner: int) -> RationalMatrix:
    """Return the matrix behind a first row and column that are zero but for the corner."""
    rows = ((corner * A.denominator, *(0 for _ in A.numerators)), *((0, *r) for r in A.numerators))
    return RationalMatrix(tuple(rows), A.denominator)
