"""Signals of a loop that are cut off at limits, and what the loop does between its limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from nrs_design.proof.matrix import RationalMatrix

# There are two to this power of matrices for each mode.
MOST_SIGNALS = 4


@dataclass(frozen=True, slots=True)
class CutOff:
    """A signal ``s`` that saturates: ``s = min(max(a, -limit), limit)``.

    Its argument is ``a = q (x, s_1, ..., s_j)``, where the s_i are the signals before it.
    """

    # What it is, such as ``velocity command`` in ``rad/s``.
    name: str
    unit: str
    limit: Fraction  # Where it is cut off, both ways
    # Shape (n, 1). What it does to the state, in every mode and after them in the free modes.
    columns: tuple[RationalMatrix, ...]
    # Shape (1, n + number of signals before it). The q in the same order; in free motion nothing in
    # them stands for the deflection.
    rows: tuple[RationalMatrix, ...]


@dataclass(frozen=True, slots=True)
class Start:
    """States that a motion begins in: a size times any mixture of some of them."""

    # What the size is of, such as ``contact force`` in ``N*m``.
    name: str
    unit: str
    # Shape (n, 1). At the size one, at the corners of the ranges.
    states: tuple[RationalMatrix, ...]
    # The size that a statement is meant to reach; for words and searches only.
    wanted: Fraction | None = None


@dataclass(frozen=True, slots=True)
class Saturation:
    """What saturates in a loop, and how motions begin that a statement about it names.

    The modes say what the loop does while nothing is cut off. Beyond that it is
    ``x' = A x + sum c_i (s_i - l_i x)``, where ``l_i x`` is what ``s_i`` were if nothing was.
    """

    signals: tuple[CutOff, ...]  # Each may depend on those before it
    start: Start  # How motions begin

    def between(
        self, A: RationalMatrix, k: int, held: Sequence[Sequence[Fraction]]
    ) -> Iterator[RationalMatrix]:
        """Yield the matrices between which the loop is while every ``|h x|`` is within its limit.

        The signal is then a mixture of its argument and of ``h x``, since it is the argument cut
        off at a limit that ``h x`` keeps.

        Parameters
        ----------
        A : RationalMatrix, shape (n, n)
            The k-th mode, of those in contact and after them those that are free.
        k : int
            Which.
        held : sequence of rows, each of n numbers
            The h of every signal.
        """
        rows = A.fractions()
        linear = self._signals(k, held, (False,) * len(self.signals))
        for replaced in product((False, True), repeat=len(self.signals)):
            moved = [list(row) for row in rows]
            taken = self._signals(k, held, replaced)
            for signal, new, old in zip(self.signals, taken, linear, strict=True):
                for row, (c,) in zip(moved, signal.columns[k].fractions(), strict=True):
                    for j, (other, own) in enumerate(zip(new, old, strict=True)):
                        row[j] += c * (other - own)
            yield RationalMatrix.from_rows(moved)

    def _signals(
        self, k: int, held: Sequence[Sequence[Fraction]], replaced: Sequence[bool]
    ) -> list[list[Fraction]]:
        """Return every signal as a row over the state: its argument, or the h in its place."""
        found: list[list[Fraction]] = []
        for signal, h, other in zip(self.signals, held, replaced, strict=True):
            row = signal.rows[k].fractions()[0]
            argument = row[: len(h)]
            for share, before in zip(row[len(h) :], found, strict=True):
                argument = [a + share * b for a, b in zip(argument, before, strict=True)]
            found.append(list(h) if other else argument)
        return found
