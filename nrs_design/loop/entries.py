"""The entries of ``exp([[A, B], [0, 0]] h)`` in balls: how a drive moves its states in a time h.

Below them is a row for the velocity where it jumps with the command. The deflection counts from
where it is when the time begins.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Any

from nrs_design.errors import AssemblyError
from nrs_design.models.drive import Drive, MultiAffine
from nrs_design.models.linear_form import ONE, ZERO
from nrs_design.proof.enclosure import ball_around, fraction_of

if TYPE_CHECKING:
    from flint import arb, arb_mat

# Longest period in time constants of the drive: the initial state has decayed long before.
LONGEST = Fraction(2000)


@dataclass(frozen=True, slots=True)
class Entries:
    """Transition matrix and unit response of a drive; the gain is factored out."""

    drive: Drive

    def rates(self, values: Mapping[str, Any], symbol: str = "") -> arb_mat:
        """Return ``G = [[A, B], [0, 0]]`` at some numbers, or its derivative by one of them."""
        return _filled(self.drive.rates, values, symbol, self.drive.order + 1)

    def evaluate(self, values: Mapping[str, Any], h: arb) -> arb_mat:
        """Return the entries at some numbers and a time."""
        return self.jet(values, h, "", h, 0)[0]

    def acting(self, values: Mapping[str, Any]) -> list[list[bool]]:
        """Return the entries that are not identically zero, row by row as `evaluate`."""
        G = _sizes(self.rates(values))
        n, m = self.drive.order, self.drive.order + 1
        paths = step = G
        for _ in range(m):
            step = G * step
            paths += step
        found = [
            [i == j != n - 1 or not bool(paths[i, j] == 0) for j in range(m)] for i in range(n)
        ]
        if (speed := self.drive.speed) is not None:
            L = _sizes(_filled(speed, values, "", 1, m))
            row = L + L * paths
            found.append([not bool(row[0, j] == 0) for j in range(m)])
        return found

    def jet(
        self, values: Mapping[str, Any], h: arb, symbol: str, width: arb, order: int
    ) -> list[arb_mat]:
        """Return the entries and their Taylor coefficients along the range of a number.

        They are in shares of the width. `symbol` names the number; it is empty for the time. With
        ``G = G0 + t D``, those of ``exp(G h)`` are the first row of blocks of the exponential of
        the block matrix with ``G0 h`` on the diagonal and ``D h`` beside it. Those by the time are
        ``(width G)^k exp(G h)/k!``.
        """
        from flint import arb_mat

        G = self.rates(values)
        if symbol:
            D = self.rates(values, symbol) * (h * width)
            blocks = _first_blocks(G * h, D, order)
        else:
            blocks = [(G * h).exp()]
            for k in range(order):
                blocks.append(G * blocks[-1] * (width / (k + 1)))
        n, m = self.drive.order, self.drive.order + 1
        found = [[[M[i, j] for j in range(m)] for i in range(n)] for M in blocks]
        found[0][n - 1][n - 1] -= 1
        if (speed := self.drive.speed) is not None:
            L = _filled(speed, values, "", 1, m)
            slope = _filled(speed, values, symbol, 1, m) * width if symbol else arb_mat(1, m)
            for k, M in enumerate(blocks):
                row = L * M + (slope * blocks[k - 1] if k else arb_mat(1, m))
                found[k].append([row[0, j] for j in range(m)])
        return [arb_mat(rows) for rows in found]

    def bound_change(self, values: Mapping[str, Any], h: arb, widths: Mapping[str, arb]) -> arb_mat:
        """Return bounds on the change of the entries under a load that varies within the time.

        `widths` are those of the ranges of the load. Let ``A(s) = A + (k(s) - k) N`` be the
        generator, with entries of at most M by size, k the mean of a number of the load, and E(s)
        the transition until s. The state is off by the integral of ``(k(s) - k) g(s)`` with ``g =
        exp(A (h - s)) N E(s)``. The first factor has the mean zero and a range of some width, so
        that is at most ``h^2/8`` times the width and the largest derivative of g (Ostrowski 1970),
        which is at most ``exp(M h) (|N| M + M |N|) exp(M h)``. The part of commands is off by at
        most the integral of ``exp(M (h - s)) |N| exp(M s)``: the corner block of the exponential of
        ``[[M, |N|], [0, M]] h``.
        """
        from flint import arb_mat

        # No loaded drive has a velocity that jumps, so there is no row for a jump.
        assert self.drive.speed is None or not self.drive.loaded
        m = self.drive.order + 1
        M, total = _sizes(self.rates(values)), arb_mat(m, m)
        growth = (M * h).exp()
        for symbol, width in widths.items():
            N = _sizes(self.rates(values, symbol))
            states = growth * (N * M + M * N) * growth * (width * h * h / 8)
            _, commands = _first_blocks(M * h, N * h, 1)
            total += arb_mat(
                [
                    [width * commands[i, j] if j == m - 1 else states[i, j] for j in range(m)]
                    for i in range(m)
                ]
            )
        return total

    def check_length(self, values: Mapping[str, Any], longest: Fraction) -> None:
        """Refuse a period of so many time constants that its exponential is out of reach."""
        M, n = _sizes(self.rates(values)), self.drive.order
        # States may be in any units: powers hardly notice.
        for _ in range(3):
            M = M * M
        size = sum((highest(M[i, j]) for i in range(n) for j in range(n)), ZERO)
        if size > (LONGEST / longest) ** 8:
            raise too_long()


def too_long() -> AssemblyError:
    """Return the error for a period that no enclosure fits."""
    return AssemblyError(
        "a period is too long for the drive and its contact: it spans too many of their "
        "time constants, or their ranges are too wide for an enclosure",
        remedy="sample with a shorter period, or narrow the ranges",
        at=("sampling", "period"),
    )


def exact_rows(M: MultiAffine, values: Mapping[str, Fraction]) -> list[list[Fraction]]:
    """Return a matrix at exact numbers."""
    total: list[list[Fraction]] = []
    for symbols, rows in M.terms.items():
        factor = prod((values[s] for s in symbols), start=ONE)
        total = total or [[ZERO] * len(row) for row in rows]
        total = [
            [a + factor * c for a, c in zip(sums, row, strict=True)]
            for sums, row in zip(total, rows, strict=True)
        ]
    return total


def highest(x: arb) -> Fraction:
    """Return an upper bound of a ball; an `OverflowError` for an unbounded ball."""
    return fraction_of(_finite(x).upper())


def lowest(x: arb) -> Fraction:
    """Return a lower bound of a ball; an `OverflowError` for an unbounded ball."""
    return fraction_of(_finite(x).lower())


def middle(x: arb) -> Fraction:
    """Return the middle of a ball; an `OverflowError` for an unbounded ball."""
    return fraction_of(_finite(x).mid())


def _finite(x: arb) -> arb:
    if not x.is_finite():
        raise OverflowError
    return x


def _first_blocks(diagonal: arb_mat, upper: arb_mat, order: int) -> list[arb_mat]:
    """Return the first row of blocks of the exponential of a matrix of two diagonals of blocks."""
    from flint import arb_mat

    m = diagonal.nrows()
    whole = arb_mat(m * (order + 1), m * (order + 1))
    for b, i, j in product(range(order + 1), range(m), range(m)):
        whole[m * b + i, m * b + j] = diagonal[i, j]
        if b < order:
            whole[m * b + i, m * (b + 1) + j] = upper[i, j]
    E = whole.exp()
    return [
        arb_mat([[E[i, m * b + j] for j in range(m)] for i in range(m)]) for b in range(order + 1)
    ]


def _filled(
    M: MultiAffine, values: Mapping[str, Any], symbol: str, height: int, width: int = 0
) -> arb_mat:
    """Return a matrix of balls, or its derivative by a number, with zeros below."""
    from flint import arb, arb_mat

    width = width or height
    total = arb_mat(height, width)
    for symbols, rows in (M.slope(symbol) if symbol else M).terms.items():
        factor = prod((values[s] for s in symbols), start=arb(1))
        filled = [[factor * ball_around(c) for c in row] for row in rows]
        total += arb_mat([*filled, *[[0] * width] * (height - len(filled))])
    return total


def _sizes(M: arb_mat) -> arb_mat:
    """Return the largest sizes of the entries of a matrix of balls."""
    from flint import arb_mat

    return arb_mat([[M[i, j].abs_upper() for j in range(M.ncols())] for i in range(M.nrows())])
