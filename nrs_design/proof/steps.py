"""TRUSTED: what one step does to a quadratic function, with disturbances and rounded arithmetic.

The state moves by ``x+ = A x + B d + C r`` with ``|d_i| <= bound_i`` and ``|r_i| <= |q_i (x, d)|``.
Every motion gives one form in (x, d, r)

    keeps before(x) + sum weight_i d_i^2 + sum tau_i (r_i^2 - (q_i (x, d))^2) - after(x+)

with all ``tau_i >= 0``. If it is positive definite, ``after <= keeps before + sum weight_i d_i^2``
for every error within its limit (S-procedure). Where contact may be lost, before and after are
``y' Q_yy y`` free and ``x' Q x`` in contact; where a step loses it, ``delta`` is positive and its
next value, the last row times (x, d, r), is not, so that twice lambda >= 0 times their product is
added. One lambda and one tau_i for all modes keep the forms concave in the maps.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm

from nrs_design.proof.exact import IntegerMatrix, congruence
from nrs_design.proof.matrix import RationalMatrix, leading, with_crossing
from nrs_design.proof.system import Rounding, SwitchedSystem

# A row, and a matrix, of integers over a denominator.
Row = tuple[Sequence[int], int]
Map = tuple[list[list[int]], int]


@dataclass(frozen=True, slots=True)
class Steps:
    """The numbers of a quadratic function in discrete time.

    Parameters
    ----------
    Q : tuple of tuple of int, shape (n, n)
        Numerators of the symmetric matrix.
    denominator_log2 : int
        Q, lambda and the tau are these numerators over two to this power.
    keeps : Fraction
        What a step leaves of the function: rho^2, or one minus the shares of the disturbances.
    crossing : int
        The lambda; it says nothing where contact is kept.
    roundings : tuple of int
        The tau, in the order of the roundings of the system; none if it is to compute exactly.
    channels : tuple of int
        Which disturbances of the system act.
    weights : tuple of Fraction
        One for each of them.
    """

    Q: IntegerMatrix
    denominator_log2: int
    keeps: Fraction
    crossing: int = 0
    roundings: tuple[int, ...] = ()
    channels: tuple[int, ...] = ()
    weights: tuple[Fraction, ...] = ()

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield the form of every motion, times a positive number, with where it is."""
        n, inner = len(self.Q), leading(self.Q)
        for k, mode in enumerate(system.modes):
            map_, rows = self._map(system, k, mode.A), self._rows(system, k)
            yield f"in mode {mode.name}", self._form(self.Q, map_, self.Q, rows)
            if system.contact is None:
                continue
            (*others, last), d = map_
            lost = self._form(self.Q, (others, d), inner, rows)
            factor = self.crossing * self._clearing(rows) * d
            lost = with_crossing(lost, n - 1, [factor * entry for entry in last])
            yield f"where contact is lost in mode {mode.name}", lost
        for k, mode in enumerate(system.contact.free if system.contact is not None else ()):
            N, d = self._map(system, len(system.modes) + k, mode.A)
            rows = [(_without(q, n - 1), e) for q, e in self._rows(system, len(system.modes) + k)]
            moved = [_without(row, n - 1) for row in N]
            kept = self._form(inner, (moved[:-1], d), inner, rows)
            yield f"in free motion, mode {mode.name}", kept
            made = self._form(inner, (moved, d), self.Q, rows)
            yield f"where contact is made, mode {mode.name}", made

    def _map(self, system: SwitchedSystem, k: int, A: RationalMatrix) -> Map:
        """Return ``[A, B, C]`` of the k-th mode over one denominator."""
        columns = [system.channels[i].columns[k] for i in self.channels]
        columns += [item.columns[k] for item in self._covered(system)]
        parts = (A, *columns)
        d = lcm(*(part.denominator for part in parts))
        scaled = [
            [[d // part.denominator * entry for entry in row] for row in part.numerators]
            for part in parts
        ]
        return [[entry for row in rows for entry in row] for rows in zip(*scaled, strict=True)], d

    def _rows(self, system: SwitchedSystem, k: int) -> list[Row]:
        """Return the rows q over the state and the disturbances that act."""
        n = len(self.Q)
        rows: list[Row] = []
        for item in self._covered(system):
            (entries,), denominator = item.rows[k].numerators, item.rows[k].denominator
            rows.append(([*entries[:n], *(entries[n + i] for i in self.channels)], denominator))
        return rows

    def _covered(self, system: SwitchedSystem) -> tuple[Rounding, ...]:
        return system.roundings[: len(self.roundings)]

    def _clearing(self, rows: Sequence[Row]) -> int:
        """Return the factor that clears all denominators but those of Q and of the map."""
        squares = (denominator**2 for _, denominator in rows)
        return lcm(self.keeps.denominator, *(w.denominator for w in self.weights), *squares)

    def _form(
        self,
        before: IntegerMatrix,
        map_: tuple[IntegerMatrix, int],
        after: IntegerMatrix,
        rows: Sequence[Row],
    ) -> list[list[int]]:
        """Return the form of one motion, times the square of its denominator and the rest."""
        N, d = map_
        n, clearing = len(before), self._clearing(rows)
        form = [[-clearing * entry for entry in row] for row in congruence(N, after)]
        whole = clearing * d**2
        kept = int(whole * self.keeps)
        for i, row in enumerate(before):
            for j, entry in enumerate(row):
                form[i][j] += kept * entry
        for i, weight in enumerate(self.weights, n):
            form[i][i] += int(whole * weight) << self.denominator_log2
        for i, (tau, (q, denominator)) in enumerate(
            zip(self.roundings, rows, strict=True), n + len(self.weights)
        ):
            form[i][i] += whole * tau
            factor = tau * (whole // denominator**2)
            for a, left in enumerate(q):
                for b, right in enumerate(q):
                    form[a][b] -= factor * left * right
        return form


def _without(row: Sequence[int], k: int) -> list[int]:
    return [*row[:k], *row[k + 1 :]]


def find_odd_roundings(roundings: tuple[int, ...], system: SwitchedSystem) -> str | None:
    """TRUSTED: say why multipliers do not belong to the roundings of a system, or None.

    Parameters
    ----------
    roundings : tuple of int
        The tau of `Steps`; none for exact arithmetic.
    system : SwitchedSystem
        Whose arithmetic it is.
    """
    if roundings and len(roundings) != len(system.roundings):
        return "there is not one multiplier for each rounding"
    if any(entry < 0 for entry in roundings):
        return "the multiplier of a rounding is negative"
    return None
