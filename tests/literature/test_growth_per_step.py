"""Families of matrices with a published growth per step: a verdict on either side.

The table beside this file says where each is from, what is printed of the radius with its digits,
and the word, by numbers of matrices; where no number is printed, it is the growth of the word.
"""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.search.certify import certify
from tests.proof.systems import family
from tests.tables import table

F = Fraction
KNOWN = {
    name: (known["matrices"], known["printed"], known["word"])
    for name, known in table(Path(__file__).with_name("growth_per_step.yaml")).items()
}


def times(factor, matrix):
    return [[F(factor) * F(entry) for entry in row] for row in matrix]


def growth_of(matrices, word):
    product = np.eye(len(matrices[0]))
    for letter in word:
        product = np.array([[float(F(e)) for e in row] for row in matrices[int(letter)]]) @ product
    return float(np.abs(np.linalg.eigvals(product)).max() ** (1 / len(word)))


def divided(name, by=1):
    modes = (times(1 / F(by), matrix) for matrix in KNOWN[name][0])
    return family(*modes, time=Time.DISCRETE)


@pytest.mark.parametrize("name", [name for name, known in KNOWN.items() if all(known)])
def test_what_is_printed_is_the_growth_of_the_published_word(name):
    matrices, printed, word = KNOWN[name]
    digits = len(printed.partition(".")[2])
    assert growth_of(matrices, word) == pytest.approx(float(printed), abs=10.0**-digits)


# Beside others of their kind, each takes as long as all of those together.
DEAR = ("AJPR14", "G96 long", "GP13 0.9", "M20 3.1", "M20 thesis")
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
