"""What a robot with a drive of its own does over a period under commands that are held.

With ``z' = A z + B u``, each entry of ``exp([[A, B], [0, 0]] h)`` is a smooth function of the
numbers in A and B and of the time h. Between the corners of their ranges it is what interpolates,
one number after the other, but for the sum of ``(length of a range)^2/8`` times the largest second
derivative by that number. That, and what is rounded, is enclosed: all entries together are in the
simplex around the box of what they may be off (docs/certificates/drives.md).

What is touched may change its stiffness and damping within a period, too, but for what is constant.
Its mean over the period is in the range, and takes the place of a constant one; by how much that is
off is enclosed as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import reduce
from itertools import product
from math import prod
from typing import Any

from nrs_design.errors import AssemblyError
from nrs_design.loop.command_timing import CommandTiming
from nrs_design.loop.held_motor import WAY, Commands, HeldMotor
from nrs_design.loop.parameter_box import Box, around
from nrs_design.models.drive import LOAD, ONE, ZERO, Drive, MultiAffine, Takes
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.proof.enclosure import precision

BITS = 240
# Of the last digit of an entry, over its size: where it is known, its ends are one number in
# doubles; where it has a range, of how far it is off at most.
KNOWN_BITS, RANGED_BITS = 64, 3
# Of a period, in time constants of the drive: far beyond, nothing is left of where it began.
LONGEST = 2000
# The numbers are read where the period begins and hold until it ends.
AGAIN = ("k held", "b held")


@dataclass(frozen=True, slots=True, eq=False)
class PeriodEntry:
    """One entry: what it is at the corners of the numbers that it depends on, and how far off."""

    symbol: str
    depends: tuple[str, ...]  # Symbols of numbers
    corners: Mapping[tuple[int, ...], Fraction]  # By low (0) and high (1) ends
    off: Fraction  # In no place of the box it is further from what interpolates

    def at(self, shares: Mapping[str, Fraction], values: Mapping[str, Fraction]) -> Fraction:
        """Return the entry where numbers are so far on the way from their low to their high end."""
        total = values.get(self.symbol, ZERO)
        for ends, value in self.corners.items():
            ways = zip(self.depends, ends, strict=True)
            factors = [shares[s] if end else 1 - shares[s] for s, end in ways]
            # Where corners are checked, most factors are zero.
            if all(factors):
                total += value * prod(factors, start=ONE)
        return total


@dataclass(frozen=True, slots=True, eq=False)
class HeldDrive(HeldMotor):
    """A drive over a period, and where its numbers lie."""

    moved: Drive
    timing: CommandTiming
    numbers: Mapping[str, Interval]  # All that entries depend on, those of the load too
    # By the time that is left, the row and the column: of the whole period those of the states, of
    # every time those of a command. What is not there is zero.
    entries: Mapping[tuple[int, int, int], PeriodEntry] = field(repr=False)
    load: tuple[str, str] = LOAD

    @classmethod
    def of(
        cls,
        drive: Drive,
        timing: CommandTiming,
        touched: Mapping[str, Interval] | None = None,
        load: tuple[str, str] = LOAD,
    ) -> HeldDrive:
        """Return the drive while something is touched, or nothing.

        `touched` are stiffness and damping by the symbols of `LOAD`; `load` is how a box names
        them. An `AssemblyError` if a period is so long for the ranges that an entry is not
        enclosed.
        """
        nothing = Interval.point(ZERO)
        own = dict(drive.ranges)
        if drive.loaded:
            own |= {s: nothing if touched is None else touched.get(s, nothing) for s in LOAD}
        times = {"T": timing.steps}
        times |= {f"h{age}": timing.left(age) for age in timing.within}
        reached = _reached(times) if drive.speed is not None else {}
        with precision(BITS):
            entries = dict(_entries(drive, own, times, reached))
        offs = {e.symbol: Interval(ZERO, -e.off, e.off) for e in entries.values() if e.off}
        renamed = dict(zip(LOAD, load, strict=True))
        numbers = own | times | dict.fromkeys(reached.values(), Interval(ONE, ZERO, ONE))
        ranges = {
            renamed.get(s, s): interval
            for s, interval in numbers.items()
            if interval.low < interval.high and (s not in LOAD or load != LOAD)
        }
        inverse = drive.inverse & ranges.keys()
        box = Box(ranges, inverse, hull=around(offs))
        return cls(box, drive, timing, numbers, entries, load)

    @property
    def drive(self) -> Drive:
        """What moves the joint."""
        return self.moved

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units of the states, the deflection left out."""
        return self.moved.states

    @property
    def attained(self) -> frozenset[str]:
        """None: what is between corners is not what interpolates."""
        return frozenset()

    def points(self) -> Iterator[tuple[tuple[str, ...], HeldDrive]]:
        """Yield drives that there are, at the ends of the ranges, with the labels of each."""
        ranges = self.moved.ranges
        for ends in product(*(interval.ends for interval in ranges.values())):
            named = [(s, *end) for s, end in zip(ranges, ends, strict=True)]
            labels = tuple(f"{symbol}-{end}" for symbol, end, _ in named if end)
            drive = self.moved.at({symbol: value for symbol, _, value in named})
            for times, timing in self.timing.points():
                yield (*labels, *times), HeldDrive.of(drive, timing, load=self.load)

    def touching(self, touched: Mapping[str, Interval], *, forced: bool) -> HeldMotor:
        """Return the drive while something is touched that acts on it.

        `forced`: the law takes the force of the sample; what acts over the period has symbols of
        its own then.
        """
        if not self.drive.loaded:
            return self
        return HeldDrive.of(self.drive, self.timing, touched, AGAIN if forced else LOAD)

    def result(self, name: str, given: Commands, values: Mapping[str, Fraction]) -> LinearForm:
        """Return a state after the period, or how far the joint goes in it."""
        row, drive = self._row(name), self.drive
        shares = dict(self._shares(values))
        states = given.states if drive.speed is None else given.states[1:]
        first = given.first
        if drive.takes is Takes.POSITION:
            first = combine((ONE, first), (-ONE, given.place))
        columns = {(0, j): form for j, form in enumerate((*states, given.place, first))}
        command = drive.order
        columns |= {(i, command): form for i, form in enumerate(given.changes, 1)}
        terms = [
            (entry.at(shares, values), columns[span, column])
            for (span, i, column), entry in self.entries.items()
            if i == row
        ]
        return combine((ZERO, given.first), *terms)

    def _row(self, result: str) -> int:
        """Return the row of a result among the entries: that of a velocity that jumps is last."""
        if result == WAY:
            return self.drive.order - 1
        if self.drive.speed is None:
            return self.states.index(result)
        return (self.states.index(result) - 1) % (self.drive.order + 1)

    def _shares(self, values: Mapping[str, Fraction]) -> Iterator[tuple[str, Fraction]]:
        named = dict(zip(LOAD, self.load, strict=True))
        for symbol, interval in self.numbers.items():
            if interval.low == interval.high:
                continue
            low, high = interval.low, interval.high
            value = values.get(named.get(symbol, symbol), interval.nominal)
            if symbol in self.drive.inverse:
                low, high, value = 1 / low, 1 / high, 1 / value
            yield symbol, (value - low) / (high - low)


def _reached(times: Mapping[str, Interval]) -> dict[str, str]:
    """Return symbols of whether a command takes effect in the period, where it may come later.

    By the times that are then left. A velocity that jumps has jumped, or not, where none is left.
    """
    return {time: f"in{time[1:]}" for time, left in times.items() if left.low == 0}


def _entries(
    drive: Drive,
    numbers: Mapping[str, Interval],
    times: Mapping[str, Interval],
    reached: Mapping[str, str],
) -> Iterator[tuple[tuple[int, int, int], PeriodEntry]]:
    """Yield what is not zero."""
    n, count = drive.order, 0
    ranged = [s for s, interval in numbers.items() if interval.low < interval.high]
    _check_length(drive, numbers, times["T"])
    moved = _moved(drive, numbers, times)
    for span, (time, length) in enumerate(times.items()):
        moving = [*ranged, *([time] if length.low < length.high else [])]
        known = {**numbers, time: length}
        ends = {s: _ends(known[s], inverse=s in drive.inverse) for s in known}
        at = {
            corner: _grown(drive, {s: e[c] for (s, e), c in _chosen(ends, moving, corner)}, time)
            for corner in product((0, 1), repeat=len(moving))
        }
        anywhere = {s: _hull(*e) for s, e in ends.items()}
        bends = {s: _bend(drive, anywhere, time, s) for s in moving}
        for row, column in product(range(n + (drive.speed is not None)), _columns(drive, numbers)):
            if span and column != n:
                continue
            off = sum((_square(ends[s]) * abs(bends[s][row, column]) for s in moving), _ball(ZERO))
            off += moved[time][row, column]
            values = {corner: M[row, column] for corner, M in at.items()}
            if row == column == n - 1:
                # How far the joint goes, not where it is then.
                values = {corner: value - 1 for corner, value in values.items()}
            if all(value == 0 for value in values.values()) and off == 0:
                continue
            found = _rounded(values, off)
            if found is None:
                raise _too_long()
            depends, (corners, error) = moving, found
            if row == n and time in reached:
                # Of a jump that is still to come, nothing is there.
                depends = [*moving, reached[time]]
                corners = {(*c, end): v * end for c, v in corners.items() for end in (0, 1)}
            yield (span, row, column), PeriodEntry(f"off{count}", tuple(depends), corners, error)
            count += 1


def _moved(
    drive: Drive, numbers: Mapping[str, Interval], times: Mapping[str, Interval]
) -> dict[str, Any]:
    """Return by how much entries are off at most where the load changes within a period.

    Let A be the generator at the moment, with entries of at most M by size, and k a number of the
    load, which acts by N: ``A(s) = A + (k(s) - k) N`` with k the mean over the period. What the
    state becomes is off by the integral of ``(k(s) - k) g(s)`` with ``g = exp(A (T - s)) N E(s)``,
    E what the changing A makes of the state until s. The first factor has the mean zero and a range
    of some width, so that is at most ``T^2/8`` times the width and the largest derivative of g
    (Ostrowski 1970), which is at most ``exp(M T) (|N| M + M |N|) exp(M T)``. What commands add is
    off by at most the integral of ``exp(M (h - s)) |N| exp(M s)``, which is the corner block of
    the exponential of ``[[M, |N|], [0, M]] h``.
    """
    from flint import arb_mat

    n = drive.order
    m = n + 1
    nothing = arb_mat(m, m)
    if not drive.loaded:
        return dict.fromkeys(times, nothing)
    ends = {s: _ends(i, inverse=s in drive.inverse) for s, i in numbers.items()}
    anywhere = {s: _hull(*e) for s, e in ends.items()}
    M = _sizes(_generator(drive.rates, anywhere, n))
    ranged = [s for s in LOAD if numbers[s].varies and numbers[s].low < numbers[s].high]
    widths = [_ball(numbers[s].high - numbers[s].low) for s in ranged]
    slopes = [_sizes(_generator(drive.rates.slope(s), anywhere, n)) for s in ranged]
    found = {}
    for time, length in times.items():
        h = _ball(length.high)
        grown, total = (M * h).exp(), nothing
        for width, N in zip(widths, slopes, strict=True):
            states = grown * (N * M + M * N) * grown * (width * h * h / 8)
            blocks = [[M, N], [nothing, M]]
            whole = arb_mat(
                [[blocks[i // m][j // m][i % m, j % m] for j in range(2 * m)] for i in range(2 * m)]
            )
            doubled = (whole * h).exp()
            total += arb_mat(
                [
                    [width * doubled[i, m + j] if j == n else states[i, j] for j in range(m)]
                    for i in range(m)
                ]
            )
        found[time] = total
    return found


def _sizes(M: Any) -> Any:
    """Return the largest sizes of the entries of a matrix of balls."""
    from flint import arb_mat

    return arb_mat([[M[i, j].abs_upper() for j in range(M.ncols())] for i in range(M.nrows())])


def _check_length(drive: Drive, numbers: Mapping[str, Interval], period: Interval) -> None:
    """Refuse a period of so many time constants that its exponential is out of reach."""
    ends = {s: _ends(i, inverse=s in drive.inverse) for s, i in numbers.items()}
    n, anywhere = drive.order, {s: _hull(*e) for s, e in ends.items()}
    G = _generator(drive.rates, anywhere, n)
    rates = (abs(_upper(abs(G[i, j]))) for i in range(n) for j in range(n))
    if sum(rates, ZERO) * period.high > LONGEST:
        raise _too_long()


def _too_long() -> AssemblyError:
    return AssemblyError(
        "a period is too long for the drive and what it touches: it is too many of their time "
        "constants, or their ranges are too wide to enclose what they do in it",
        remedy="sample with a shorter period, or narrow the ranges",
        at=("sampling", "period"),
    )


def _columns(drive: Drive, numbers: Mapping[str, Interval]) -> list[int]:
    """Return which states and commands count: the deflection if it acts on the joint.

    A position that is commanded counts from the deflection where the period begins.
    """
    n = drive.order
    untouched = (
        all(numbers[s].low == numbers[s].high == 0 for s in LOAD[:1]) if drive.loaded else True
    )
    return [j for j in range(n + 1) if j != n - 1 or not untouched]


def _chosen(
    ends: Mapping[str, tuple[Any, Any]], moving: Sequence[str], corner: tuple[int, ...]
) -> Iterator[tuple[tuple[str, tuple[Any, Any]], int]]:
    at = dict(zip(moving, corner, strict=True))
    return ((item, at.get(item[0], 0)) for item in ends.items())


def _ball(number: Fraction) -> Any:
    from flint import arb, fmpq

    return arb(fmpq(number.numerator, number.denominator))


def _ends(interval: Interval, *, inverse: bool) -> tuple[Any, Any]:
    low, high = interval.low, interval.high
    if inverse:
        low, high = 1 / low, 1 / high
    return _ball(low), _ball(high)


def _hull(low: Any, high: Any) -> Any:
    return low if low is high else low.union(high)


def _square(ends: tuple[Any, Any]) -> Any:
    """Return an eighth of the square of the length of a range."""
    length = ends[1] - ends[0]
    return length * length / 8


def _matrix(M: MultiAffine, values: Mapping[str, Any], shape: tuple[int, int]) -> Any:
    """Return a matrix of balls, at balls of the numbers."""
    from flint import arb, arb_mat

    total = arb_mat(*shape)
    for symbols, rows in M.terms.items():
        factor = reduce(lambda product, s: product * values[s], symbols, arb(1))
        total += arb_mat([[factor * _ball(c) for c in row] for row in rows])
    return total


def _generator(rates: MultiAffine, values: Mapping[str, Any], n: int) -> Any:
    """Return ``[[A, B], [0, 0]]``."""
    from flint import arb_mat

    M = _matrix(rates, values, (n, n + 1))
    return arb_mat([[*(M[i, j] for j in range(n + 1))] for i in range(n)] + [[0] * (n + 1)])


def _grown(drive: Drive, values: Mapping[str, Any], time: str) -> Any:
    """Return the entries at balls of the numbers, below them those of a velocity that jumps."""
    n = drive.order
    E = (_generator(drive.rates, values, n) * values[time]).exp()
    return _with_speed(
        E, E if drive.speed is None else _matrix(drive.speed, values, (1, n + 1)) * E, n, drive
    )


def _with_speed(E: Any, speed: Any, n: int, drive: Drive) -> Any:
    from flint import arb_mat

    if drive.speed is None:
        return E
    rows = [[E[i, j] for j in range(n + 1)] for i in range(n)]
    return arb_mat([*rows, [speed[0, j] for j in range(n + 1)]])


def _bend(drive: Drive, values: Mapping[str, Any], time: str, symbol: str) -> Any:
    """Return balls of the second derivatives of all entries by one number, anywhere in the box.

    Of ``exp(G h)`` with ``G = G0 + x G1`` it is twice the corner block of the exponential of
    ``[[G, G1, 0], [0, G, G1], [0, 0, G]] h``, and the first derivative is the block beside the
    diagonal; by the time, it is ``G^2 exp(G h)``.
    """
    from flint import arb_mat

    n = drive.order
    m = n + 1
    G, h = _generator(drive.rates, values, n), values[time]
    L = None if drive.speed is None else _matrix(drive.speed, values, (1, m))
    if symbol == time:
        bent = G * G * (G * h).exp()
        return _with_speed(bent, bent if L is None else L * bent, n, drive)
    D = _generator(drive.rates.slope(symbol), values, n)
    nothing = arb_mat(m, m)
    blocks = [[G, D, nothing], [nothing, G, D], [nothing, nothing, G]]
    whole = arb_mat(
        [[blocks[i // m][j // m][i % m, j % m] * h for j in range(3 * m)] for i in range(3 * m)]
    ).exp()
    first, second = (
        arb_mat([[factor * whole[i, j + at] for j in range(m)] for i in range(m)])
        for factor, at in ((1, m), (2, 2 * m))
    )
    if L is None:
        return second
    # Of a product of two that both depend on the number.
    assert drive.speed is not None
    dL = _matrix(drive.speed.slope(symbol), values, (1, m))
    return _with_speed(second, L * second + 2 * dL * first, n, drive)


def _rounded(
    values: Mapping[tuple[int, ...], Any], off: Any
) -> tuple[dict[tuple[int, ...], Fraction], Fraction] | None:
    """Return rational numbers near balls, and how far off they and an error are at most."""
    largest = max((abs(_upper(value)) for value in values.values()), default=ZERO)
    if not largest.numerator and off == 0:
        return dict.fromkeys(values, ZERO), ZERO
    try:
        error = _upper(off)
    except OverflowError:
        return None
    unit = _power(largest or error, KNOWN_BITS)
    if error > unit:
        unit = _power(error, RANGED_BITS)
    found = {corner: round(_middle(value) / unit) * unit for corner, value in values.items()}
    radius = max(_upper(abs(v - _ball(found[c]))) for c, v in values.items())
    total = -(-(error + radius) // (unit / 4)) * (unit / 4)
    return found, total


def _power(size: Fraction, bits: int) -> Fraction:
    """Return a power of two that is so many bits below a number."""
    return Fraction(2) ** (size.numerator.bit_length() - size.denominator.bit_length() - bits)


def _upper(ball: Any) -> Fraction:
    """Return a number that is not below any of a ball."""
    if not ball.is_finite():
        raise OverflowError
    return _exact(ball.upper())


def _middle(ball: Any) -> Fraction:
    if not ball.is_finite():
        raise OverflowError
    return _exact(ball.mid())


def _exact(point: Any) -> Fraction:
    mantissa, exponent = point.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
