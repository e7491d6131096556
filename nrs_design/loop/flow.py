"""Flow of a drive over a period under held commands: an enclosure by few points.

All entries are enclosed together, by the number of ranges (docs/certificates/drives.md):

- none: entries are known but for their last digits, and a few give the others exactly;
- one: they run through a curve, around which there is a simplex;
- several: interpolation between the ends of all ranges, with an error of at most the sum of
  ``(length of a range)^2/8`` times the second derivatives. Numbers of a contact may change within a
  period: their mean takes the place of a constant.

The gain of a motor multiplies commands, exactly.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING

from nrs_design.loop.calendar import CommandTiming
from nrs_design.loop.entries import Entries, exact_rows, highest, lowest, too_long
from nrs_design.loop.hull import (
    EntryCurve,
    Key,
    Point,
    Tie,
    enclose_box,
    fraction,
    nodes,
    rational,
    round_balls,
    simplex,
    ties,
)
from nrs_design.loop.located import labelled_ends
from nrs_design.loop.sampled import DELTA, Rows
from nrs_design.models.drive import GAIN, LOAD, MEMORY, CommandInterface, Drive
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import ONE, ZERO
from nrs_design.proof.enclosure import ball_around, precision

if TYPE_CHECKING:
    from flint import arb, arb_mat, fmpq, fmpq_mat

BITS = 240
# Labels of the load within a period; `LOAD` labels the load at the force sample.
HELD_LOAD = ("k held", "b held")
NOTHING = Interval.point(ZERO)


@dataclass(frozen=True, slots=True)
class FlowPoint:
    """One point of a hull that holds every motion of a drive in a period."""

    labels: tuple[str, ...]  # Ends of its ranges, and its number in a simplex
    curve: tuple[str, int] | None  # The only range, and the point on its curve
    rows: Rows


@dataclass(frozen=True, slots=True)
class HeldDrive:
    """A drive, and when its commands take effect."""

    __eq__, __hash__ = object.__eq__, object.__hash__

    drive: Drive
    timing: CommandTiming

    def points(self) -> Iterator[tuple[tuple[str, ...], HeldDrive]]:
        """Yield the drives at the ends of the ranges, with the labels of each."""
        for labels, values in labelled_ends(self.drive.ranges):
            drive = self.drive.fix_values(values)
            for times, timing in self.timing.points():
                yield (*labels, *times), HeldDrive(drive, timing)

    def flow(
        self, contact: Mapping[str, Interval] | None = None, load: tuple[str, str] = LOAD
    ) -> tuple[FlowPoint, ...]:
        """Return the points that enclose the motion of the drive in a period.

        `contact` holds stiffness and damping by the symbols of `LOAD`, by default zero. They act on
        a loaded drive, and labels name them as `load`. A point alone need not be a drive of the
        ranges. An `AssemblyError` if a period is too long to enclose an entry.
        """
        with precision(BITS):
            try:
                return tuple(_Flow(self.drive, self.timing, contact or {}, load).points())
            except OverflowError:
                raise too_long() from None


@dataclass(frozen=True, slots=True)
class _Number:
    """A parameter with a range: of the drive, of the contact, or a time."""

    symbol: str  # Empty for a time
    name: str  # Its name in labels
    # Ends in the coordinate in which rates are affine: the number or its inverse.
    low: arb
    high: arb
    span: int | None = None  # Index of a time among those left of the period


class _Flow:
    """A drive over a period, as it is enclosed."""

    def __init__(
        self,
        drive: Drive,
        timing: CommandTiming,
        contact: Mapping[str, Interval],
        load: tuple[str, str],
    ) -> None:
        self.drive, self.entries = drive, Entries(drive)
        self.spans = [timing.steps, *(timing.time_left(age) for age in timing.new_ages)]
        ranges = {s: contact.get(s, NOTHING) for s in LOAD} if drive.loaded else {}
        ranges |= {s: i for s, i in drive.ranges.items() if s != GAIN}
        names = dict(zip(LOAD, load, strict=True))
        self.ends = {GAIN: (ONE, ONE)}
        self.ends |= {
            s: (1 / i.low, 1 / i.high) if s in drive.inverse else (i.low, i.high)
            for s, i in ranges.items()
        }
        self.low = {s: ball_around(low) for s, (low, _) in self.ends.items()}
        self.whole = {s: _ball_over(*ends) for s, ends in self.ends.items()}
        self.numbers = [
            _Number(s, names.get(s, s), ball_around(low), ball_around(high))
            for s, (low, high) in self.ends.items()
            if low != high
        ]
        tissue = (*LOAD, *MEMORY)
        self.changing = [n for n in self.numbers if n.symbol in tissue and ranges[n.symbol].varies]
        times = ["T", *(f"h{age}" for age in timing.new_ages)]
        for s, (time, i) in enumerate(zip(times, self.spans, strict=True)):
            if i.low != i.high:
                self.numbers.append(_Number("", time, ball_around(i.low), ball_around(i.high), s))
        # A command may take effect in this period or later, so the velocity may or may not jump.
        self.jumps = {
            s: str(age)
            for s, age in enumerate(timing.new_ages, 1)
            if drive.speed is not None and self.spans[s].low == 0
        }
        self.entries.check_length(self.whole, self.spans[0].high)
        self.lasting = self._lasting()
        self.keys = self._keys()
        self.ties = self._ties()

    # Entries, and ties between them.

    def _lasting(self) -> tuple[list[Fraction], Fraction] | None:
        """Return the states v that a lasting command of one leads to, and the speed w of the joint.

        They are the same for all numbers if their residual, which is affine in each number, is zero
        at all ends. So ``exp([[A, B], [0, 0]] T)`` maps ``(v, 1)`` to ``(v + T w, 1)``, which gives
        the column of the command. None without such states, or where the period has a range.
        """
        from flint import fmpq_mat

        n, period = self.drive.order, self.spans[0]
        if self.drive.interface is CommandInterface.POSITION or period.low != period.high:
            return None
        found: tuple[list[Fraction], Fraction] | None = None
        for values in product(*({*ends} for ends in self.ends.values())):
            G = exact_rows(self.drive.rates, dict(zip(self.ends, values, strict=True)))
            if found is None:
                A = fmpq_mat([[rational(c) for c in row[: n - 1]] for row in G[:-1]])
                try:
                    solution = A.solve(fmpq_mat([[-rational(row[n])] for row in G[:-1]]))
                except ZeroDivisionError:
                    return None
                v = [fraction(c) for c in solution.entries()]
                found = [*v, ZERO, ONE], _dot(G[-1], [*v, ZERO, ONE])
            v, speed = found
            if [_dot(row, v) for row in G] != [*[ZERO] * (n - 1), speed]:
                return None
            if speed and any(row[n - 1] for row in G):
                return None
        return found

    def _keys(self) -> list[Key]:
        """Return the keys of nonzero entries; a later command has only its own column."""
        # The position of a robot that takes positions acts as minus its command, but on a memory.
        n, acts = self.drive.order, self.entries.acting(self.whole)
        memories = {n - 2} if self.drive.memory else set()
        first = [*range(n + 1)] if self.lasting is None else [*range(n)]
        is_position = self.drive.interface is CommandInterface.POSITION
        return [
            (s, i, j)
            for s in range(len(self.spans))
            for i, j in product(range(len(acts)), [n] if s else first)
            if acts[i][j] and not (is_position and j == n - 1 and i not in memories)
        ]

    def _ties(self) -> dict[Key, Tie]:
        """Return the entries of a known drive, over known times, that follow from others."""
        from flint import fmpq, fmpq_mat

        if any(number.symbol for number in self.numbers):
            return {}
        values, n = {s: low for s, (low, _) in self.ends.items()}, self.drive.order
        rows = [*exact_rows(self.drive.rates, values), [ZERO] * (n + 1)]
        G = fmpq_mat([[rational(c) for c in row] for row in rows])
        (L,) = [[]] if self.drive.speed is None else exact_rows(self.drive.speed, values)

        def entry(M: fmpq_mat, key: Key) -> fmpq:
            _, i, j = key
            if i < n:
                return M[i, j]
            return sum((rational(c) * M[k, j] for k, c in enumerate(L)), fmpq(0))

        found: dict[Key, Tie] = {}
        for s, span in enumerate(self.spans):
            keys = [key for key in self.keys if key[0] == s]
            if keys and span.low == span.high:
                M = self.entries.evaluate(self.low, ball_around(span.low))
                sizes = {(s, i, j): highest(abs(M[i, j])) for _, i, j in keys}
                found |= ties(G, span.low, entry, sizes)
        return found

    # Points.

    def points(self) -> Iterator[FlowPoint]:
        """Yield the points, each at the ends of the gain; velocities have jumped, or have not."""
        gain = {GAIN: self.drive.ranges.get(GAIN, Interval.point(ONE))}
        for labels, curve, point in self._hull():
            for jumped, entries in self._jumped(labels, self._completed(point)):
                for ends, values in labelled_ends(gain):
                    yield FlowPoint(
                        (*labels, *ends, *jumped), curve, self._rows(entries, values[GAIN])
                    )

    def _hull(self) -> Iterator[tuple[tuple[str, ...], tuple[str, int] | None, Point]]:
        """Yield points of entries: around the curve of the only range, or at the ends of ranges."""
        # Changes within a period are on no curve. With a load, a constant needs as many corners in
        # the air as in contact.
        limit, found = 0 if self.drive.loaded or self.changing else 1, None
        if len(self.numbers) <= limit:
            with suppress(OverflowError):
                found = simplex(self._curves)
        for k, point in enumerate(found or ()):
            curve = (self.numbers[0].name, k) if self.numbers else None
            yield (f"flow-{k}",), curve, point
        if found is None:
            yield from self._interpolated()

    def _curves(self, order: int) -> dict[Key, EntryCurve]:
        """Return the entries that no others give, as functions of the number with a range."""
        number = self.numbers[0] if self.numbers else None
        found: dict[Key, EntryCurve] = {}
        for s, span in enumerate(self.spans):
            if number is None or number.span not in (None, s):
                values, far = [self._evaluate({}, s)] * (order + 1), None
            else:
                width = number.high - number.low
                places = [number.low + share * width for share in nodes(order)]
                values = [self._evaluate({number.name: x}, s) for x in places]
                anywhere = _ball_over(span.low, span.high)
                far = self.entries.jet(self.whole, anywhere, number.symbol, width, order + 1)[-1]
            for key in self._free_keys(s):
                _, i, j = key
                found[key] = EntryCurve([M[i, j] for M in values], 0 if far is None else far[i, j])
        return found

    def _interpolated(self) -> Iterator[tuple[tuple[str, ...], None, Point]]:
        """Yield the interpolation at the ends of ranges, widened by its error."""
        errors: dict[Key, Fraction] = {}
        names = [n.name for n in self.numbers]
        corners = [
            dict(zip(names, ends, strict=True)) for ends in product((0, 1), repeat=len(names))
        ]
        points: list[Point] = [{} for _ in corners]
        for s in range(len(self.spans)):
            for key, values, off in self._interpolate_time(s, corners):
                errors[key] = off
                for point, value in zip(points, values, strict=True):
                    point[key] = value
        for corner, middle in zip(corners, points, strict=True):
            labels = tuple(f"{name}-{('min', 'max')[end]}" for name, end in corner.items())
            for k, point in enumerate(enclose_box(middle, errors)):
                yield (*labels, f"flow-{k}"), None, point

    def _interpolate_time(
        self, s: int, corners: Sequence[Mapping[str, int]]
    ) -> Iterator[tuple[Key, list[Fraction], Fraction]]:
        """Yield the entries over one time at the ends of all numbers, and their largest error.

        A convex entry is not above its interpolation, a concave one not below.
        """
        mine = [n for n in self.numbers if n.span in (None, s)]
        span, change = self.spans[s], None
        anywhere = _ball_over(span.low, span.high)
        bends = [
            self.entries.jet(self.whole, anywhere, n.symbol, n.high - n.low, 2)[2] for n in mine
        ]
        if self.changing:
            widths = {n.symbol: n.high - n.low for n in self.changing}
            change = self.entries.bound_change(self.whole, ball_around(span.high), widths)
        places = [tuple(corner[n.name] for n in mine) for corner in corners]
        matrices = {
            ends: self._evaluate(
                {n.name: (n.low, n.high)[e] for n, e in zip(mine, ends, strict=True)}, s
            )
            for ends in dict.fromkeys(places)
        }
        for key in self._free_keys(s):
            _, i, j = key
            sag = sum((max(highest(B[i, j]), ZERO) for B in bends), ZERO) / 4
            rise = sum((max(-lowest(B[i, j]), ZERO) for B in bends), ZERO) / 4
            off = (sag + rise) / 2 + (ZERO if change is None else highest(change[i, j]))
            shift = ball_around((rise - sag) / 2)
            found, error = round_balls((M[i, j] + shift for M in matrices.values()), off)
            values = dict(zip(matrices, found, strict=True))
            yield key, [values[ends] for ends in places], error

    def _free_keys(self, s: int) -> Iterator[Key]:
        """Yield the entries over one time that no others give."""
        return (key for key in self.keys if key[0] == s and key not in self.ties)

    def _evaluate(self, values: Mapping[str, arb], s: int) -> arb_mat:
        """Return the entries over one time where numbers are, by their names."""
        point = {n.symbol: values[n.name] for n in self.numbers if n.symbol and n.name in values}
        h = next((values[n.name] for n in self.numbers if n.span == s and n.name in values), None)
        return self.entries.evaluate(
            self.low | point, ball_around(self.spans[s].low) if h is None else h
        )

    def _completed(self, point: Point) -> Point:
        """Return a point with the entries that others give."""
        whole = point | {key: tie.evaluate(point) for key, tie in self.ties.items()}
        if self.lasting is not None:
            n, T, (v, speed) = self.drive.order, self.spans[0].low, self.lasting
            for i in range(n):
                known = sum((whole.get((0, i, j), ZERO) * v[j] for j in range(n - 1)), ZERO)
                whole[0, i, n] = v[i] + (T * speed if i == n - 1 else ZERO) - known
        return whole

    def _jumped(self, labels: Sequence[str], point: Point) -> Iterator[tuple[list[str], Point]]:
        """Yield a point with and without the jumps of velocity by late commands.

        A command that has not come has nothing left of the period: that is at the low end alone.
        """
        n = self.drive.order
        ages = {s: age for s, age in self.jumps.items() if f"h{age}-max" not in labels}
        for has in product((0, 1), repeat=len(ages)):
            arrivals = dict(zip(ages, has, strict=True))
            texts = [f"in{ages[s]}-{('min', 'max')[come]}" for s, come in arrivals.items()]
            still = {(s, n, n) for s, come in arrivals.items() if not come}
            yield texts, {k: ZERO if k in still else x for k, x in point.items()}

    def _rows(self, entries: Point, gain: Fraction) -> Rows:
        """Return the rows of `Rows`; a position is commanded from the deflection on."""
        n, jumps = self.drive.order, self.drive.speed is not None

        def row(i: int) -> tuple[Fraction, ...]:
            commands = [gain * entries.get((s, i, n), ZERO) for s in range(len(self.spans))]
            states = [entries.get((0, i, j), ZERO) for j in range(n)]
            if self.drive.interface is CommandInterface.POSITION and (0, i, n - 1) not in entries:
                states[-1] = -commands[0]
            return (*[ZERO] * jumps, *states, *commands)

        # A velocity that jumps is the first state, and the last row.
        places = {name: k - jumps for k, name in enumerate(self.drive.states)} | {DELTA: n - 1}
        return {name: row(i % (n + 1)) for name, i in places.items()}


def _ball_over(low: Fraction, high: Fraction) -> arb:
    whole: arb = ball_around(low).union(ball_around(high))
    return whole


def _dot(row: Sequence[Fraction], v: Sequence[Fraction]) -> Fraction:
    return sum((c * x for c, x in zip(row, v, strict=True)), ZERO)
