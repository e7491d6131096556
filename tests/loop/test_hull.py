"""Points around numbers and curves: what they enclose is inside exactly, and not by much."""

import random
from fractions import Fraction

import pytest
from flint import arb, fmpq, fmpq_mat

from nrs_design.loop import hull
from nrs_design.loop.entries import highest, lowest
from nrs_design.loop.hull import EntryCurve, enclose_box, nodes, rational, round_balls, simplex
from nrs_design.proof.enclosure import ball_around, precision

F = Fraction


def weights(points, place):
    """The weights of points that mix to a place: there are one more than numbers."""
    keys = [*place]
    rows = [[1] * len(points), *[[point[key] for point in points] for key in keys]]
    A = fmpq_mat([[rational(F(c)) for c in row] for row in rows])
    b = fmpq_mat([[fmpq(1)], *[[rational(F(place[key]))] for key in keys]])
    return [F(int(w.p), int(w.q)) for w in A.solve(b).entries()]


def spread(ball, rng):
    """A number of a ball: an end of it, or the middle."""
    return lowest(ball) + (highest(ball) - lowest(ball)) * F(rng.randint(0, 2), 2)


@pytest.mark.parametrize("seed", range(30))
def test_what_is_rounded_is_off_by_no_more_than_is_said(seed):
    rng = random.Random(seed)
    with precision(240):
        off = F(rng.choice([0, 0, rng.randint(1, 99)]), 10 ** rng.randint(3, 30))
        radius = rng.choice([0.0, 10.0 ** -rng.randint(10, 40)])
        size = 10.0 ** rng.randint(-9, 3)
        balls = [arb(rng.uniform(-size, size), radius) for _ in range(rng.randint(1, 4))]
        found, error = round_balls(balls, off)
        pairs = [*zip(balls, found, strict=True)]
        worst = max(max(highest(b) - p, p - lowest(b)) for b, p in pairs)
        assert error >= off + worst
        largest = max(highest(abs(ball)) for ball in balls)
        # Of what it is off, or of the last of 64 bits of the largest, a third.
        assert error <= F(4, 3) * (off + F(radius)) + largest / 2**62
        assert all(abs(p.numerator).bit_length() < 80 for p in found) or not off


def drawn(rng, order):
    """Polynomials of one degree more than there are of them, each with a power of its own."""
    return {
        (0, 0, j): [F(p == j + 1) + F(rng.randint(1, 9), 100) for p in range(order + 2)]
        for j in range(order)
    }


def at(polynomial, t):
    return sum((c * t**p for p, c in enumerate(polynomial)), F(0))


@pytest.mark.parametrize("coarse", [False, True])
@pytest.mark.parametrize("seed", range(40))
def test_a_curve_that_is_off_as_far_as_may_be_is_inside(seed, coarse, monkeypatch):
    """What is one degree above what interpolates is off by just that at both ends of the range.

    With few digits, and points of known numbers that are not far, nothing hides behind another.
    """
    if coarse:
        monkeypatch.setattr(hull, "CURVE_BITS", range(2, 400, 2))
        monkeypatch.setattr(hull, "NARROW", F(4))
        monkeypatch.setattr(hull, "SHARE", F(1, 8))
        monkeypatch.setattr(hull, "KNOWN_BITS", 5)
    rng = random.Random(seed)
    order = rng.randint(1, 4)
    with precision(240):
        curves = drawn(rng, order)
        # Beside them are numbers that are known but for digits.
        known = {
            (0, 1, j): arb(rng.uniform(-5, 5), rng.choice([0, 1e-30])) for j in range(seed % 3)
        }

        def made(n):
            found = {}
            for key, polynomial in curves.items():
                values = [
                    sum((ball_around(c) * t**p for p, c in enumerate(polynomial)), arb(0))
                    for t in nodes(n)
                ]
                found[key] = EntryCurve(values, ball_around(polynomial[-1]))
            return found | {
                key: EntryCurve([ball] * (n + 1), arb(0)) for key, ball in known.items()
            }

        points = simplex(made)
        assert points is not None
        for k in range(33):
            t = F(k, 32)
            place = {key: at(polynomial, t) for key, polynomial in curves.items()}
            # Those without a digit to be in doubt are the same in all points.
            for key, ball in known.items():
                if len({point[key] for point in points}) > 1:
                    place[key] = spread(ball, rng)
            assert min(weights(points, place)) >= 0
        # Nor is it much wider than that: eight times the range beyond it is outside.
        beyond = {key: at(polynomial, F(9)) for key, polynomial in curves.items()}
        place = {key: value for key, value in place.items() if key not in beyond} | beyond
        assert min(weights(points, place)) < 0


def test_numbers_that_are_off_are_in_the_simplex_around_them():
    middle = {(0, 0, 0): F(1), (0, 0, 1): F(-2), (0, 0, 2): F(3)}
    errors = {(0, 0, 0): F(1, 10), (0, 0, 1): F(0), (0, 0, 2): F(1, 7)}
    points = enclose_box(middle, errors)
    assert len(points) == 3
    assert {point[0, 0, 1] for point in points} == {F(-2)}
    for a in (-1, 1):
        for b in (-1, 1):
            place = {(0, 0, 0): 1 + F(a, 10), (0, 0, 2): 3 + F(b, 7)}
            assert min(weights(points, place)) >= 0
    assert min(weights(points, {(0, 0, 0): F(89, 100), (0, 0, 2): F(3)})) < 0
