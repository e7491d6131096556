"""Search for functions at the corners of constant parameters."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.search.acceptance import NO_MARGIN, OUT_OF_RANGE
from nrs_design.search.constants_quadratic import search_constants_quadratic
from tests.proof.systems import companion, family, oscillator, shears
from tests.proof.truth import holds
from tests.search.support import outcome

PAIR = Switching(fixed_ends=(("m0", "m1"),))


def test_up_to_the_border_of_stability():
    evidence, words = outcome(search_constants_quadratic, companion("0.5", "0.9"))
    assert evidence is not None
    assert words == "found"
    with pytest.raises(np.linalg.LinAlgError, match="has no norm"):
        outcome(search_constants_quadratic, companion("0.5", "1.01"))


@pytest.mark.parametrize("speed", [Fraction(1, 1000), 1000])
def test_units_of_time_do_not_matter(speed):
    """The oscillator with a stiffness up to 50 beside the nominal one, faster and slower."""
    rows = [mode.A.fractions() for mode in oscillator(50).modes]
    faster = [[[speed * v for v in row] for row in A] for A in rows]
    system = family(*faster, switching=PAIR)
    evidence, _ = outcome(search_constants_quadratic, system)
    assert holds(system, evidence)
    assert evidence.rate > speed / 4


def test_units_of_states_do_not_matter():
    rows = [mode.A.fractions() for mode in companion("0.9", "0.9").modes]
    unit = 10**5
    moved = [[[a, unit * b], [c / unit, d]] for (a, b), (c, d) in rows]
    sets = companion("0.9", "0.9").switching
    system = family(*moved, time=Time.DISCRETE, switching=sets)
    evidence, _ = outcome(search_constants_quadratic, system)
    assert holds(system, evidence)


def test_an_unstable_mean_has_none():
    assert outcome(search_constants_quadratic, shears(PAIR)) == (None, NO_MARGIN)


def test_modes_beyond_floating_point_are_left_alone():
    system = family([[-1, 0], [0, -1]], [[-(10**400), 0], [0, -1]], switching=PAIR)
    assert outcome(search_constants_quadratic, system) == (None, OUT_OF_RANGE)
