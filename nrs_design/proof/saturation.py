"""What a program limits: signals that are cut off."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from nrs_design.proof.matrix import RationalMatrix

# There are two to this power of matrices for each mode.
MOST_SIGNALS = 4
ZERO = Fraction(0)


@dataclass(frozen=True, slots=True, kw_only=True)
class CutOff:
    """A signal ``s`` that saturates: ``s = min(max(a, -limit), limit)``.

    Its argument is ``a = q (x, s_1, ..., s_j)``, where the s_i are the signals before it.
    """

    # Quantity, such as ``velocity command`` in ``rad/s``.
    name: str
    unit: str
    limit: Fraction  # The signal is cut off at plus and minus this
    # Shape (n, 1). What it does to the state, in every mode and after them in the free modes.
    columns: tuple[RationalMatrix, ...]
    # Shape (1, n + number of signals before it). The q in the same order; in free motion nothing in
    # them stands for the deflection.
    rows: tuple[RationalMatrix, ...]
    # Shape (1, roundings of the system). What these add to its argument, in the same order; none
    # where nothing is said of that.
    errors: tuple[RationalMatrix, ...] = ()


@dataclass(frozen=True, slots=True)
class Start:
    """States that a motion begins in: a size times any mixture of some of them."""

    # Quantity of the size, such as ``contact force`` in ``N*m``.
    name: str
    unit: str
    # Shape (n, 1). At the size one, at the corners of the ranges.
    states: tuple[RationalMatrix, ...]
    # The size that a statement is meant to reach; for words and searches only.
    wanted: Fraction | None = None
    # What of such a state is neither at rest nor zero: it is that under one of the controllers.
    beside: str = ""

    @property
    def exception(self) -> str:
        """Its exception in words that begin with a comma; empty if there is none."""
        if not self.beside:
            return ""
        return f", the {self.beside} being what it is then under one of the controllers"


@dataclass(frozen=True, slots=True)
class Saturation:
    """What saturates in a loop, and how motions begin that a statement about it names.

    The modes say what the loop does while nothing is cut off. Beyond that it is
    ``x' = A x + sum c_i (s_i - l_i x)``, where ``l_i x`` is what ``s_i`` were if nothing was; in
    discrete time ``x+`` is that.
    """

    signals: tuple[CutOff, ...]  # Each may depend on those before it
    start: Start  # How motions begin

    def changes(
        self, k: int, held: Sequence[Sequence[Fraction]], errors: int
    ) -> Iterator[list[list[Fraction]]]:
        """Yield by how much the signals differ from what they are while nothing is cut off.

        While every ``|h x|`` is within its limit, the loop is between these: a signal is then a
        mixture of its argument and of ``h x``, since it is the argument cut off at a limit that
        ``h x`` keeps. It is about the k-th mode, of those in contact and after them those that are
        free; `held` are the h of every signal. Each is a row for every signal, with so many errors
        behind the state.
        """
        wide = [[*h, *(ZERO,) * errors] for h in held]
        linear = self._signals(k, wide, errors, (False,) * len(self.signals))
        for replaced in product((False, True), repeat=len(self.signals)):
            values = self._signals(k, wide, errors, replaced)
            yield [
                [new - old for new, old in zip(*rows, strict=True)]
                for rows in zip(values, linear, strict=True)
            ]

    def _signals(
        self, k: int, held: Sequence[Sequence[Fraction]], errors: int, replaced: Sequence[bool]
    ) -> list[list[Fraction]]:
        """Return every signal as a row over the state and errors: its argument, or the h."""
        found: list[list[Fraction]] = []
        for signal, h, other in zip(self.signals, held, replaced, strict=True):
            row, n = signal.rows[k].fractions()[0], len(h) - errors
            off = signal.errors[k].fractions()[0] if errors else []
            argument = [*row[:n], *off]
            for share, before in zip(row[n:], found, strict=True):
                argument = [a + share * b for a, b in zip(argument, before, strict=True)]
            found.append(list(h) if other else argument)
        return found
