"""TRUSTED: the modes between which a loop is although signals of it saturate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem

Rows = list[list[Fraction]]


def between(
    system: SwitchedSystem,
    held: Sequence[Sequence[Sequence[Fraction]]],
    *,
    rounding: bool = False,
) -> SwitchedSystem:
    """Return a system of which the saturating one is a mixture while every ``|h x|`` is in limits.

    Each mode becomes one for every choice of arguments and rows h, as `Saturation.changes` makes
    them. What the arithmetic adds to an argument is replaced with it: an error r that has a share
    of the argument has the same share of the mixture. All of the state after a step, or of its
    derivative, is affine in each share. `held` are the h of every signal, in every mode and after
    them in the free modes; roundings are kept on demand.
    """
    saturation = system.saturation
    assert saturation is not None  # only saturating systems are embedded
    n, signals = system.order, saturation.signals
    items = system.roundings if rounding else ()
    modes: list[Mode] = []
    errors: list[tuple[list[RationalMatrix], list[RationalMatrix]]] = [([], []) for _ in items]
    for k, mode in enumerate(system.every_mode):
        columns = [[c for (c,) in signal.columns[k].fractions()] for signal in signals]
        whole = [
            [*row, *(item.columns[k].fractions()[i][0] for item in items)]
            for i, row in enumerate(mode.A.fractions())
        ]
        for number, changes in enumerate(saturation.changes(k, held[k], len(items))):
            changed_rows = _plus(whole, columns, changes)
            A = RationalMatrix.from_rows([row[:n] for row in changed_rows])
            modes.append(Mode(f"{mode.name}, {number}", A))
            for j, (item, (acts, sizes)) in enumerate(zip(items, errors, strict=True)):
                acts.append(RationalMatrix.from_rows([[row[n + j]] for row in changed_rows]))
                sizes.append(_cut(item.rows[k], n))
    count = len(modes) // len(system.every_mode) * len(system.modes)
    contact = system.contact
    if contact is not None:
        contact = replace(contact, free=tuple(modes[count:]))
    return replace(
        system,
        modes=tuple(modes[:count]),
        contact=contact,
        channels=(),
        outputs=(),
        roundings=tuple(
            replace(item, columns=tuple(acts), rows=tuple(sizes))
            for item, (acts, sizes) in zip(items, errors, strict=True)
        ),
        saturation=None,
        enclosures=(),
    )


def _plus(rows: Rows, columns: Rows, changes: Rows) -> Rows:
    """Return rows with the changes of all signals, each by its column, added to them."""
    moved = [list(row) for row in rows]
    for column, change in zip(columns, changes, strict=True):
        for row, c in zip(moved, column, strict=True):
            row[:] = [entry + c * difference for entry, difference in zip(row, change, strict=True)]
    return moved


def _cut(row: RationalMatrix, n: int) -> RationalMatrix:
    return RationalMatrix(tuple(tuple(entries[:n]) for entries in row.numerators), row.denominator)
