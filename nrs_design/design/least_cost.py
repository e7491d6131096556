"""A lower bound on a cost of two gains, proved by branch and bound with balls.

At a frequency omega an admittance is ``y = Bt + j (Mt omega - Kt/omega)``, and with the open loop
F in the place of y = 1 the sensitivity there is ``L = |y/(y + F)|``. The cost is the mean over
given frequencies of ``wD |log10 t - log10 L| + wR L``: a finite sum, so no error of a quadrature.

Over a box of Mt and Bt, ``|a| >= s a`` for either sign s. With signs as they are in the middle,
what is left is smooth, and not below its value there minus its largest slope over the box times
half the width, for each gain (mean value form: Ratschek and Rokne 1984, "Computer methods for the
range of functions"). Where slopes are too large to say much, the ranges of L over the box are
bounded instead, at first for neighbouring frequencies at once. Boxes with the least bound are
halved. Stability is not asked for: gains with which a loop is unstable do not cost less, either.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from itertools import count
from typing import Any

from nrs_design.proof.enclosure import ball_around, fraction_of, precision

# Bits of the balls.
_BITS = 64
# Of a box: the share of `enough` from which on all frequencies are looked at, and slopes as well.
_CLOSE, _CLOSER = Fraction(1, 4), Fraction(7, 10)
# Neighbouring frequencies: a tenth of their number so far, and at most eight.
_SHARE, _GROUP = 10, 8
ZERO = Fraction(0)

Ends = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class Frequency:
    """What the cost takes at one frequency; all numbers are exact."""

    omega: Fraction  # rad/s, positive
    drawn: Fraction  # Kt/omega, N m s/rad
    # F: N m s/rad
    real: Fraction
    imag: Fraction
    target: Fraction  # t^2, positive


@dataclass(frozen=True, slots=True)
class LeastCost:
    """A bound on a cost over a box of gains."""

    below: Fraction  # Nowhere in the box is the cost smaller; 0 if nothing else was shown
    boxes: int  # That were looked at


def least_cost(
    frequencies: Sequence[Frequency],
    weights: tuple[Fraction, Fraction],
    Mt: Ends,
    Bt: Ends,
    *,
    enough: Fraction,
    most: int,
) -> LeastCost:
    """Bound the least cost, a mean over frequencies, over a box of gains from below.

    Weights are wD and wR, not negative; Mt, not negative, in kg m^2 and Bt, positive, in N m s/rad.
    The search ends when the bound is `enough`, or after `most` boxes.
    """
    with precision(_BITS):
        cost = _Cost(frequencies, weights, enough)
        order, looked = count(), 1
        open_ = [cost.bound(_Box((Mt, Bt)), next(order))]
        while open_[0].below < enough and looked + 2 <= most:
            for half in heappop(open_).halves():
                looked += 1
                heappush(open_, cost.bound(half, next(order)))
        return LeastCost(min(open_[0].below, enough), looked)


def cost_at_most(
    frequencies: Sequence[Frequency],
    weights: tuple[Fraction, Fraction],
    Mt: Fraction,
    Bt: Fraction,
) -> Fraction:
    """Return a number that the cost of one pair of gains does not exceed.

    As for `least_cost`; with these gains, no ``y + F`` is zero.
    """
    with precision(_BITS):
        terms = [_Terms.of([f]) for f in frequencies]
        wD, wR = map(ball_around, weights)
        M, B = ball_around(Mt), ball_around(Bt)
        robust, displayed = ball_around(ZERO), ball_around(ZERO)
        for term in terms:
            _, L = term.sensitivity(M, B)
            robust += L
            displayed += abs((term.target / L**2).log())
        total = wR * robust + wD * displayed / (2 * ball_around(Fraction(10)).log())
        return fraction_of((total / len(terms)).upper())


@dataclass(frozen=True, slots=True, order=True)
class _Box:
    gains: tuple[Ends, Ends]  # Mt, Bt
    # below: what the cost is not below; steep: how much each gain changes it, if slopes are known.
    below: Fraction = ZERO
    steep: tuple[Fraction, Fraction] | None = None

    def halves(self) -> tuple[_Box, _Box]:
        """Halve the gain that changes the cost most, or that is widest for its size."""
        widths = [high - low for low, high in self.gains]
        if self.steep is None:
            damping = self.gains[1]
            sizes = [low + damping[0] / 10 for low, _ in self.gains]
            shares = [width / size for width, size in zip(widths, sizes, strict=True)]
        else:
            shares = list(self.steep)
        axis = shares.index(max(shares))
        low, high = self.gains[axis]
        # Large ranges of damping are halved by ratio.
        middle = 2 * low if axis == 1 and high > 4 * low else (low + high) / 2
        first, second = (
            (ends, self.gains[1]) if axis == 0 else (self.gains[0], ends)
            for ends in ((low, middle), (middle, high))
        )
        return _Box(first, self.below, self.steep), _Box(second, self.below, self.steep)


@dataclass(frozen=True, slots=True)
class _Terms:
    """One frequency, or neighbouring ones in balls around all of them."""

    count: int
    omega: Any
    rotated: Any  # j omega
    drawn: Any  # j Kt/omega
    opened: Any  # F
    target: Any

    @classmethod
    def of(cls, given: Sequence[Frequency]) -> _Terms:
        from flint import acb

        def around(numbers: Sequence[Fraction]) -> Any:
            return _between(min(numbers), max(numbers))

        omega, drawn = around([f.omega for f in given]), around([f.drawn for f in given])
        opened = acb(around([f.real for f in given]), around([f.imag for f in given]))
        target = around([f.target for f in given])
        return cls(len(given), omega, acb(0, omega), acb(0, drawn), opened, target)

    def sensitivity(self, Mt: Any, Bt: Any) -> tuple[Any, Any]:
        """Return y, and L as ``|1 - F/(y + F)|``, in which a range of y counts once."""
        y = Bt + Mt * self.rotated - self.drawn
        return y, abs(1 - self.opened / (y + self.opened))


class _Cost:
    """The cost over boxes."""

    def __init__(
        self, given: Sequence[Frequency], weights: tuple[Fraction, Fraction], enough: Fraction
    ) -> None:
        self._each = [_Terms.of([f]) for f in given]
        self._groups = []
        while given:
            done = len(self._each) - len(given)
            size = min(_GROUP, max(1, done // _SHARE))
            self._groups.append(_Terms.of(given[:size]))
            given = given[size:]
        self._displayed = ball_around(weights[0]) / ball_around(Fraction(10)).log()
        self._robust = ball_around(weights[1])
        self._enough = enough

    def bound(self, box: _Box, order: int) -> _Open:
        """Return a box with the best bound of those that are worth their time."""
        Mt, Bt = (_between(*ends) for ends in box.gains)
        below, steep = box.below, None
        # Where slopes said something about the box that was halved, they say more of its half.
        if box.steep is None:
            below = max(below, self._by_ranges(self._groups, Mt, Bt))
            if _CLOSE * self._enough <= below < self._enough:
                below = max(below, self._by_ranges(self._each, Mt, Bt))
        if below < self._enough and (box.steep or below >= _CLOSER * self._enough):
            found = self._by_slopes(Mt, Bt)
            if found is not None:
                value, *changes = found
                below, steep = max(below, value - sum(changes)), (changes[0], changes[1])
        return _Open(below, order, _Box(box.gains, below, steep))

    def _by_ranges(self, terms: Sequence[_Terms], Mt: Any, Bt: Any) -> Fraction:
        """Bound the cost by the range of L at each frequency."""
        robust, product = ball_around(ZERO), ball_around(Fraction(1))
        for term in terms:
            y = Bt + Mt * term.rotated - term.drawn
            away = abs(y + term.opened)
            if away > 0:
                L = abs(1 - term.opened / (y + term.opened))
                low, high = L.lower(), L.upper()
            else:
                low, high = (abs(y).lower() / away.upper()).lower(), None
            if low > 0:
                robust += term.count * low
            # The larger of t/L and L/t is at least this, squared; 1 where L may be t.
            if low > 0 and low * low > term.target:
                product *= (low * low / term.target).lower() ** term.count
            elif high is not None and high * high < term.target:
                product *= (term.target / (high * high)).lower() ** term.count
        total = self._displayed * product.log() / 2 + self._robust * robust
        return max(ZERO, _lower(total / len(self._each)))

    def _by_slopes(self, Mt: Any, Bt: Any) -> tuple[Fraction, Fraction, Fraction] | None:
        """Return the value in the middle, and by how much each gain may lower it; or None."""
        M, B = Mt.mid(), Bt.mid()
        robust, product = ball_around(ZERO), ball_around(Fraction(1))
        by_M, by_B = ball_around(ZERO), ball_around(ZERO)
        for term in self._each:
            _, L = term.sensitivity(M, B)
            robust += L
            square, sign = L * L, 1
            if square < term.target:
                product *= term.target / square
            else:
                product *= square / term.target
                sign = -1
            y, L = term.sensitivity(Mt, Bt)
            # Of log L: d/dBt is the real part of this, d/dX minus the imaginary one.
            slope = 1 / y - 1 / (y + term.opened)
            weight = self._robust * L - sign * self._displayed
            by_B += weight * slope.real
            by_M -= weight * term.omega * slope.imag
        count = len(self._each)
        total = (self._displayed * product.log() / 2 + self._robust * robust) / count
        changes = [abs(s) * g.rad() / count for s, g in ((by_M, Mt), (by_B, Bt))]
        if not all(ball.is_finite() for ball in (total, *changes)):
            return None
        change_M, change_B = (fraction_of(ball.upper()) for ball in changes)
        return _lower(total), change_M, change_B


@dataclass(frozen=True, slots=True, order=True)
class _Open:
    below: Fraction
    order: int
    box: _Box

    def halves(self) -> tuple[_Box, _Box]:
        return self.box.halves()


def _between(low: Fraction, high: Fraction) -> Any:
    """Return a ball that contains two numbers and all between."""
    return ball_around(low).union(ball_around(high))


def _lower(ball: Any) -> Fraction:
    return fraction_of(ball.lower()) if ball.is_finite() else ZERO
