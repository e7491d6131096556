"""Words in the norms of forms: long ones are found, and none where nothing grows."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.search.acceptance import first_accepted
from nrs_design.search.family import Family
from nrs_design.search.forms import FormsProgram
from nrs_design.search.memory import (
    draw_memory,
    least_growth,
    search_extremal_words,
    words_in_norms,
)
from nrs_design.work import Allowance
from tests.literature.test_growth_per_step import divided
from tests.proof.systems import golden, lossy_network

LONG = 1.6841852824915513


def sought(system):
    return first_accepted(search_extremal_words(Family.of(system, Allowance(20.0))), system)[0]


def test_a_long_word_is_found_where_it_hardly_grows():
    evidence = sought(divided("L17 long", str(LONG * (1 - 2e-4))))
    assert sum(count for _, count in evidence.steps) > 20


def test_nothing_is_found_beyond_it():
    assert sought(divided("L17 long", str(LONG * (1 + 1e-4)))) is None


@pytest.mark.parametrize(("scale", "grows"), [("1.026", True), ("1.025", False)])
def test_words_under_rules(scale, grows):
    """1 / 0.97482 is 1.02583, and the word has 8 steps."""
    evidence = sought(lossy_network(Fraction(scale)))
    assert (evidence is not None) is grows
    if grows:
        assert sum(count for _, count in evidence.steps) == 8


def test_the_least_growth_of_forms_is_near_that_of_words():
    program = FormsProgram(draw_memory(golden(1), 1))
    assert least_growth(program, Allowance(), 1.6180339887, 1.6) is None
    rate, solution = least_growth(program, Allowance(), 1.6180339887, 2.0)
    assert 1.618 < rate < 1.6185
    assert all(np.linalg.eigvalsh(Q)[0] > 0 for Q in solution.forms)
    *_, (word, growth) = words_in_norms(program, solution, Allowance(), 1.0)
    assert sorted(word) == [0, 1]
    assert growth == pytest.approx((1 + 5**0.5) / 2)
