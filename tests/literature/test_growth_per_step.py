"""Families of matrices with a published growth per step: both ends, and a verdict on either side.

Values and words are those of the papers, as far as they are printed in the places named here:

- [AP12] A. A. Ahmadi and P. A. Parrilo, "Joint spectral radius of rank one matrices and the maximum
  cycle mean problem", CDC 2012, example 2.1 (SwitchOnSafety.jl, test/AP12e21.jl).
- [BL24] J. Bochi and P. Laskawiec, "Spectrum maximizing products are not generically unique", SIAM
  Journal on Matrix Analysis and Applications 45, 2024; [K24] V. Kozyakin, "On pairs of spectrum
  maximizing products with distinct factor multiplicities", arXiv:2407.10513, with kappa = 1.1^3:
  words BAA and BBA (its MATLAB script).
- [G96] G. Gripenberg, "Computing the joint spectral radius", Linear Algebra and its Applications
  234, 1996, p. 52: a word of 13 (t-toolboxes, tgallery).
- [GP13] N. Guglielmi and V. Protasov, "Exact computation of joint spectral characteristics of
  linear operators", Foundations of Computational Mathematics 13, 2013, examples 1 and 2, and on
  the Pascal rhombus and Euler's binary and ternary partitions (SwitchOnSafety.jl, examples).
- [GWZ05] N. Guglielmi, F. Wirth and M. Zennaro, "Complex polytope extremality results for families
  of matrices", SIAM Journal on Matrix Analysis and Applications 27, 2005, examples 6.3 and 6.4.
- [GZ09] N. Guglielmi and M. Zennaro, "Finding extremal complex polytope norms for families of real
  matrices", SIAM Journal on Matrix Analysis and Applications 31, 2009, example 4.1.
- [HMST11] K. G. Hare, I. D. Morris, N. Sidorov and J. Theys, "An explicit counterexample to the
  Lagarias-Wang finiteness conjecture", Advances in Mathematics 226, 2011: no word attains it
  (SwitchOnSafety.jl, examples/Finiteness_conjecture_counterexample).
- [L17] B. Legat, SwitchOnSafety.jl, examples/Long_product: a word of 41, by N. Guglielmi and
  A. Cicone.
- [M20] T. Mejstrik, "Improved invariant polytope algorithm and applications", ACM Transactions on
  Mathematical Software 46, 2020: a word of 119, and others (t-toolboxes, tgallery).
- [M10] I. D. Morris, "A rapidly-converging lower bound for the joint spectral radius via
  multiplicative ergodic theory", Advances in Mathematics 225, 2010.

Where no number is printed, it is the growth of the published word.
"""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.pipeline.radius import bound_radius
from nrs_design.proof.mode import Time
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.search.method import Method
from tests.proof.systems import family

F = Fraction
UP, DOWN = [[1, 1], [0, 1]], [[1, 0], [1, 1]]
KAPPA = F(1331, 1000)
RHOMBUS = [
    [[0, 1, 0, 0, 0], [1, 0, 2, 0, 0], [0, 0, 0, 0, 0], [0, 1, 0, 0, 1], [0, 0, 0, 2, 1]],
    [[1, 0, 2, 0, 0], [0, 0, 0, 2, 1], [1, 1, 0, 0, 0], [0, 0, 0, 0, 0], [0, 1, 0, 0, 0]],
]


def times(factor, matrix):
    return [[F(factor) * F(entry) for entry in row] for row in matrix]


def bands(size, *begins):
    """Return the matrices of a partition function: each row has ones between two columns."""
    return [
        [[int(first <= j < last) for j in range(size)] for first, last in rows] for rows in begins
    ]


BINARY = bands(
    6,
    [(0, 4), (1, 4), (1, 5), (2, 5), (2, 6), (3, 6)],
    [(0, 3), (0, 4), (1, 4), (1, 5), (2, 5), (2, 6)],
)
TERNARY = bands(
    7,
    [(0, 5), (1, 5), (1, 6), (1, 6), (2, 6), (2, 7), (2, 7)],
    [(0, 5), (0, 5), (1, 5), (1, 6), (1, 6), (2, 6), (2, 7)],
    [(0, 4), (0, 5), (0, 5), (1, 5), (1, 6), (1, 6), (2, 6)],
)
# Matrices, what is printed of the radius with its digits, and the word, by numbers of matrices.
KNOWN = {
    "AP12 rank one": ([[[0, 1], [0, 0]], [[0, 0], [1, 0]]], "1", "01"),
    "K24": ([[[0, -1 / KAPPA], [KAPPA, -1]], [[0, -KAPPA], [1 / KAPPA, -1]]], None, "100"),
    "G96 long": (
        [times("1/5", [[3, 0], [1, 3]]), times("1/5", [[3, -3], [0, -1]])],
        None,
        "0000000000001",
    ),
    "GP13 0.8": ([UP, times("0.8", DOWN)], "1.447214", "10"),
    "GP13 0.9": ([UP, times("0.9", DOWN)], "1.535002", "10"),
    "GP13 rhombus": (RHOMBUS, "2", None),
    "GP13 Euler binary": (BINARY, None, "1"),
    "GP13 Euler ternary": (TERNARY, "4.722045", "12"),
    "GWZ05 6.3": (
        [[[1, 0, 0], [0, "1/2", 0], [0, 0, "1/4"]], times("1/2", [[1, 0, 0]] * 3)],
        "1",
        "0",
    ),
    "GWZ05 6.4": (
        [
            [[1, 1], [0, 0]],
            [[0, 0], [1, 1]],
            times("1/2", [[1, 1], [1, 1]]),
            times("2/3", [[1, 0], [-1, 0]]),
        ],
        "1",
        "0",
    ),
    "GZ09 4.1": (
        [
            [[-3, -2, 1, 2], [-2, 0, -2, 1], [1, 3, -1, -5], [-3, -3, -2, -1]],
            [[1, 0, -3, -1], [-4, -2, -1, -4], [-1, 0, -1, 2], [-1, -2, -1, 2]],
        ],
        None,
        "01",
    ),
    "HMST11 no word": ([UP, times("0.749326546330367557943961948", DOWN)], "1.40924722", None),
    "L17 long": (
        [[[-1, 1, -1], [-1, -1, 1], [0, 1, 1]], [[-1, 1, -1], [-1, -1, 0], [0, 1, 1]]],
        "1.68418528",
        "00011" + "0011" * 8 + "0001",
    ),
    "M10": ([[[2, 2], [0, 0]], [[1, 1], [1, 1]]], None, "0"),
    "M20 long": (
        [
            [["15/92", "-73/79"], ["56/59", "89/118"]],
            [["-231/241", "-143/219"], ["103/153", "-38/65"]],
        ],
        None,
        None,
    ),
    "M20 3.1": ([[[0, 0], [1, 1]], UP], None, "011"),
    "M20 thesis": ([[[2, -1], [2, 0]], [[0, -1], [2, 2]]], None, "010"),
}


def growth_of(matrices, word):
    product = np.eye(len(matrices[0]))
    for letter in word:
        product = np.array([[float(F(e)) for e in row] for row in matrices[int(letter)]]) @ product
    return float(np.abs(np.linalg.eigvals(product)).max() ** (1 / len(word)))


def divided(name, by=1):
    modes = (times(1 / F(by), matrix) for matrix in KNOWN[name][0])
    return family(*modes, time=Time.DISCRETE)


def ends_of(system):
    found = certify(system, Method.LMI)
    return bound_radius(found, Limits())


@pytest.mark.parametrize("name", [name for name, known in KNOWN.items() if all(known)])
def test_what_is_printed_is_the_growth_of_the_published_word(name):
    matrices, printed, word = KNOWN[name]
    digits = len(printed.partition(".")[2])
    assert growth_of(matrices, word) == pytest.approx(float(printed), abs=10.0**-digits)


@pytest.mark.parametrize("name", KNOWN)
def test_both_ends_meet_at_the_published_growth(name):
    """They are less than a thousandth apart, most of them two ten-thousandths."""
    matrices, printed, word = KNOWN[name]
    ends = ends_of(divided(name))
    lower, upper = float(ends.lower), float(ends.upper)
    assert lower < upper < lower * (1.002 if name == "L17 long" else 1.0003)
    digits = len((printed or "").partition(".")[2])
    known = ([float(printed)] if printed else []) + ([growth_of(matrices, word)] if word else [])
    for radius in known:
        assert lower - 10.0**-digits < radius < upper + 10.0**-digits


# Beside others of their kind, each takes as long as all of those together.
DEAR = ("G96 long", "GP13 0.9", "M20 3.1", "M20 thesis")
STUDIED = [pytest.param(n, marks=[pytest.mark.nightly] if n in DEAR else []) for n in KNOWN]


@pytest.mark.parametrize("name", STUDIED)
def test_either_side_of_it_is_decided(name):
    matrices, printed, word = KNOWN[name]
    radius = float(printed) if printed else growth_of(matrices, word) if word else 1.0118
    # Of M20 long no number is printed: 1.0118 is between our ends.
    apart = 2e-3 if name == "L17 long" else 1e-3
    grows = divided(name, str(round(radius * (1 - 1e-3), 9)))
    assert certify(grows).verdict == "refuted"
    decays = divided(name, str(round(radius * (1 + apart), 9)))
    assert certify(decays).verdict == "proved"


def test_words_are_as_long_as_those_that_are_published():
    """41 steps, which a search from word to word does not find."""
    ends = ends_of(divided("L17 long"))
    assert float(ends.lower) == pytest.approx(1.6841852824915513, rel=2e-8)
    assert sum(count for _, count in ends.word) == 41
