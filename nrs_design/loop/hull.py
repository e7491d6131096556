"""Few points in whose hull some numbers are together (docs/certificates/drives.md)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb, factorial
from typing import TYPE_CHECKING, Any

from nrs_design.loop.entries import highest, middle
from nrs_design.models.linear_form import ONE, ZERO
from nrs_design.proof.enclosure import ball_around

if TYPE_CHECKING:
    from flint import arb, fmpq, fmpq_mat

# Bits of a known number (both ends round to one double), and of a range relative to its error.
KNOWN_BITS, RANGED_BITS = 64, 3
# Bits of points on a curve, relative to its size: the fewest that suffice, to make proofs fast.
CURVE_BITS = range(20, 400, 12)
# Largest relative widening of a simplex around a curve: with few digits, and at all.
NARROW, WIDEST = Fraction(1, 2**12), Fraction(1, 4)
# Largest weight of the far points of known numbers.
SHARE = Fraction(1, 2**20)
# Largest amplification of relative errors by a tie.
LOOSE = 2**7
# Largest number of curves: with more, the curves together are nearly flat.
MOST_BENT = 16

# A number by how long is left (an index), row and column.
Key = tuple[int, int, int]
Point = dict[Key, Fraction]


@dataclass(frozen=True, slots=True)
class EntryCurve:
    """A number as a function of the share of a range."""

    values: Sequence[Any]  # Balls at the nodes of an order
    far: Any  # A ball of Taylor's coefficient of the next order, anywhere


def enclose_box(point: Mapping[Key, Fraction], errors: Mapping[Key, Fraction]) -> list[Point]:
    """Return the points of a simplex that holds a box of errors.

    Of n uncertain numbers: all at their low ends, and each alone n times as far as its high end.
    """
    low = {key: value - errors[key] for key, value in point.items()}
    wide = [key for key, error in errors.items() if error]
    return [low, *(low | {key: low[key] + 2 * len(wide) * errors[key]} for key in wide)]


def round_balls(balls: Iterable[arb], off: Fraction = ZERO) -> tuple[list[Fraction], Fraction]:
    """Return rational numbers near balls, and how far off they and an error are at most."""
    balls = list(balls)
    size = max(highest(abs(value)) for value in balls) or off or ONE
    unit = _power(size, KNOWN_BITS)
    if off > unit:
        unit = _power(off, RANGED_BITS)
    found = [round(middle(value) / unit) * unit for value in balls]
    error = off + max(highest(abs(v - ball_around(p))) for v, p in zip(balls, found, strict=True))
    return found, -(-error // (unit / 4)) * (unit / 4)


def simplex(curves_of: Callable[[int], Mapping[Key, EntryCurve]]) -> list[Point] | None:
    """Return points around curves that are run through together; None if too flat or too many.

    `curves_of` returns them for an order. The Bezier points of polynomials of degree m, with m
    curves, are a simplex that holds these polynomials. It is widened by the errors of the curves
    and of digits. Each number without a curve has a point of its own, far beyond.
    """
    bent = [key for key, curve in curves_of(0).items() if not bool(curve.far == 0)]
    if len(bent) > MOST_BENT:
        return None
    curves, still, errors = curves_of(len(bent)), {}, {}
    for key, curve in curves.items():
        if key not in bent:
            (still[key],), errors[key] = round_balls(curve.values[:1])
    if not bent:
        return enclose_box(still, errors)
    rests = {key: 2 * highest(abs(curves[key].far)) / 4 ** (len(bent) + 1) for key in bent}
    control = {key: _control_points(curves[key].values) for key in bent}
    for bits in CURVE_BITS:
        places: dict[Key, list[Fraction]] = {}
        for key, values in control.items():
            length = max(highest(abs(values[-1] - values[0])), rests[key])
            unit = _power(length, bits)
            places[key] = [round(middle(value) / unit) * unit for value in values]
            pairs = zip(values, places[key], strict=True)
            errors[key] = rests[key] + max(highest(abs(v - ball_around(p))) for v, p in pairs)
        found = _widened(places, still, errors)
        if found is not None and found[0] <= (NARROW if bits < CURVE_BITS[5] else WIDEST):
            return found[1]
    return None


def _widened(
    places: Mapping[Key, Sequence[Fraction]],
    still: Mapping[Key, Fraction],
    errors: Mapping[Key, Fraction],
) -> tuple[Fraction, list[Point]] | None:
    """Return the relative widening of a simplex, with its points; None for a flat simplex.

    A point off by e has weights of at least -w at its corners, by the inverse of their matrix. In
    the simplex whose corners are ``(1 + sum w) p_i - sum w_j p_j`` they are not negative. A far
    point of a known number has a weight of at most `SHARE`, so all others mix with at least what
    that leaves.
    """
    from flint import fmpq, fmpq_mat

    bent, size = [*places], len(places) + 1
    corners = [[places[key][b] for key in bent] for b in range(size)]
    rows = [[fmpq(1)] * size, *[[rational(p[i]) for p in corners] for i in range(size - 1)]]
    try:
        inverse = fmpq_mat(rows).inv()
    except ZeroDivisionError:
        return None
    loose = [key for key in still if errors[key]]
    wider = []
    for i in range(size):
        shares = (abs(fraction(inverse[i, j])) * errors[key] for j, key in enumerate(bent, 1))
        w = (sum(shares, ZERO) + SHARE * len(loose) / size) / (1 - SHARE * len(loose))
        wider.append(-(-w // _power(w, 3)) * _power(w, 3) if w else ZERO)
    total = 1 + sum(wider, ZERO)
    low = {key: value - errors[key] for key, value in still.items()}
    shift = [
        sum((w * p[j] for w, p in zip(wider, corners, strict=True)), ZERO) for j in range(size - 1)
    ]
    points = [{k: total * p[j] - shift[j] for j, k in enumerate(bent)} | low for p in corners]
    centre = {k: sum((p[j] for p in corners), ZERO) / size for j, k in enumerate(bent)} | low
    far = [centre | {k: low[k] + 2 * errors[k] / SHARE} for k in loose]
    return max(wider), [*points, *far]


def nodes(order: int) -> list[arb]:
    """Return the shares of a range at which polynomials of an order are near what they interpolate.

    They are Chebyshev's: with the next coefficient c of a function, that is within
    ``2 |c| / 4^(order + 1)``.
    """
    from flint import arb, fmpq

    return [(arb.cos_pi_fmpq(fmpq(2 * i + 1, 2 * order + 2)) + 1) / 2 for i in range(order + 1)]


def _control_points(values: Sequence[arb]) -> list[arb]:
    """Return the Bezier points of the polynomial that has some values at the nodes."""
    from flint import arb_mat

    order = len(values) - 1
    weights = [
        [comb(order, b) * s**b * (1 - s) ** (order - b) for b in range(order + 1)]
        for s in nodes(order)
    ]
    found = arb_mat(weights).solve(arb_mat([[value] for value in values]))
    return [found[b, 0] for b in range(order + 1)]


@dataclass(frozen=True, slots=True)
class Tie:
    """A number that others give exactly."""

    constant: Fraction
    weights: Mapping[Key, Fraction]

    def evaluate(self, point: Mapping[Key, Fraction]) -> Fraction:
        """Return the number where the others are."""
        return self.constant + sum((w * point[key] for key, w in self.weights.items()), ZERO)


def ties(
    G: fmpq_mat, h: Fraction, entry: Callable[[fmpq_mat, Key], fmpq], sizes: Mapping[Key, Fraction]
) -> dict[Key, Tie]:
    """Return the entries of ``exp(G h)`` that a few others give exactly, at known G and h.

    With m rows, the exponential is its Taylor polynomial of degree m - 1 and a mixture of m powers
    of G from the m-th on (Cayley and Hamilton): as many entries give it as these powers differ in.
    There are none where the digits of few entries are too few for the others. `sizes` are those of
    all.
    """
    from flint import fmpq, fmpq_mat

    # Small entries give large entries with smaller relative errors than the reverse.
    m, keys = G.nrows(), sorted(sizes, key=lambda key: sizes[key])
    powers = [fmpq_mat([[fmpq(int(i == j)) for j in range(m)] for i in range(m)])]
    for _ in range(2 * m - 1):
        powers.append(powers[-1] * G)
    shares = [rational(h) ** p / factorial(p) for p in range(m)]
    known = {
        key: sum((c * entry(M, key) for c, M in zip(shares, powers, strict=False)), fmpq(0))
        - int(key[1] == key[2] == m - 2)
        for key in keys
    }
    reduced, rank = fmpq_mat([[entry(M, key) for key in keys] for M in powers[m:]]).rref()
    free = [next(c for c in range(len(keys)) if reduced[r, c] != 0) for r in range(rank)]
    found = {}
    for c, key in enumerate(keys):
        if c not in free:
            weights = {keys[f]: reduced[r, c] for r, f in enumerate(free) if reduced[r, c] != 0}
            constant = known[key] - sum((w * known[k] for k, w in weights.items()), fmpq(0))
            tie = Tie(fraction(constant), {k: fraction(w) for k, w in weights.items()})
            if sum((abs(w) * sizes[k] for k, w in tie.weights.items()), ZERO) > LOOSE * sizes[key]:
                return {}
            found[key] = tie
    return found


def _power(size: Fraction, bits: int) -> Fraction:
    """Return a power of two that is so many bits below a number."""
    return Fraction(2) ** (size.numerator.bit_length() - size.denominator.bit_length() - bits)


def rational(x: Fraction) -> fmpq:
    """Return a rational number of flint."""
    from flint import fmpq

    return fmpq(x.numerator, x.denominator)


def fraction(x: fmpq) -> Fraction:
    """Return a fraction of Python."""
    return Fraction(int(x.p), int(x.q))
