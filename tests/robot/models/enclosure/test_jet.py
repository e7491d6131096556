"""Taylor coefficients over boxes against power series of flint at points within."""

from math import factorial

import numpy as np
import pytest
from flint import arb, arb_series, ctx

from nrs_design.robot.models.enclosure.balls import Balls
from nrs_design.robot.models.enclosure.jet import coordinate_jets, direction_jets

ORDERS = range(1, 6)
MIDDLE, HALF = 0.75, 0.03


def line(order):
    """Return the first coordinate, over one box."""
    zeros = np.zeros(1)
    return coordinate_jets([zeros + MIDDLE, zeros, zeros], [zeros + HALF, zeros, zeros], order)[0]


def turned(order):
    """Return cosine and sine of the square of the coordinate."""
    x = line(max(order - 1, 1))
    still = x.constant(Balls(0.0))
    slopes = [x * 2.0, still, still]
    return direction_jets(slopes, *(near(f(arb(MIDDLE) ** 2)) for f in (arb.cos, arb.sin)))


def near(number):
    return Balls(np.array([float(number)]), 2.0**-50)


FUNCTIONS = {
    "root": (lambda n: (line(n) + 1.5).sqrt(), lambda x: (x + 1.5).sqrt()),
    "reciprocal": (lambda n: (line(n) + 1.5).reciprocal(), lambda x: 1 / (x + 1.5)),
    "product": (lambda n: (line(n) * line(n)).sqrt() * line(n), lambda x: (x * x).sqrt() * x),
    "cosine": (lambda n: turned(n)[0], lambda x: (x * x).cos()),
    "sine": (lambda n: turned(n)[1], lambda x: (x * x).sin()),
}


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_all_derivatives_over_a_box(name, order, monkeypatch):
    monkeypatch.setattr(ctx, "prec", 200)
    monkeypatch.setattr(ctx, "cap", order + 1)
    make, exact = FUNCTIONS[name]
    for share in (-1, -0.3, 0, 0.8, 1):
        series = exact(arb_series([arb(MIDDLE) + arb(share) * arb(HALF), 1]))
        jet = make(order)
        for k in range(order + 1):
            value = jet.value
            mid, rad = (arb(float(np.ravel(part)[0])) for part in (value.mid, value.rad))
            assert abs(series[k] * factorial(k) - mid) <= rad
            assert rad < 1000
            if k < order:
                jet = jet.derivative(0)


def test_a_box_with_a_zero_has_no_root_and_no_reciprocal():
    with np.errstate(all="ignore"):
        made = [(line(3) + -MIDDLE).sqrt(), (line(3) + -MIDDLE).reciprocal()]
    assert not any(np.isfinite(jet.value.rad).any() for jet in made)
