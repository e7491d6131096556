"""Families of matrices whose largest growth per step is published.

- Ahmadi, Jungers, Parrilo and Roozbehani, "Joint spectral radius and path-complete graph Lyapunov
  functions", SIAM Journal on Control and Optimization 52(1), 2014, example 5.4: 3.917384715148, by
  the two matrices in turn; 3.980503 by one quadratic form, 3.924087 in degree 4.
- Jungers, Cicone and Guglielmi, "Lifted polytope methods for computing the joint spectral radius",
  SIAM Journal on Matrix Analysis and Applications 35(2), 2014: example 6.1: 1.7779, by one matrix
  alone; example 6.3: (1 + sqrt 5)/2, by both in turn.
- Parrilo and Jadbabaie, "Approximation of the joint spectral radius using sum of squares", Linear
  Algebra and its Applications 428, 2008, example 5.4: 8.9149 (conjectured there), by the first and
  the third in turn; 9.761464 by one quadratic form, 8.922585 in degree 4.

The numbers are also in the tests of SwitchOnSafety.jl (AJPR14e54, JCG14e61, JCG14e63, PJ08e54).
"""

from fractions import Fraction

import pytest

from nrs_design.pipeline.radius import bound_radius
from nrs_design.proof.mode import Time
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from tests.proof.systems import family

LIMITS = Limits(max_degree=4, budget=10.0)
FAMILIES = {
    "path-complete": [[[-1, -1], [-4, 0]], [[3, 3], [-2, 1]]],
    "lifted-polytopes-1": [
        [[0, -1, 1, 1], [1, 0, 0, 0], [0, -1, 0, 0], [1, -1, -1, 0]],
        [[0, -1, 1, 0], [-1, -1, 1, 1], [-1, 0, 0, 0], [-1, -1, 0, -1]],
    ],
    "lifted-polytopes-3": [[[0, 1, 1], [1, 0, 0], [0, -1, 0]], [[0, 1, 0], [-1, 0, 1], [-1, 0, 0]]],
    "sum-of-squares": [
        [[0, 1, 7, 4], [1, 6, -2, -3], [-1, -1, -2, -6], [3, 0, 9, 1]],
        [[-3, 3, 0, -2], [-2, 1, 4, 9], [4, -3, 1, 1], [1, -5, -1, -2]],
        [[1, 4, 5, 10], [0, 5, 1, -4], [0, -1, 4, 6], [-1, 5, 0, 1]],
    ],
}
# The growth per step, the digits that are published, the modes of the word, and what a function of
# degree 4 shows (of example 6.1 all of 1.7779, of 6.3 to four digits).
KNOWN = {
    "path-complete": (3.917384715148, 1e-9, {"m0", "m1"}, 3.924086919),
    "lifted-polytopes-1": (1.7779, 1e-4, {"m1"}, 1.7780),
    "lifted-polytopes-3": (1.618033988749895, 1e-12, {"m0", "m1"}, 1.6181),
    "sum-of-squares": (8.9149, 1e-4, {"m0", "m2"}, 8.922585166517319),
}


def divided(name, by=1):
    by = Fraction(by)
    modes = [[[entry / by for entry in row] for row in A] for A in FAMILIES[name]]
    return family(*modes, time=Time.DISCRETE)


@pytest.mark.parametrize("name", FAMILIES)
def test_both_ends_of_the_growth_per_step(name):
    radius, digits, word, degree_four = KNOWN[name]
    system = divided(name)
    found = certify(system, limits=LIMITS)
    assert found.verdict == "refuted"
    ends = bound_radius(found, LIMITS)
    assert radius * (1 - digits) - 1e-7 < float(ends.lower) < radius * (1 + digits)
    assert {mode for mode, _ in ends.word} == word
    assert ends.lower < ends.upper < degree_four * 1.0005


@pytest.mark.parametrize(
    "name", [pytest.param("path-complete", marks=pytest.mark.nightly), *[*FAMILIES][1:]]
)
def test_either_side_of_it_is_decided(name):
    """Divided by a little less it grows, by what degree 4 shows (and a little) it decays."""
    radius, digits, _, degree_four = KNOWN[name]
    grows = divided(name, str(round(radius * (1 - digits) - 1e-4, 6)))
    assert certify(grows, limits=LIMITS).verdict == "refuted"
    decays = divided(name, str(round(degree_four * 1.001, 6)))
    assert certify(decays, limits=LIMITS).verdict == "proved"
