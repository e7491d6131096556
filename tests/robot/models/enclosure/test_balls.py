"""Whatever numbers are in the operands: the exact result is in the result."""

from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx

from nrs_design.robot.models.enclosure.balls import Balls


def holds(ball, number):
    return abs(Fraction(float(ball.mid)) - number) <= Fraction(float(ball.rad))


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
    assert all(
        holds(ball.reciprocal(), 1 / (Fraction(size) * share))
        for share in (Fraction(1, 2), 1, Fraction(3, 2))
    )


def inside(ball, share):
    """Return a number of each ball, exact in flint."""
    parts = zip(ball.mid, share, ball.rad, strict=True)
    return [arb(float(m)) + arb(float(s)) * arb(float(r)) for m, s, r in parts]


@pytest.mark.parametrize(("power", "side"), [(3, -1), (150, 1)])
def test_random_balls_against_those_of_flint(power, side, monkeypatch):
    monkeypatch.setattr(ctx, "prec", 2000)
    rng = np.random.default_rng(power)
    mids = (
        abs(rng.normal(size=(2, 300)))
        * [[side], [1]]
        * 10.0 ** rng.integers(-power, power, (2, 300))
    )
    a, b = (Balls(mid, abs(mid) * 10.0 ** -rng.integers(1, 17, 300)) for mid in mids)
    x, y = (inside(ball, rng.uniform(-2, 2, 300).clip(-1, 1)) for ball in (a, b))
    found = [
        (a + b, [u + v for u, v in zip(x, y, strict=True)]),
        (a - b, [u - v for u, v in zip(x, y, strict=True)]),
        (a * b, [u * v for u, v in zip(x, y, strict=True)]),
        (a.reciprocal(), [1 / u for u in x]),
        (b.sqrt(), [u.sqrt() for u in y]),
    ]
    for result, exact in found:
        for mid, rad, number in zip(result.mid, result.rad, exact, strict=True):
            assert abs(number - arb(float(mid))) <= arb(float(rad))
