"""What a stay makes of the state: powers, shifts and enclosures, against the definition."""

from fractions import Fraction

import pytest

from nrs_design.proof.evidence.flow import enclosed_form, power, shifted
from nrs_design.proof.exact import is_positive_definite
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.switching import Edge

A = RationalMatrix.from_rows([[Fraction(1, 2), 3], [-1, Fraction(2, 7)]])


def times(X, Y):
    n = range(len(X))
    return [[sum(X[i][k] * Y[k][j] for k in n) for j in n] for i in n]


@pytest.mark.parametrize(
    "M",
    [
        A,
        RationalMatrix.from_rows([[3]]),
        RationalMatrix.from_rows([[0, 1, 2], [3, 0, 1], [1, 1, 1]]),
    ],
)
def test_a_power_is_a_product_of_as_many_factors(M):
    n = range(M.shape[0])
    product = [[Fraction(int(i == j)) for j in n] for i in n]
    for exponent in range(9):
        assert power(M, exponent).fractions() == product
        product = times(product, M.fractions())


def test_a_shift_is_added_to_the_diagonal():
    moved = shifted(A, Fraction(1, 3))
    assert moved.fractions() == [[Fraction(5, 6), 3], [-1, Fraction(13, 21)]]
    assert A.fractions()[0][0] == Fraction(1, 2)


def decreases(entry, rate, begin, end, Qi, Qj, gain=None):
    """Tell whether ``Qi - g^2 exp(2 (entry + rate) t) Qj > 0`` is shown for all times."""
    source, target = (Mode(name, RationalMatrix.from_rows([[entry]])) for name in "ij")
    reset = None if gain is None else RationalMatrix.from_rows([[Fraction(gain)]])
    edge = Edge(source, target, reset)
    Q = {"i": ((Qi,),), "j": ((Qj,),)}
    form = enclosed_form(edge, (Fraction(begin), Fraction(end)), Q, Fraction(rate))
    return is_positive_definite(form)


# exp(-2) is 0.1353...: one hundred decreases to 13.53.
@pytest.mark.parametrize(
    ("given", "shown"),
    [
        ((-1, 0, 1, 1, 1000, 7389), True),
        ((-1, 0, 1, 1, 1000, 7390), False),
        # The rate takes away from the decay.
        ((-2, 1, 1, 1, 1000, 7389), True),
        ((-2, 1, 1, 1, 1000, 7390), False),
        # A reset to one half is worth a factor of four.
        ((-1, 0, 1, 1, 1000, 29556, "1/2"), True),
        ((-1, 0, 1, 1, 1000, 29557, "1/2"), False),
        # Every time from one to the other counts, for decay the first, for growth the last.
        ((-1, 0, "0.99", 1, 1000, 7389), False),
        ((1, 0, 0, "0.01", 1000, 1000), False),
        ((1, 0, 0, "0.01", 1021, 1000), True),
    ],
)
def test_the_form_of_a_stay_against_the_exponential(given, shown):
    assert decreases(*given) is shown
