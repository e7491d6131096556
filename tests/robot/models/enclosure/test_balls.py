"""Whatever numbers are in the operands: the exact result is in the result."""

import operator
from fractions import Fraction
from math import isqrt

import numpy as np
import pytest
from flint import arb, ctx

from nrs_design.robot.models.enclosure.balls import Balls

OPERATIONS = (operator.add, operator.sub, operator.mul)


def holds(ball, number):
    return abs(Fraction(float(ball.mid)) - number) <= Fraction(float(ball.rad))


def ends(ball):
    return [Fraction(float(ball.mid)) + side * Fraction(float(ball.rad)) for side in (-1, 0, 1)]


@pytest.fixture
def some(request):
    rng = np.random.default_rng(3)
    sizes = 10.0 ** rng.integers(-8, 8, 60)
    return [
        Balls(mid, abs(mid) * rad)
        for mid, rad in zip(
            rng.normal(size=60) * sizes, 10.0 ** -rng.integers(1, 16, 60), strict=True
        )
    ]


@pytest.mark.parametrize("operation", OPERATIONS)
def test_arithmetic(some, operation):
    for a, b in zip(some[:30], some[30:], strict=True):
        result = operation(a, b)
        assert all(holds(result, operation(x, y)) for x in ends(a) for y in ends(b))


def test_reciprocal(some):
    for a in some:
        assert all(holds(a.reciprocal(), 1 / x) for x in ends(a))


def test_root(some):
    scale = 10**60
    for a in some:
        positive = Balls(abs(a.mid), a.rad)
        for x in ends(positive):
            below = Fraction(isqrt(int(x * scale)), isqrt(scale))
            assert holds(positive.sqrt(), below)


def test_nothing_is_known_about_one_over_what_may_be_zero():
    assert Balls(np.float64(0.1), 0.2).reciprocal().rad == np.inf
    assert Balls(np.float64(0.1), 0.2).sqrt().rad == np.inf


def test_what_is_too_small_for_a_float_is_in_the_product():
    tiny = Balls(1e-200, 0.0) * Balls(1e-200, 0.0)
    assert holds(tiny, Fraction(1e-200) ** 2)


@pytest.mark.parametrize("size", [1e200, 3e-160])
def test_one_over_what_is_large_or_small(size):
    """The square of either is no float, or hardly one."""
    ball = Balls(np.float64(size), size / 2)
    assert all(holds(ball.reciprocal(), 1 / x) for x in ends(ball))


def inside(ball, share):
    """Return a number of each ball, exact in flint."""
    parts = zip(ball.mid, share, ball.rad, strict=True)
    return [arb(float(m)) + arb(float(s)) * arb(float(r)) for m, s, r in parts]


@pytest.mark.parametrize("power", [3, 150])
def test_random_balls_against_those_of_flint(power, monkeypatch):
    monkeypatch.setattr(ctx, "prec", 2000)
    rng = np.random.default_rng(power)
    mids = abs(rng.normal(size=(2, 300))) * 10.0 ** rng.integers(-power, power, (2, 300))
    a, b = (Balls(mid, mid * 10.0 ** -rng.integers(1, 17, 300)) for mid in mids)
    x, y = (inside(ball, rng.uniform(-1, 1, 300)) for ball in (a, b))
    found = [
        (a + b, [u + v for u, v in zip(x, y, strict=True)]),
        (a - b, [u - v for u, v in zip(x, y, strict=True)]),
        (a * b, [u * v for u, v in zip(x, y, strict=True)]),
        (a.reciprocal(), [1 / u for u in x]),
        (a.sqrt(), [u.sqrt() for u in x]),
    ]
    for result, exact in found:
        for mid, rad, number in zip(result.mid, result.rad, exact, strict=True):
            assert abs(number - arb(float(mid))) <= arb(float(rad))
